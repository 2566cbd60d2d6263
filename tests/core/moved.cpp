// A filter that was moved from has no size: it refuses every row, and may be assigned to. What is around one refuses
// with it.
#include <rlslab/adapt/assessed.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/adapt/extended_least_squares.hpp>
#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <limits>

namespace rlslab {
namespace {

TEST(MovedFrom, AFilterRefusesRowsUntilItIsAssignedTo) {
    Vector<double> const psi{{1.0, 2.0, 3.0}};
    int tried = 0;
    for_each(Variants<double>{}, [&]<class F>() {
        F f({.size = 3});
        f.update(psi, 1.0);
        F g = std::move(f);
        EXPECT_THROW(f.update(psi, 1.0), std::invalid_argument) << F::name;  // NOLINT: what is tested
        f = g;
        f.update(psi, 2.0), g.update(psi, 2.0);
        EXPECT_EQ(Vector<double>(f.theta()), Vector<double>(g.theta())) << F::name;
        ++tried;
    });
    EXPECT_GE(tried, 15);
}

template <class F>
void check_composed(char const* what) {
    Vector<double> const psi{{1.0, 2.0, 3.0}};
    F f(Problem<double>{.size = 3});
    for (int k = 0; k < 5; ++k) f.update(psi, 1.0);
    F g = std::move(f);
    EXPECT_THROW(f.update(psi, 1.0), std::invalid_argument) << what;  // NOLINT: what is tested
    if constexpr (detail::size_of<F> == Dynamic) {
        EXPECT_THROW(f.update(std::span<double const>{}, 1.0), std::invalid_argument) << what;
    }
    if constexpr (requires { f.refactor(); }) f.refactor();
    f = g;
    f.update(psi, 2.0), g.update(psi, 2.0);
    EXPECT_EQ(Vector<double>(f.theta()), Vector<double>(g.theta())) << what;
}
TEST(MovedFrom, WhatIsAroundAFilterRefusesRowsUntilItIsAssignedTo) {
    using F = Ud<double>;
    check_composed<Forgetting<F, ConstantForgetting<double>>>("constant");
    check_composed<Forgetting<F, Fortescue<double>>>("fortescue");
    check_composed<Forgetting<F, Kulhavy<double>>>("kulhavy");
    check_composed<Forgetting<F, CaoSchwartz<double>>>("cao and schwartz");
    check_composed<Forgetting<F, RotatingRidge<double>>>("ridge");
    check_composed<Forgetting<F, CovarianceReset<double>>>("reset");
    check_composed<Forgetting<F, RandomWalk<double>>>("walk");
    check_composed<Windowed<F>>("window");
    check_composed<Windowed<Ud<double, 3>>>("window of fixed size");
    check_composed<Guarded<F, rebuilding>>("guard");
    check_composed<Guarded<Ud<double, 3>, rebuilding>>("guard of fixed size, whose kept rows are not");
    check_composed<Guarded<Windowed<F>>>("guarded window");
    check_composed<Weighted<F>>("weights");
    check_composed<Assessed<F>>("assessed");
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
