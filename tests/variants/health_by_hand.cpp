// Steps whose health is known by hand, one variant at a time, also for numbers that a variant stores separately.
#include <rlslab/variants/extended_qr.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/information.hpp>
#include <rlslab/model/order_recursive_qr.hpp>
#include <rlslab/variants/ud.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using Row = Vector<double>;

/// e, s and gamma are ordinary numbers: K = P psi / s = 9.9, and K e alone overflows.
TEST(HealthByHand, OfUdAThetaThatOverflowsIsNotSound) {
    Ud<double> f({.size = 1, .prior = Prior<double>{.variance = 0x1p14}});
    Step<double> const step = f.update(Row{{0.1}}, 1.7e308);
    EXPECT_TRUE(std::isfinite(step.innovation) && 0 < step.gamma && step.gamma < 1);
    EXPECT_FALSE(std::isfinite(f.theta()[0]));
    EXPECT_EQ(name_of(step.health), "nonfinite");
}

/// X falls to zero by forgetting and comes back with the next row: that row's innovation was against no theta, and it is no start.
TEST(HealthByHand, OfInformationTheRowAfterABreakdownIsStillBroken) {
    Information<double> f({.size = 1, .forgetting = 0x1p-600, .prior = Prior<double>{.variance = 1}});
    EXPECT_EQ(name_of(f.update(Row{{0.0}}, 1.0).health), "sound");
    EXPECT_EQ(name_of(f.update(Row{{0.0}}, 1.0).health), "indefinite") << "X = 2^-1200";
    EXPECT_EQ(name_of(f.update(Row{{1.0}}, 1.0).health), "indefinite") << "X = 1 again";
    EXPECT_EQ(name_of(f.update(Row{{1.0}}, 1.0).health), "sound");
    Information<double> start({.size = 1, .prior = std::nullopt});
    EXPECT_EQ(name_of(start.update(Row{{0.0}}, 1.0).health), "undetermined");
    EXPECT_EQ(name_of(start.update(Row{{1.0}}, 1.0).health), "undetermined") << "the row that determines theta";
    EXPECT_EQ(name_of(start.update(Row{{1.0}}, 1.0).health), "sound");
}

/// Without a prior a parameter that no row has reached is NaN, not the zero it is stored as.
TEST(HealthByHand, OfGentlemanAParameterWithoutRowsIsNotANumber) {
    Gentleman<double> f({.size = 2, .prior = std::nullopt});
    EXPECT_TRUE(std::isnan(f.theta()[0]) && std::isnan(f.theta()[1]));
    f.update(Row{{2.0, 0.0}}, 6.0);
    EXPECT_EQ(f.theta()[0], 3);
    EXPECT_TRUE(std::isnan(f.theta()[1]));
    f.update(Row{{2.0, 1.0}}, 8.0);
    EXPECT_EQ(f.theta()[1], 2);
}

/// The root of two squares of 1.5e308 overflows: R is infinite from the second row on, while theta and W are not.
TEST(HealthByHand, OfExtendedQrAnInfinitePivotIsNotSound) {
    ExtendedQr<double> f({.size = 1, .prior = Prior<double>{.variance = 1}});
    EXPECT_EQ(name_of(f.update(Row{{1.5e308}}, 0.0).health), "sound");
    Step<double> const step = f.update(Row{{1.5e308}}, 0.0);
    EXPECT_EQ(f.theta()[0], 0);
    EXPECT_TRUE(std::isfinite(f.stored().F(0, 0)));
    EXPECT_EQ(name_of(step.health), "nonfinite");
}

/// A column that is a unit vector but for 2^-30: r away from its sign loses nothing, r towards it all of the reflection.
TEST(OrderRecursiveQr, ReflectsAwayFromTheSign) {
    for (double const sign : {1.0, -1.0}) {
        Row const x{{sign, 0x1p-30, -0x1p-30, 0x1p-29}}, z{{0.5, 1, -2, 3}};
        OrderRecursiveQr<double> f(Row(2 * x - 3 * z), 2);
        f.append(x);
        EXPECT_NEAR(f.theta()[0], 2 - 3 * x.dot(z) / x.squaredNorm(), 1e-14) << sign;
        f.append(z);
        EXPECT_NEAR(f.theta()[0], 2, 1e-14) << sign;
        EXPECT_NEAR(f.theta()[1], -3, 1e-14) << sign;
    }
}

}  // namespace
}  // namespace rlslab
