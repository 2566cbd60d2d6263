// A filter of fixed size needs no Problem::size, and is the same filter with it.
#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/state/merge.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

template <class T>
bool same_bits(Stored<T> const& a, Stored<T> const& b) {
    return a.F == b.F && a.D == b.D;
}

/// The bits after 20 rows of a filter whose size is implied and of one whose size is given.
template <template <class, int> class F, class T>
void check(std::optional<Prior<T>> const& prior) {
    F<T, 3> implied({.forgetting = T(0.96875), .prior = prior}),
        given({.size = 3, .forgetting = T(0.96875), .prior = prior});
    EXPECT_TRUE(same_bits(implied.stored(), given.stored())) << F<T, 3>::name;
    Seed seed{4};
    for (int k = 0; k < 20; ++k) {
        T const psi[3] = {T(seed.bell()), T(seed.bell()), T(seed.bell())}, y = T(seed.bell());
        Step<T> const step = implied.update({psi, 3}, y);
        EXPECT_EQ(step.health, given.update({psi, 3}, y).health) << F<T, 3>::name;
    }
    EXPECT_TRUE(same_bits(implied.stored(), given.stored())) << F<T, 3>::name;
    EXPECT_EQ(Vector<T>(implied.theta()), Vector<T>(given.theta())) << F<T, 3>::name;
    EXPECT_THROW((F<T, 3>({.size = 4})), std::invalid_argument) << F<T, 3>::name;
    EXPECT_THROW((F<T, 3>({.size = -1})), std::invalid_argument) << F<T, 3>::name;
    EXPECT_THROW((F<T, 3>({.prior = Prior<T>{.theta = Vector<T>(2)}})), std::invalid_argument) << F<T, 3>::name;
    EXPECT_THROW((F<T, 3>({.prior = Prior<T>{.covariance = Matrix<T>(2, 2)}})), std::invalid_argument) << F<T, 3>::name;
}

/// From the default prior, and from a full one with a theta.
template <template <class, int> class F>
void check_priors() {
    check<F, double>(Prior<double>{});
    Prior<double> full{.theta = Vector<double>{{1, -0.5, 2}}};
    full.covariance = Matrix<double>{{4.0, 1.0, 0.5}, {1.0, 3.0, 0.25}, {0.5, 0.25, 2.0}};
    check<F, double>(full);
    if constexpr (StartsWithoutPrior<F<double, 3>>) check<F, double>(std::nullopt);
}

TEST(FixedSize, ImpliesTheProblems) {
    check_priors<Conventional>();
    check_priors<ConventionalTwoSided>();
    check_priors<Symmetric>();
    check_priors<Joseph>();
    check_priors<JosephRankTwo>();
    check_priors<Potter>();
    check_priors<Carlson>();
    check_priors<CarlsonDelta>();
    check_priors<Ud>();
    check_priors<UdDelta>();
    check_priors<InverseQr>();
    check_priors<InverseQrDelta>();
    check_priors<Kalman>();
    check_priors<Information>();
    check_priors<Qr>();
    check_priors<Gentleman>();
    check_priors<ExtendedQr>();
    check_priors<QrBlock>();
}
TEST(FixedSize, IsNotImpliedForADynamicFilter) {
    EXPECT_THROW(Ud<double>({.forgetting = 0.5}), std::invalid_argument);
    EXPECT_THROW(Qr<double>({.forgetting = 0.5}), std::invalid_argument);
}
TEST(FixedSize, OfAWalkIsImpliedToo) {
    Kalman<double, 2> const walk({}, Matrix<double>{{2.0, 0.5}, {0.5, 1.0}});
    EXPECT_THROW((Kalman<double, 2>({}, Matrix<double>(3, 3))), std::invalid_argument);
    EXPECT_EQ(walk.stored().F(1, 1), 16384.0);
}
TEST(FixedSize, ImpliesThatOfAStoredPriorAndOfWhatIsMerged) {
    using F = Ud<double, 3>;
    Part<F> a{F({.forgetting = 0.96875}), 0}, b = a;
    Seed seed{5};
    for (Part<F>* part : {&a, &b})
        for (; part->rows < 10; ++part->rows) part->filter.update({seed.bell(), seed.bell(), seed.bell()}, seed.bell());
    EXPECT_TRUE(same_bits(F({.prior = Prior<double>{.stored = a.filter.stored()}}).stored(), a.filter.stored()));
    EXPECT_THROW(F({.prior = Prior<double>{.stored = Ud<double>({.size = 2}).stored()}}), std::invalid_argument);
    auto const implied = merged(a, b, {.forgetting = 0.96875}),
               given = merged(a, b, {.size = 3, .forgetting = 0.96875});
    ASSERT_TRUE(implied && given);
    EXPECT_TRUE(same_bits(implied->filter.stored(), given->filter.stored()));
    EXPECT_THROW((void)merged(a, b, {.size = 2}), std::invalid_argument);
}
/// A filter of one size in what is made for a problem of another: refused when it is made, not at the first row.
TEST(FixedSize, IsThatOfTheProblemOfWhatIsAround) {
    using F = Ud<double>;
    F const filter({.size = 3});
    for (Index size : {2, 4}) {
        EXPECT_THROW(Guarded<F>(filter, {.size = size}), std::invalid_argument);
        EXPECT_THROW((Forgetting<F, Kulhavy<double>>(filter, {.size = size})), std::invalid_argument);
    }
    EXPECT_EQ(Guarded<F>(filter, {}).update({1, 2, 3}, 4).health, Health::sound);
    EXPECT_EQ((Forgetting<F, RandomWalk<double>>(filter, {}).update({1, 2, 3}, 4).health), Health::sound);
    EXPECT_THROW(Guarded<F>(filter, {.forgetting = 2}), std::invalid_argument);
}
TEST(FixedSize, AsAnApplicationWritesIt) {
    Ud<float, 3> filter({.forgetting = 0.99f});
    EXPECT_EQ(filter.update({1.0f, 2.0f, 3.0f}, 4.0f).health, Health::sound);
}

}  // namespace
}  // namespace rlslab
