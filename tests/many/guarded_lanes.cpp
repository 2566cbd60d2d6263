// Guards in packs: each lane has the bits, signals and counts of the scalar guard on its own rows.
#include "tests/many/lanes.hpp"

#include <rlslab/adapt/weighted.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace lanes;

GuardCounts sum_of(GuardCounts a, GuardCounts const& b) {
    a.rows += b.rows, a.unusable += b.unusable, a.outliers += b.outliers;
    a.changes += b.changes, a.windups += b.windups, a.breakdowns += b.breakdowns;
    return a;
}
std::vector<Index> as_list(GuardCounts const& c) {
    return {c.rows, c.unusable, c.outliers, c.changes, c.windups, c.breakdowns};
}

/// Adds up what the scalar guards counted, so that a test can tell that every signal was seen.
template <template <class, int> class V, class T, int L, int N, GuardPolicy policy>
GuardCounts expect_each_lane_to_be_guarded_alone(std::uint64_t from) {
    using P = Pack<T, L>;
    Problem<P> common{.size = d, .forgetting = P(T(0.9375))};
    common.prior->variance = P(T(100));
    Problem<T> const own{.size = d, .forgetting = T(0.9375), .prior = Prior<T>{.variance = T(100)}};
    Guarded<V<P, N>, policy> together(common);
    std::vector<Guarded<V<T, N>, policy>> alone(size_t{L}, Guarded<V<T, N>, policy>(own));
    std::vector<Rows<T>> rows;
    for (int lane = 0; lane < L; ++lane) rows.push_back({Seed{from + std::uint64_t(lane)}});
    Twins twins;
    for (int k = 0; k < 1000; ++k) {
        Vector<P> psi(d);
        P y;
        for (int lane = 0; lane < L; ++lane) {
            rows[size_t(lane)].next(true);
            for (Index j = 0; j < d; ++j) psi[j].set(lane, rows[size_t(lane)].psi[j]);
            y.set(lane, rows[size_t(lane)].y);
        }
        auto const step = k % 50 == 49 ? together.pass_time() : together.update(psi, y);
        for (int lane = 0; lane < L; ++lane) {
            auto& one = alone[size_t(lane)];
            auto const mine = k % 50 == 49 ? one.pass_time() : one.update(rows[size_t(lane)].psi, rows[size_t(lane)].y);
            add_steps(twins, step, lane, mine);
            twins.add(double(together.signal()[lane]), double(one.signal()));
            twins.add_all(as_list(together.counts().of_lane(lane)), as_list(one.counts()));
            twins.add(together.noise_variance()[lane], one.noise_variance());
            add_lanes(twins, together.theta(), lane, one.theta());
            if (!twins.agree(V<T, N>::name, k, lane)) return {};
        }
    }
    GuardCounts all;
    for (int lane = 0; lane < L; ++lane) {
        all = sum_of(all, alone[size_t(lane)].counts());
        if (policy.breakdown != Action::reset || keeps_bounds<V<T, N>>) continue;  // what broke holds other NaN
        add_states(twins, together, lane, alone[size_t(lane)]);
        twins.agree(V<T, N>::name, 1000, lane);
    }
    return all;
}
template <template <class, int> class V, GuardPolicy policy, class T = double, int L = 8, int N = 3>
GuardCounts in_lanes() {
    auto const all = expect_each_lane_to_be_guarded_alone<V, T, L, N, policy>(1);
    EXPECT_GT(all.unusable, 100);
    EXPECT_GT(all.outliers, 20);
    EXPECT_GT(all.changes, 1);
    EXPECT_GT(all.windups, 5);
    return all;
}
TEST(GuardedLanes, EachHasTheBitsSignalsAndCountsOfItsOwnGuard) {
    in_lanes<Ud, reporting>();
    in_lanes<Ud, resetting>();
    in_lanes<Ud, GuardPolicy{.outlier = Action::skip, .breakdown = Action::reset}>();
    in_lanes<Ud, GuardPolicy{.change = Action::reset, .windup = Action::cap}>();
    in_lanes<Conventional, reporting>();
    in_lanes<Qr, resetting>();
    in_lanes<Carlson, resetting>();
    in_lanes<Gentleman, resetting>();
    in_lanes<Ud, resetting, double, 4, Dynamic>();
    EXPECT_GT((in_lanes<Conventional, resetting, float>().breakdowns), 0);
}

/// What no lane can do is refused when it is compiled.
template <class F, GuardPolicy policy>
concept CanBeGuarded = requires { typename Guarded<F, policy>; };
static_assert(CanBeGuarded<Ud<double, 4>, rebuilding> && CanBeGuarded<Ud<Pack<double, 8>, 4>, resetting>);
static_assert(!CanBeGuarded<Ud<Pack<double, 8>, 4>, rebuilding>);
static_assert(!CanBeGuarded<QrBlock<Pack<double, 8>, 4>, resetting>);
template <class F>
concept CanBeWeighted = requires { typename Weighted<F>; };
static_assert(CanBeWeighted<Guarded<Ud<double, 4>>> && !CanBeWeighted<Guarded<Ud<Pack<double, 8>, 4>>>);

TEST(GuardedLanes, RefuseOptionsThatAreNotAlike) {
    using P = Pack<double, 4>;
    P c(6.0), variance(10.0);
    variance.set(2, 20);
    EXPECT_NO_THROW((Guarded<Ud<P, 2>>(Problem<P>{}, {.largest_variance = variance, .innovation = c})));
    c.set(1, 7);
    EXPECT_THROW((Guarded<Ud<P, 2>>(Problem<P>{}, {.innovation = c})), std::invalid_argument);
}

/// Some filters miss their samples; some begin anew with another problem, come, go, and are exchanged.
template <template <class, int> class V, class T, int L, int N>
void expect_each_of_a_fleet_to_be_guarded_alone(Index filters, std::uint64_t from) {
    using One = Guarded<V<T, N>>;
    using F = Fleet<Guarded<V<Pack<T, L>, N>>>;
    struct Alone {
        One filter;
        Health health = Health::sound;
    };
    std::vector<Problem<T>> problems;
    std::vector<Alone> alone;
    std::vector<Rows<T>> rows;
    for (Index i = 0; i < filters; ++i) {
        problems.push_back(some_problem<T>(i));
        alone.push_back({One(problems.back())});
        rows.push_back({Seed{from + std::uint64_t(i)}});
    }
    F fleet(problems);
    FleetSteps<T> steps(filters);
    Seed seed{from};
    Matrix<T> psi(filters, d);
    Vector<T> y(filters);
    Twins twins;
    for (int k = 0; k < 400; ++k) {
        Index const i = std::min(filters - 1, Index(seed.uniform() * double(filters)));
        if (k % 40 == 20) {
            fleet.reset(i, problems[0]);
            alone[size_t(i)] = {One(problems[0])};
            twins.add(double(fleet.signal(i)), double(GuardSignal::none));
        }
        if (k % 40 == 30) {  // from one to another, by its bytes
            Index const to = (i + 1) % filters;
            One one(some_problem<T>(1));
            twins.add(load(one, state_of(fleet.filter(i))) == StateFault::none, true);
            fleet.put(to, one);
            alone[size_t(to)] = {alone[size_t(i)].filter};
        }
        if (k % 40 == 35) {
            fleet.remove(i);
            twins.add(double(fleet.add(problems[0])), double(i));
            alone[size_t(i)] = {One(problems[0])};
        }
        if (k % 40 == 39) {
            auto const bytes = state_of(fleet);
            F other(filters, problems[size_t(i)]);
            twins.add(load(other, bytes) == StateFault::none, true);
            fleet = other;
        }
        for (Index m = 0; m < filters; ++m) {
            Rows<T>& mine = rows[size_t(m)];
            mine.next(false);
            psi.row(m) = mine.psi;
            y[m] = mine.y;
            if (seed.uniform() < 0.1) (m % 2 ? y[m] : psi(m, 1)) = std::numeric_limits<T>::quiet_NaN();
        }
        fleet.update(psi, y, steps, 1 + unsigned(k % 3));
        auto const signals = fleet.signals();
        for (Index m = 0; m < filters; ++m) {
            auto& [one, health] = alone[size_t(m)];
            bool const taken = psi.row(m).allFinite() && std::isfinite(y[m]);
            twins.add(steps.taken[size_t(m)], taken);
            if (taken) {
                auto const step = one.update(Vector<T>(psi.row(m)), y[m]);
                if (one.signal() != GuardSignal::unusable) health = step.health;
                twins.add(steps.health[size_t(m)], step.health);
                twins.add(steps.innovation[m], step.innovation);
                twins.add(steps.gamma[m], step.gamma);
                twins.add(double(signals[size_t(m)]), double(one.signal()));
            }
            twins.add(fleet.health(m), health);
            twins.add_all(as_list(fleet.guard_counts(m)), as_list(one.counts()));
            twins.add_all(fleet.theta(m), one.theta());
            if (!twins.agree(One::name, k, m)) return;
        }
    }
    for (Index m = 0; m < filters; ++m) {
        twins.add(keeps_bounds<V<T, N>> || state_of(fleet.filter(m)) == state_of(alone[size_t(m)].filter), true);
        twins.agree(One::name, 400, m);
    }
}
template <template <class, int> class V, class T = double, int L = 8, int N = 3>
void expect_fleets_to_be_guarded() {
    for (Index filters = 1; filters <= 19; filters += 3)
        expect_each_of_a_fleet_to_be_guarded_alone<V, T, L, N>(filters, 100 + std::uint64_t(filters));
}
TEST(GuardedFleet, EachFilterIsGuardedAlone) {
    expect_fleets_to_be_guarded<Ud>();
    expect_fleets_to_be_guarded<Conventional>();
    expect_fleets_to_be_guarded<Qr>();
    expect_fleets_to_be_guarded<Ud, double, 4, Dynamic>();
    expect_fleets_to_be_guarded<Conventional, float>();
}
TEST(GuardedFleet, ARemovedFilterHasNoSignalAndNoCounts) {
    Fleet<Guarded<Ud<Pack<double, 8>, 2>>> fleet(3, {});
    fleet.remove(1);
    EXPECT_THROW(fleet.signal(1), std::invalid_argument);
    EXPECT_THROW(fleet.guard_counts(1), std::invalid_argument);
}
TEST(GuardedFleet, RefusesAFilterOfOtherOptions) {
    Fleet<Guarded<Ud<Pack<double, 8>, 2>>> fleet(3, {});
    fleet.put(1, Guarded<Ud<double, 2>>({}, {.largest_variance = 5}));
    EXPECT_THROW(fleet.put(1, Guarded<Ud<double, 2>>({}, {.innovation = 5})), std::invalid_argument);
}
/// A file that says more learnt rows than there is room for.
TEST(GuardedFleet, RefusesACountBeyondItsEnd) {
    BoundedCountOf<Lanes<Index, 4>> count{2, 3};
    std::array<std::byte, Encoding<decltype(count)>::size> bytes;
    Encoding<decltype(count)>::write(count, bytes.data());
    EXPECT_TRUE(Encoding<decltype(count)>::read(bytes.data(), count));
    count.n.value[2] = 4;
    Encoding<decltype(count)>::write(count, bytes.data());
    EXPECT_FALSE(Encoding<decltype(count)>::read(bytes.data(), count));
}

}  // namespace
}  // namespace rlslab
