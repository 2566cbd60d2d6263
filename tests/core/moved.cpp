// A filter that was moved from has no size: it refuses every row, and may be assigned to. What is around one refuses
// with it.
#include "tests/common/twins.hpp"

#include <rlslab/adapt/assessed.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/adapt/extended_least_squares.hpp>
#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/adapt/weighted.hpp>
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

}  // namespace
}  // namespace rlslab
