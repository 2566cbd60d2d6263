// A fleet: what it holds, what it refuses, and what would go wrong without it.
#include "tests/common/states.hpp"

#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

TEST(Fleet, HoldsWhatPersistsAlone) {  // theta, D and what is above U's diagonal; theta and P
    Problem<double> const p{.size = 4};
    EXPECT_EQ((Fleet<Ud<Pack<double, 8>, 4>>(9, p).bytes_per_filter()), (4 + 4 + 6) * 8);
    EXPECT_EQ((Fleet<Conventional<Pack<double, 8>, 4>>(9, p).bytes_per_filter()), (4 + 16) * 8);
}

template <class F>
concept MakesAFleet = requires { typename Fleet<F>; };
TEST(Fleet, TakesNoFilterThatCountsTheRowsOfAllLanesAtOnce) {
    static_assert(MakesAFleet<Information<Pack<double, 8>>> && MakesAFleet<Kalman<Pack<double, 8>>>);
    static_assert(!MakesAFleet<QrBlock<Pack<double, 8>>>);
}

/// A filter over packs that is given zeros for what is missing, as a fleet without memory would: it forgets.
TEST(Fleet, WithoutPuttingBackTheBitsWouldDiffer) {
    using P = Pack<double, 8>;
    Ud<P, 3> careless({.size = 3, .forgetting = P(0.99)});
    Ud<double, 3> one({.size = 3, .forgetting = 0.99});
    Eigen::Vector3d const psi(1, 2, 3);
    Vector<P> const row = psi.unaryExpr([](double x) { return P(x); });
    careless.update(row, P(1.0));
    careless.update(Vector<P>(Vector<P>::Constant(3, P(0.0))), P(0.0));
    careless.update(row, P(2.0));
    one.update(psi, 1.0);
    one.update(psi, 2.0);
    EXPECT_NE(careless.theta()[0][0], one.theta()[0]);
}

TEST(Fleet, MisuseThrowsBeforeAnythingChanges) {
    using F = Fleet<Ud<Pack<double, 8>, 3>>;
    EXPECT_THROW(F(0, {.size = 3}), std::invalid_argument);
    EXPECT_THROW(F(-1, {.size = 3}), std::invalid_argument);
    EXPECT_THROW(F(5, {.size = 4}), std::invalid_argument);
    EXPECT_THROW(F(5, {.size = 3, .forgetting = 2}), std::invalid_argument);
    F fleet(5, {.size = 3});
    EXPECT_THROW(fleet.update(Matrix<double>::Zero(4, 3), Vector<double>::Zero(5)), std::invalid_argument);
    EXPECT_THROW(fleet.update(Matrix<double>::Zero(5, 2), Vector<double>::Zero(5)), std::invalid_argument);
    EXPECT_THROW(fleet.update(Matrix<double>::Zero(5, 3), Vector<double>::Zero(6)), std::invalid_argument);
    EXPECT_EQ(fleet.update(Matrix<double>::Zero(5, 3), Vector<double>::Zero(5), 0), 0);
}

using Four = Fleet<Ud<Pack<double, 4>, 2>>;
Four some_fleet(Index filters) {
    Four fleet(filters, {.forgetting = 0.96875});
    Seed seed{7};
    for (int k = 0; k < 5; ++k) {
        Matrix<double> psi(filters, 2);
        Vector<double> y(filters);
        for (double* x : {psi.data(), psi.data() + filters, y.data()})
            for (Index i = 0; i < filters; ++i) x[i] = seed.bell();
        fleet.update(psi, y);
    }
    return fleet;
}
TEST(Fleet, RecordsHoldLambdaOnlyWhereLambdasDiffer) {
    Four fleet = some_fleet(9);
    Index const bytes = fleet.bytes_per_filter();
    EXPECT_EQ(bytes, (2 + 2 + 1) * 8);
    fleet.reset(3, {.forgetting = 0.96875, .prior = Prior<double>{.variance = 7}});
    EXPECT_EQ(fleet.bytes_per_filter(), bytes);
    fleet.reset(3, {.forgetting = 0.5});
    EXPECT_EQ(fleet.bytes_per_filter(), bytes + 2 * 8);  // lambda, and its quotient
    Four other(9, {.forgetting = 1});
    EXPECT_EQ(load(other, state_of(some_fleet(9))), StateFault::none);
    EXPECT_EQ(other.bytes_per_filter(), bytes);
}
TEST(Fleet, ARemovedFilterTakesNoRows) {
    Four fleet = some_fleet(5);
    for (Index i = 0; i < 5; ++i) fleet.remove(i);
    FleetSteps<double> steps(5);
    EXPECT_EQ(fleet.update(Matrix<double>::Ones(5, 2), Vector<double>::Constant(5, NAN), steps), 0);
    EXPECT_EQ(fleet.update(Matrix<double>::Ones(5, 2), Vector<double>::Ones(5), steps), 0);
    EXPECT_EQ(fleet.counts().taken, 25);
    EXPECT_EQ(steps.taken, std::vector<std::uint8_t>(5, 0));
    EXPECT_TRUE(fleet.thetas().array().isNaN().all());
    EXPECT_EQ(fleet.filters(), 5);
    for (Index i : {-1, 0, 4, 5}) {
        EXPECT_FALSE(fleet.alive(i));
        EXPECT_THROW(fleet.theta(i), std::invalid_argument);
        EXPECT_THROW(fleet.health(i), std::invalid_argument);
        EXPECT_THROW(fleet.counts(i), std::invalid_argument);
        EXPECT_THROW(fleet.filter(i), std::invalid_argument);
        EXPECT_THROW(fleet.reset(i), std::invalid_argument);
        EXPECT_THROW(fleet.remove(i), std::invalid_argument);
        EXPECT_THROW(fleet.put(i, Ud<double, 2>(Problem<double>{})), std::invalid_argument);
    }
    EXPECT_EQ(fleet.add(), 0);
    EXPECT_EQ(fleet.theta(0), Vector<double>(Vector<double>::Zero(2)));
    EXPECT_EQ(fleet.update(Matrix<double>::Ones(5, 2), Vector<double>::Constant(5, NAN)), 1);
}
TEST(Fleet, AStepThatBrokeDownWasTaken) {
    Four fleet(2, {.prior = Prior<double>{.variance = 1e300}});
    FleetSteps<double> steps(2);
    fleet.update(Matrix<double>{{1e300, 1}, {1, 1}}, Vector<double>{{1, NAN}}, steps);
    EXPECT_EQ(steps.taken, (std::vector<std::uint8_t>{1, 0}));
    EXPECT_EQ(steps.health, std::vector<Health>(2, Health::nonfinite));
    EXPECT_EQ(fleet.health(0), Health::nonfinite);
    EXPECT_EQ(fleet.health(1), Health::sound);
}
/// What throws leaves every byte as it was.
TEST(Fleet, MisuseOfAChangeThrowsBeforeAnythingChanges) {
    using Any = Fleet<Information<Pack<double, 4>>>;
    Any fleet(5, {.size = 2});
    fleet.update(Matrix<double>::Ones(5, 2), Vector<double>::Ones(5));
    auto const before = state_of(fleet);
    Matrix<double> const psi = Matrix<double>::Ones(5, 2);
    Vector<double> const y = Vector<double>::Ones(5);
    FleetSteps<double> four(4);
    EXPECT_THROW(fleet.update(psi, y, four), std::invalid_argument);
    EXPECT_THROW(fleet.add({.size = 3}), std::invalid_argument);
    EXPECT_THROW(fleet.add({.size = 2, .forgetting = 0}), std::invalid_argument);
    EXPECT_THROW(fleet.reset(0, {.size = 1}), std::invalid_argument);
    EXPECT_THROW(fleet.put(0, Information<double>({.size = 3})), std::invalid_argument);
    Information<double> unreported({.size = 2});
    unreported.accumulate({1.0, 2.0}, 3.0);
    EXPECT_THROW(fleet.put(0, unreported), std::invalid_argument);
    EXPECT_EQ(state_of(fleet), before);
    EXPECT_EQ(fleet.filters(), 5);
    std::vector<Problem<double>> problems;
    EXPECT_THROW((Any(problems)), std::invalid_argument);
    problems = {{.size = 2}, {.size = 3}};
    EXPECT_THROW((Any(problems)), std::invalid_argument);
    Fleet<Kalman<Pack<double, 4>, 2>> walkers(1, Problem<double>{});
    EXPECT_THROW(walkers.put(0, Kalman<double, 2>({}, Matrix<double>::Identity(2, 2))), std::invalid_argument);
}
TEST(Fleet, AStateOfAnotherNumberOfFiltersIsRefused) {
    Four other = some_fleet(10);
    EXPECT_EQ(load(other, state_of(some_fleet(9))), StateFault::options);
}
TEST(Fleet, AStateOfItsFirstEditionIsRefusedByName) {
    Four fleet = some_fleet(3);
    auto const bytes = states::bytes_of(fleet);
    auto old = bytes;
    std::byte* const entry = old.data() + StateHeader::size + 4;
    ASSERT_EQ(StateEntry::read(entry).value, 2);
    Encoding<double>::write(1, entry + 24);
    EXPECT_EQ(load(fleet, states::sealed(old)), StateFault::edition);
    EXPECT_EQ(states::bytes_of(fleet), bytes);
}

}  // namespace
}  // namespace rlslab
