// What `certified` promises, with enclosures that are just too wide; radii and digits of enclosures made by hand.
#include <rlslab/reference/enclosure.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace balls;

/// middle +- radius, both exact.
void set_ball(arb_ptr ball, double middle, double radius) {
    arb_set_d(ball, middle);
    Float const r(radius);
    arf_get_mag(arb_radref(ball), r);  // rounded up
}

/// theta = (t, s), P = [p q; q p], all radii but those given zero.
CertifiedSolution::Enclosure enclosure(double t, double rad_t, double s, double rad_s, double p, double rad_p, double q,
                                       double rad_q, int digits = 10) {
    CertifiedSolution::Enclosure x{BallMatrix(2, 1), BallMatrix(2, 2), 128, digits};
    set_ball(x.theta(0, 0), t, rad_t);
    set_ball(x.theta(1, 0), s, rad_s);
    set_ball(x.covariance(0, 0), p, rad_p);
    set_ball(x.covariance(0, 1), q, rad_q);
    set_ball(x.covariance(1, 0), q, rad_q);
    set_ball(x.covariance(1, 1), p, rad_p);
    return x;
}

constexpr double too_wide = 1 + 1e-6;
/// The criterion works in powers of two: 2^-34 for ten digits, which ask for 2^-33.2; and a radius is kept to 30 bits,
/// rounded up.
constexpr double narrow = 0x1p-34 * (1 - 1e-6);

TEST(ReferencePromise, EachComponentOfTheta) {
    for (double const size : {1.0, 3.0, 0x1p300, 0x1p-300}) {
        EXPECT_TRUE(theta_is_accurate(enclosure(size, narrow * size, size, 0, 1, 0, 0, 0)));
        EXPECT_TRUE(theta_is_accurate(enclosure(-size, 0, size, narrow * size, 1, 0, 0, 0)));
        EXPECT_FALSE(theta_is_accurate(enclosure(size, too_wide * 1e-10 * size, size, 0, 1, 0, 0, 0)));
        EXPECT_FALSE(theta_is_accurate(enclosure(size, 0, -size, too_wide * 1e-10 * size, 1, 0, 0, 0)));
        // relative to itself, not to a larger one
        EXPECT_FALSE(theta_is_accurate(enclosure(size, 0, size / 1024, too_wide * 1e-10 * size / 1024, 1, 0, 0, 0)));
    }
}
TEST(ReferencePromise, AComponentFortyDigitsSmallerThanTheLargest) {
    EXPECT_FALSE(theta_is_accurate(enclosure(1, 0, 0, too_wide * 1e-50, 1, 0, 0, 0)));
    EXPECT_FALSE(theta_is_accurate(enclosure(1, 0, 1e-41, too_wide * 1e-50, 1, 0, 0, 0)));
    EXPECT_TRUE(theta_is_accurate(enclosure(1, 0, 0, narrow * 0x1p-133, 1, 0, 0, 0)));
    EXPECT_TRUE(theta_is_accurate(enclosure(0, 0, 0, 0, 1, 0, 0, 0)));
    EXPECT_FALSE(theta_is_accurate(enclosure(0, 1e-300, 0, 0, 1, 0, 0, 0)));
}
TEST(ReferencePromise, EachEntryOfPRelativeToTheLargest) {
    for (double const size : {1.0, 5.0, 0x1p200, 0x1p-200}) {
        EXPECT_TRUE(covariance_is_accurate(enclosure(1, 0, 1, 0, size, narrow * size, 0, narrow * size)));
        EXPECT_FALSE(covariance_is_accurate(enclosure(1, 0, 1, 0, size, too_wide * 1e-10 * size, 0, 0)));
        EXPECT_FALSE(covariance_is_accurate(enclosure(1, 0, 1, 0, size, 0, 0, too_wide * 1e-10 * size)));
        EXPECT_FALSE(covariance_is_accurate(enclosure(1, 0, 1, 0, size, size, 0, 0)));
    }
}
TEST(ReferencePromise, IsOfTheDigitsAskedFor) {
    for (int const digits : {1, 15, 30, 100, 300}) {
        double const promised = std::pow(10.0, -digits);
        EXPECT_FALSE(theta_is_accurate(enclosure(1, too_wide * promised, 1, 0, 1, 0, 0, 0, digits))) << digits;
        EXPECT_FALSE(covariance_is_accurate(enclosure(1, 0, 1, 0, 1, too_wide * promised, 0, 0, digits))) << digits;
        EXPECT_TRUE(theta_is_accurate(enclosure(1, 0.49 * promised, 1, 0, 1, 0, 0, 0, digits))) << digits;
        EXPECT_TRUE(covariance_is_accurate(enclosure(1, 0, 1, 0, 1, 0.49 * promised, 0, 0, digits))) << digits;
    }
}

CertifiedSolution by_hand(CertifiedSolution::Enclosure const& x) {
    return CertifiedSolution(7, 2, std::make_shared<CertifiedSolution::Enclosure const>(x));
}

TEST(ReferencePromise, RadiiAreRelativeInTheNormAndNeverTooSmall) {
    CertifiedSolution const e = by_hand(enclosure(3, 0x1p-20, 4, 0x1p-20, 6, 0x1p-10, -8, 0x1p-11));
    double const theta = std::sqrt(2.0) * 0x1p-20 / 5;  // of ||theta|| = 5
    EXPECT_GE(e.radius(), theta);
    EXPECT_LE(e.radius(), theta * (1 + 1e-5));
    double const P = std::sqrt(2 * 0x1p-20 + 2 * 0x1p-22) / std::sqrt(200.0);  // of ||P||_F = sqrt(2 36 + 2 64)
    EXPECT_GE(e.covariance_radius(), P);
    EXPECT_LE(e.covariance_radius(), P * (1 + 1e-3));
    EXPECT_EQ(by_hand(enclosure(3, 0, 4, 0, 1, 0, 0, 0)).radius(), 0);
    EXPECT_EQ(by_hand(enclosure(0, 0.5, 0, 0, 1, 0, 0, 0)).radius(), std::numeric_limits<double>::infinity());
}

TEST(ReferencePromise, DigitsCountTheEnclosureAgainstTheEstimate) {
    // Off by 0.5 in a norm of 5, and the ball is as wide again in one component: at most 1 = |(0, 0.5 + 0.5)| from 4.5
    // less the ball.
    CertifiedSolution const sharp = by_hand(enclosure(3, 0, 4, 0, 6, 0, -8, 0)),
                            wide = by_hand(enclosure(3, 0, 4, 0.5, 6, 0, -8, 0));
    Vector<Reference> const estimate{{Reference(3), Reference(4.5)}};
    EXPECT_NEAR(sharp.theta_digits(estimate), 1, 1e-14);
    EXPECT_NEAR(sharp.theta_digits_worst(estimate), -std::log10(0.125), 1e-14);
    EXPECT_LE(wide.theta_digits(estimate), -std::log10(1.0 / std::hypot(3, 4.5)));
    EXPECT_LE(wide.theta_digits_worst(estimate), -std::log10(1.0 / 4.5));
    Matrix<Reference> P{{Reference(6), Reference(-8)},
                        {Reference(-8), Reference(7)}};  // one entry off by 1 of sqrt(200)
    using S = Stored<Reference>;
    EXPECT_NEAR(sharp.covariance_digits({S::Quantity::covariance, S::Form::plain, P}), 0.5 * std::log10(200.0), 1e-14);
    P(0, 0) = 7, P(1, 1) = 6;
    EXPECT_NEAR(sharp.covariance_digits({S::Quantity::covariance, S::Form::plain, P}), 0.5 * std::log10(200.0), 1e-14);
}

TEST(ReferencePromise, ChangesAreRelativeToTheSecond) {
    CertifiedSolution const a = by_hand(enclosure(3, 0, 4, 0, 1, 0, 0, 0)),
                            b = by_hand(enclosure(3, 0, 0, 0, 1, 0, 0, 0)),
                            zero = by_hand(enclosure(0, 0, 0, 0, 1, 0, 0, 0));
    EXPECT_DOUBLE_EQ(relative_change(a, b), 4.0 / 3);
    EXPECT_DOUBLE_EQ(relative_change(b, a), 0.8);
    EXPECT_DOUBLE_EQ(relative_change(a, b, Vector<double>{{2.0, 0.5}}), 2.0 / 6);
    EXPECT_DOUBLE_EQ(relative_change(b, a, Vector<double>{{1.0, 2.0}}), 8 / std::sqrt(73.0));
    EXPECT_EQ(relative_change(a, zero), std::numeric_limits<double>::infinity());
    EXPECT_EQ(relative_change(zero, zero), 0);
    EXPECT_TRUE(std::isnan(relative_change(CertifiedSolution(1, 2, 0, Status::unresolved), a)));
    EXPECT_THROW(relative_change(a, b, Vector<double>{{1.0}}), std::invalid_argument);
}

/// Nearly parallel regressors on a grid of powers of two: kappa of the Gram matrix about 2^(2k).
Records nearly_parallel(int k, double y) {
    Records out{.psi = Eigen::MatrixXd(2, 6), .y = Vector<double>::Zero(6), .names = {}};
    for (Index i = 0; i < 6; ++i) {
        double const x = double(i % 3 + 1), z = x + std::ldexp(double(i % 2), -k);
        out.psi.col(i) << x, z;
        if (y != 0) out.y[i] = y * (x + std::ldexp(z, -40));
    }
    return out;
}

/// theta is zero exactly at any precision, so that P alone asks for more bits; and theta's small component alone.
TEST(ReferencePromise, HoldsOfWhatIsCertified) {
    for (double const lambda : {1.0, 0.75})
        for (int const k : {10, 30, 45})
            for (double const y : {0.0, 1.0})
                for (int const digits : {30, 60, 90}) {
                    Problem<double> problem{.size = 2, .forgetting = lambda, .prior = std::nullopt};
                    for (CertifiedSolution const& e : certified(problem, nearly_parallel(k, y), {3, 6}, digits)) {
                        ASSERT_EQ(e.status(), Status::certified);
                        BallMatrix const &theta = e.enclosure()->theta, &P = e.enclosure()->covariance;
                        Float largest_P, largest_theta, size;
                        for (Index i = 0; i < 2; ++i) {
                            arf_abs(size, arb_midref(theta(i, 0)));
                            arf_max(largest_theta, largest_theta, size);
                            for (Index j = 0; j < 2; ++j) {
                                arf_abs(size, arb_midref(P(i, j)));
                                arf_max(largest_P, largest_P, size);
                            }
                        }
                        // 10^digits times the radius
                        auto const scaled = [&](mag_srcptr radius) {
                            Float out, ten(10.0);
                            arf_set_mag(out, radius);
                            for (int n = 0; n < digits; ++n) arf_mul(out, out, ten, ARF_PREC_EXACT, ARF_RND_DOWN);
                            return out;
                        };
                        Float floor,
                            tiny(1e-40);  // a component so much smaller than the largest is held to that; one here is
                                          // zero
                        arf_mul(floor, largest_theta, tiny, ARF_PREC_EXACT, ARF_RND_DOWN);
                        for (Index i = 0; i < 2; ++i) {
                            arf_abs(size, arb_midref(theta(i, 0)));
                            arf_max(size, size, floor);
                            EXPECT_LE(arf_cmp(scaled(arb_radref(theta(i, 0))), size), 0) << k << " " << digits;
                            for (Index j = 0; j < 2; ++j)
                                EXPECT_LE(arf_cmp(scaled(arb_radref(P(i, j))), largest_P), 0) << k << " " << digits;
                        }
                        EXPECT_LE(e.radius(), std::pow(10.0, -digits));
                        EXPECT_LE(e.covariance_radius(), 2 * std::pow(10.0, -digits));
                        EXPECT_EQ(e.bits() % 64, 0);
                        EXPECT_EQ(e.rank(), 2);
                    }
                }
}

}  // namespace
}  // namespace rlslab
