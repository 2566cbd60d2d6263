// A filter that was moved from has no size: it refuses every row, and may be assigned to. What is around one refuses
// with it. A filter of fixed size needs no Problem::size, and is the same filter with it.
#include "tests/common/twins.hpp"

#include <rlslab/adapt/assessed.hpp>
#include <rlslab/adapt/extended_least_squares.hpp>
#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/state/merge.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <limits>

namespace rlslab {
namespace {

/// "", or what a filter that was moved from did wrong.
template <class F>
std::string wrong(F const& start) {
    F f = start;
    Vector<double> const psi{{1.0, 2.0, 3.0}};
    for (int k = 0; k < 5; ++k) f.update(psi, 1.0);
    F g = std::move(f);
    for (auto const& row : {std::span<double const>(psi.data(), 3), std::span<double const>{}}) {
        if (row.empty() && detail::size_of<F> != Dynamic) continue;
        try {
            f.update(row, 1.0);  // NOLINT: what is tested
            return "took a row";
        } catch (std::invalid_argument const&) {}
    }
    if constexpr (requires { f.refactor(); }) f.refactor();
    f = g;
    return parted(twins::left_by(f, f.update(psi, 2.0)), twins::left_by(g, g.update(psi, 2.0)));
}
template <class... F>
void expect_refusals() {
    Problem<double> const problem{.size = 3};
    for (auto const& [name, what] : {std::pair(F::name, wrong(F(problem)))...}) EXPECT_EQ(what, "") << name;
}
TEST(MovedFrom, AFilterRefusesRowsUntilItIsAssignedTo) {
    []<class... F>(TypeList<F...>) { expect_refusals<F...>(); }(Variants<double>{});
}
TEST(MovedFrom, WhatIsAroundAFilterRefusesRowsUntilItIsAssignedTo) {
    using F = Ud<double>;
    using Fixed = Ud<double, 3>;
    using D = double;
    expect_refusals<Forgetting<F, ConstantForgetting<D>>, Forgetting<F, Fortescue<D>>, Forgetting<F, Kulhavy<D>>,
                    Forgetting<F, CaoSchwartz<D>>, Forgetting<F, RotatingRidge<D>>, Forgetting<F, CovarianceReset<D>>,
                    Forgetting<F, RandomWalk<D>>>();
    expect_refusals<Windowed<F>, Windowed<Fixed>, Guarded<F, rebuilding>, Guarded<Fixed, rebuilding>,
                    Guarded<Windowed<F>>, Weighted<F>, Assessed<F>>();
}

/// It has no residuals either: time that passes wrote one before the first.
TEST(MovedFrom, ExtendedLeastSquaresRefuseRowsAndTime) {
    ExtendedLeastSquares<Ud<double>> f(Problem<double>{.size = 3}, 2);
    f.update({1.0}, 1.0);
    auto g = std::move(f);
    EXPECT_THROW(f.update({1.0}, 1.0), std::invalid_argument);  // NOLINT: what is tested
    EXPECT_THROW(f.pass_time(), std::invalid_argument);
    EXPECT_EQ(f.regressors(), 0);
    f = g;
    f.pass_time(), g.pass_time();
    EXPECT_EQ(Vector<double>(f.theta()), Vector<double>(g.theta()));
}

TEST(MovedFrom, AFleetHasNoFilters) {
    using F = Fleet<Ud<Pack<double, 4>>>;
    F a(5, {.size = 2});
    Matrix<double> const psi = Matrix<double>::Constant(5, 2, 1.0);
    Vector<double> const y = Vector<double>::Constant(5, 2.0);
    a.update(psi, y);
    F b = std::move(a);
    EXPECT_EQ(a.filters(), 0);  // NOLINT: what is tested
    EXPECT_THROW(a.update(psi, y), std::invalid_argument);
    EXPECT_THROW(a.reset(0), std::invalid_argument);
    EXPECT_THROW(a.theta(0), std::invalid_argument);
    EXPECT_THROW(a.health(0), std::invalid_argument);
    a = b;
    EXPECT_EQ(a.theta(4), b.theta(4));
    for (Index const i : {Index(-1), Index(5)}) EXPECT_THROW(b.theta(i), std::invalid_argument);
    EXPECT_THROW(F(std::numeric_limits<Index>::max(), {.size = 2}), std::invalid_argument);
}
TEST(MovedFrom, OutputsRefuseARowWithoutOutputs) {
    MultiOutput<Ud<double, 2>> a({}, 3);
    MultiOutput<Ud<double, 2>> const b = std::move(a);
    EXPECT_THROW(a.update(Eigen::Vector2d(1, 2), Vector<double>()), std::invalid_argument);  // NOLINT: what is tested
    EXPECT_EQ(b.outputs(), 3);
}

// --- fixed sizes -----------------------------------------------------------------------------------------------------

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
void expect_all_refused(std::string_view name, std::initializer_list<bool> refused) {
    EXPECT_EQ(std::vector(refused), std::vector(refused.size(), true)) << name;
}
/// From the default prior, from a full one with a theta, and from none: with the problem's size and without, and in
/// the filter F of any size.
template <class Fixed, class F>
void check() {
    using P = Prior<double>;
    P full{.theta = Vector<double>{{1, -0.5, 2, 3}}};
    full.covariance = Matrix<double>{{4.0, 1.0, 0.5, 0}, {1.0, 3.0, 0.25, 0}, {0.5, 0.25, 2.0, 0.5}, {0, 0, 0.5, 1.0}};
    twins::Rows const rows = twins::taken({.seed = Seed{4}, .d = 4}, 50);
    for (std::optional<P> const& prior : {std::optional(P{}), std::optional(full), std::optional<P>()})
        if (prior || StartsWithoutPrior<F>) {
            auto const implied = twins::trace(Fixed({.forgetting = 0.96875, .prior = prior}), rows);
            Problem<double> const given{.size = 4, .forgetting = 0.96875, .prior = prior};
            twins::expect_one(F::name, implied, twins::trace(Fixed(given), rows));
            twins::expect_one(F::name, implied, twins::trace(F(given), rows));
        }
    expect_all_refused(F::name, {is_refused<Fixed>({.size = 3}), is_refused<Fixed>({.size = -1}),
                                 is_refused<Fixed>({.prior = P{.theta = Vector<double>(2)}}),
                                 is_refused<Fixed>({.prior = P{.covariance = Matrix<double>(2, 2)}})});
}
TEST(FixedSize, ImpliesTheProblems) {
    for_each(Variants<double>{}, []<class F>() {
        if constexpr (!std::is_void_v<AtSize<F, 4>>) check<AtSize<F, 4>, F>();
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
