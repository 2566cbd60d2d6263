// A fleet whose filters come, go, begin anew, have problems of their own, and are saved and loaded: each has the bits
// of the scalar variant on its own rows.
#include "tests/many/lanes.hpp"

#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace lanes;

template <class T>
T number(Seed& seed) {
    return T(seed.bell());
}
Index below(Seed& seed, Index n) { return std::min(n - 1, Index(seed.uniform() * double(n))); }

template <class V>
Problem<typename V::scalar> some_problem(Seed& seed) {
    using T = typename V::scalar;
    Problem<T> p{.size = d, .forgetting = T(std::array{1.0, 0.96875, 0.9}[size_t(below(seed, 3))])};
    p.prior->variance = T(std::array{1.0, 100.0, 16384.0}[size_t(below(seed, 3))]);
    if (below(seed, 3) == 0) p.prior->theta = Vector<T>::Constant(d, number<T>(seed));
    if (below(seed, 4) == 0) {
        Matrix<T> P0 = Matrix<T>::Identity(d, d) * T(2);
        P0(0, 1) = P0(1, 0) = number<T>(seed) / T(8);
        p.prior->covariance = P0;
    }
    if constexpr (StartsWithoutPrior<V>)
        if (below(seed, 3) == 0) p.prior = std::nullopt;
    return p;
}

/// What a fleet must report of one filter.
template <class One>
struct Alone {
    One filter;
    Health health;
    FleetCounts counts = {};
    explicit Alone(Problem<typename One::scalar> const& p)
        : filter(p), health(p.prior ? Health::sound : Health::undetermined) {}
};

template <class F>
void add_fleet(Twins& twins, F const& fleet, auto const& alone) {
    auto const thetas = fleet.thetas();
    twins.add(double(thetas.rows()), double(alone.size()));
    for (Index i = 0; i < fleet.filters(); ++i) {
        auto const& mine = alone[size_t(i)];
        twins.add(fleet.alive(i), mine.has_value());
        if (!mine) {
            twins.add(thetas.row(i).array().isNaN().all(), true);
            continue;
        }
        auto const theta = fleet.theta(i);
        twins.add(fleet.health(i), mine->health);
        twins.add(double(fleet.counts(i).taken), double(mine->counts.taken));
        twins.add(double(fleet.counts(i).missing), double(mine->counts.missing));
        if (mine->health == Health::undetermined) twins.add(theta.allFinite(), mine->filter.theta().allFinite());
        else twins.add_all(theta, mine->filter.theta()), twins.add_all(thetas.row(i), theta);
    }
}

template <class V, class One>
void expect_each_to_live_alone(Index filters, std::uint64_t from, unsigned threads) {
    using T = typename One::scalar;
    Seed seed{from};
    std::vector<Problem<T>> problems;
    std::vector<std::optional<Alone<One>>> alone;
    for (Index i = 0; i < filters; ++i) {
        problems.push_back(some_problem<One>(seed));
        alone.emplace_back(problems.back());
    }
    Fleet<V> fleet(problems);
    Twins twins;
    FleetSteps<T> steps(filters);
    FleetCounts all;
    for (int k = 0; k < 60; ++k) {
        Index const i = below(seed, Index(alone.size())), action = below(seed, 9);
        auto const p = some_problem<One>(seed);
        auto& mine = alone[size_t(i)];
        if (action <= 1) {
            Index lowest = 0;
            while (lowest < Index(alone.size()) && alone[size_t(lowest)]) ++lowest;
            twins.add(double(action == 0 ? fleet.add() : fleet.add(p)), double(lowest));
            if (lowest == Index(alone.size())) alone.emplace_back();
            alone[size_t(lowest)].emplace(action == 0 ? problems[0] : p);
            steps.resize(fleet.filters());
        } else if (action <= 3 && mine) {
            fleet.remove(i);
            mine.reset();
        } else if (action == 4 && mine) {
            fleet.reset(i);
            mine.emplace(problems[0]);
        } else if (action == 5 && mine) {
            fleet.reset(i, p);
            mine.emplace(p);
        } else if (action == 6 && mine && mine->health != Health::undetermined) {  // one, by way of its bytes
            auto const bytes = state_of(fleet.filter(i));
            One one(Problem<T>{.size = d});
            twins.add(load(one, bytes) == StateFault::none, true);
            Index const to = fleet.add();
            if (to == Index(alone.size())) alone.emplace_back();
            alone[size_t(to)] = alone[size_t(i)];
            alone[size_t(to)]->counts = {};
            alone[size_t(to)]->health = Health::sound;
            fleet.put(to, one);
            steps.resize(fleet.filters());
        } else if (action == 7) {  // all
            auto const bytes = state_of(fleet);
            Fleet<V> other(fleet.filters(), problems[size_t(below(seed, filters))]);
            other.update(Matrix<T>::Ones(fleet.filters(), d), Vector<T>::Ones(fleet.filters()), threads);
            twins.add(load(other, bytes) == StateFault::none && state_of(other) == bytes, true);
            fleet = other;
        }
        Index const now = fleet.filters();
        Matrix<T> psi(now, d);
        Vector<T> y(now);
        for (Index m = 0; m < now; ++m) {
            for (Index j = 0; j < d; ++j) psi(m, j) = number<T>(seed);
            y[m] = number<T>(seed);
            if (below(seed, 6) == 0) (below(seed, 2) == 0 ? y[m] : psi(m, 1)) = std::numeric_limits<T>::infinity();
        }
        Index missing = 0;
        Index const told = k % 5 == 4 ? fleet.update(psi, y, threads) : fleet.update(psi, y, steps, threads);
        for (Index m = 0; m < now; ++m) {
            auto& one = alone[size_t(m)];
            Vector<T> const row = psi.row(m);
            bool const taken = one && row.allFinite() && std::isfinite(y[m]);
            T const none = undefined<T>();
            Step<T> step{none, none, none, Health::nonfinite};
            if (taken) {
                step = one->filter.update(row, y[m]);
                one->health = one->health == Health::undetermined ? step.health : worse(one->health, step.health);
                ++one->counts.taken, ++all.taken;
            } else if (one) ++one->counts.missing, ++missing;
            if (k % 5 == 4) continue;
            twins.add(steps.taken[size_t(m)], taken);
            twins.add(steps.health[size_t(m)], step.health);
            twins.add(steps.innovation[m], step.innovation);
            twins.add(steps.residual[m], step.residual);
            twins.add(steps.gamma[m], step.gamma);
        }
        all.missing += missing;
        twins.add(double(told), double(missing));
        add_fleet(twins, fleet, alone);
        twins.add(double(fleet.counts().taken), double(all.taken));
        twins.add(double(fleet.counts().missing), double(all.missing));
        if (!twins.agree(One::name, k, -1)) return;
    }
}
template <template <class, int> class V, class T = double, int L = 8, int N = 3>
void expect_each_to_live_alone(Index filters = 11, unsigned threads = 1) {
    for (std::uint64_t const seed : {1, 2, 3})
        expect_each_to_live_alone<V<Pack<T, L>, N>, V<T, N>>(filters, seed, threads);
}
TEST(Fleet, EachFilterLivesAlone) {
    expect_each_to_live_alone<Conventional>();
    expect_each_to_live_alone<Symmetric>();
    expect_each_to_live_alone<Potter>();
    expect_each_to_live_alone<Carlson>();
    expect_each_to_live_alone<Ud>();
    expect_each_to_live_alone<InverseQr>();
    expect_each_to_live_alone<ExtendedQr>();
    expect_each_to_live_alone<Kalman>();
    expect_each_to_live_alone<Ud, double, 4, Dynamic>(3, 3);
    expect_each_to_live_alone<Ud, float>(20, 3);
}
TEST(Fleet, EachFilterLivesAloneAlsoWithoutPrior) {
    expect_each_to_live_alone<Information>();
    expect_each_to_live_alone<Qr>();
    expect_each_to_live_alone<Gentleman>();
    expect_each_to_live_alone<Information, double, 4, Dynamic>(3, 3);
    expect_each_to_live_alone<Gentleman, float>(20, 3);
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
/// One state for the scalar variant and for each filter of a fleet.
TEST(Fleet, AFilterOfAFleetAndTheScalarVariantLoadWhatEitherSaved) {
    Four fleet = some_fleet(6);
    auto const bytes = state_of(fleet.filter(4));
    Ud<double, 2> one(Problem<double>{});
    ASSERT_EQ(load(one, bytes), StateFault::none);
    EXPECT_EQ(Vector<double>(one.theta()), fleet.theta(4));
    one.update({1.0, 2.0}, 3.0);
    Ud<double, 2> found(Problem<double>{});
    ASSERT_EQ(load(found, state_of(one)), StateFault::none);
    Fleet<Ud<Pack<double, 8>, 2>> eight(6, Problem<double>{});
    eight.put(5, found);
    one.update({1.0, -1.0}, 3.0);
    eight.update(Matrix<double>{{1, -1}}.replicate(6, 1), Vector<double>::Constant(6, 3));
    EXPECT_EQ(eight.theta(5), Vector<double>(one.theta()));
}
TEST(Fleet, AStateOfItsFirstEditionIsRefusedByName) {
    Four fleet = some_fleet(3);
    auto const bytes = state_of(fleet);
    std::vector<std::byte> old(bytes.begin(), bytes.end());
    std::byte* const entry = old.data() + StateHeader::size + 4;
    ASSERT_EQ(StateEntry::read(entry).value, 2);
    Encoding<double>::write(1, entry + 24);
    Checksum sum;
    sum.add(std::span(old).first(old.size() - 4));
    detail::write_low(sum.value(), 4, old.data() + old.size() - 4);
    EXPECT_EQ(load(fleet, old), StateFault::edition);
    EXPECT_EQ(state_of(fleet), bytes);
}

}  // namespace
}  // namespace rlslab
