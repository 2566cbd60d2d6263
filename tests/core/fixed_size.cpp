// A filter of fixed size needs no Problem::size, and is the same filter with it.
#include "tests/common/twins.hpp"

#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/state/merge.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

/// Theta and what is stored.
template <class F>
twins::Left held(F const& f) {
    return twins::Left().add("theta", f.theta()).add("F", f.stored().F).add("D", f.stored().D);
}
template <class F>
bool is_refused(Problem<typename F::scalar> const& problem) {
    try {
        F const made(problem);
        return false;
    } catch (std::invalid_argument const&) {
        return true;
    }
}
void expect_refusals(std::string_view name, std::initializer_list<bool> refused) {
    EXPECT_EQ(std::vector(refused), std::vector(refused.size(), true)) << name;
}
/// From the default prior, from a full one with a theta, and from none.
template <class F>
void check() {
    using P = Prior<double>;
    P full{.theta = Vector<double>{{1, -0.5, 2}}};
    full.covariance = Matrix<double>{{4.0, 1.0, 0.5}, {1.0, 3.0, 0.25}, {0.5, 0.25, 2.0}};
    twins::Rows const rows = twins::taken({Seed{4}}, 20);
    for (std::optional<P> const& prior : {std::optional(P{}), std::optional(full), std::optional<P>()})
        if (prior || StartsWithoutPrior<F>)
            twins::expect_one(F::name, twins::trace(F({.forgetting = 0.96875, .prior = prior}), rows),
                              twins::trace(F({.size = 3, .forgetting = 0.96875, .prior = prior}), rows));
    expect_refusals(F::name, {is_refused<F>({.size = 4}), is_refused<F>({.size = -1}),
                              is_refused<F>({.prior = P{.theta = Vector<double>(2)}}),
                              is_refused<F>({.prior = P{.covariance = Matrix<double>(2, 2)}})});
}
TEST(FixedSize, ImpliesTheProblems) {
    for_each(Variants<double>{}, []<class F>() {
        if constexpr (!std::is_void_v<AtSize<F, 3>>) check<AtSize<F, 3>>();
    });
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
    EXPECT_EQ(F({.prior = Prior<double>{.stored = a.filter.stored()}}).stored().F, a.filter.stored().F);
    EXPECT_THROW(F({.prior = Prior<double>{.stored = Ud<double>({.size = 2}).stored()}}), std::invalid_argument);
    auto const implied = merged(a, b, {.forgetting = 0.96875}),
               given = merged(a, b, {.size = 3, .forgetting = 0.96875});
    ASSERT_TRUE(implied && given);
    twins::expect_one("merged", held(implied->filter), held(given->filter));
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
