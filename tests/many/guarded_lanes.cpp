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
    for (int k = 0; k < 1000; ++k) {
        Vector<P> psi(d);
        P y;
        for (int lane = 0; lane < L; ++lane) {
            rows[size_t(lane)].next(true);
            for (Index j = 0; j < d; ++j) psi[j].set(lane, rows[size_t(lane)].psi[j]);
            y.set(lane, rows[size_t(lane)].y);
        }
        auto const step = k % 50 == 49 ? together.pass_time() : together.update(psi, y);
        auto const theta = together.theta();
        for (int lane = 0; lane < L; ++lane) {
            auto& one = alone[size_t(lane)];
            auto const mine = k % 50 == 49 ? one.pass_time() : one.update(rows[size_t(lane)].psi, rows[size_t(lane)].y);
            std::string const where = std::string(V<T, N>::name) + " " + std::to_string(k) + " " + std::to_string(lane);
            EXPECT_EQ(step.health[lane], mine.health) << where;
            EXPECT_TRUE(same(step.innovation[lane], mine.innovation)) << where;
            EXPECT_TRUE(same(step.residual[lane], mine.residual)) << where;
            EXPECT_TRUE(same(step.gamma[lane], mine.gamma)) << where;
            EXPECT_EQ(together.signal()[lane], one.signal()) << where;
            EXPECT_EQ(as_list(together.counts().of_lane(lane)), as_list(one.counts())) << where;
            EXPECT_TRUE(same(together.noise_variance()[lane], one.noise_variance())) << where;
            auto const theta_of_one = one.theta();
            for (Index j = 0; j < d; ++j) EXPECT_TRUE(same(theta[j][lane], T(theta_of_one[j]))) << where;
            if (testing::Test::HasFailure()) return {};
        }
    }
    GuardCounts all;
    for (int lane = 0; lane < L; ++lane) {
        all = sum_of(all, alone[size_t(lane)].counts());
        detail::LaneRead of_lane(lane), of_one(0);  // the whole state
        detail::walk(of_lane, together);
        detail::walk(of_one, alone[size_t(lane)]);
        EXPECT_EQ(of_lane.values.size(), of_one.values.size());
        if (policy.breakdown != Action::reset || keeps_bounds<V<T, N>>) continue;  // what broke holds other NaN
        for (size_t i = 0; i < of_one.values.size(); ++i)
            EXPECT_TRUE(same(of_lane.values[i], of_one.values[i])) << V<T, N>::name << " " << lane << " " << i;
    }
    return all;
}
template <template <class, int> class V, GuardPolicy policy>
GuardCounts in_all_packs() {
    auto const all = sum_of(sum_of(expect_each_lane_to_be_guarded_alone<V, double, 8, 3, policy>(1),
                                   expect_each_lane_to_be_guarded_alone<V, double, 4, Dynamic, policy>(20)),
                            expect_each_lane_to_be_guarded_alone<V, float, 8, 3, policy>(40));
    EXPECT_GT(all.unusable, 100);
    EXPECT_GT(all.outliers, 50);
    EXPECT_GT(all.changes, 5);
    EXPECT_GT(all.windups, 20);
    return all;
}
TEST(GuardedLanes, EachHasTheBitsSignalsAndCountsOfItsOwnGuard) {
    in_all_packs<Ud, reporting>();
    in_all_packs<Ud, resetting>();
    in_all_packs<Ud, GuardPolicy{.outlier = Action::skip, .breakdown = Action::reset}>();
    in_all_packs<Ud, GuardPolicy{.change = Action::reset, .windup = Action::cap}>();
    in_all_packs<Conventional, reporting>();
    EXPECT_GT((in_all_packs<Conventional, resetting>().breakdowns), 0);
    in_all_packs<Qr, resetting>();
    expect_each_lane_to_be_guarded_alone<Carlson, double, 8, 3, resetting>(60);
    expect_each_lane_to_be_guarded_alone<Gentleman, double, 8, 3, resetting>(80);
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
    for (int k = 0; k < 400; ++k) {
        Index const i = std::min(filters - 1, Index(seed.uniform() * double(filters)));
        if (k % 40 == 20) {
            fleet.reset(i, problems[0]);
            alone[size_t(i)] = {One(problems[0])};
            EXPECT_EQ(fleet.signal(i), GuardSignal::none);
        }
        if (k % 40 == 30) {  // from one to another, by its bytes
            Index const to = (i + 1) % filters;
            One one(some_problem<T>(1));
            ASSERT_EQ(load(one, state_of(fleet.filter(i))), StateFault::none);
            fleet.put(to, one);
            alone[size_t(to)] = {alone[size_t(i)].filter};
        }
        if (k % 40 == 35) {
            fleet.remove(i);
            EXPECT_THROW(fleet.signal(i), std::invalid_argument);
            EXPECT_THROW(fleet.guard_counts(i), std::invalid_argument);
            EXPECT_EQ(fleet.add(problems[0]), i);
            alone[size_t(i)] = {One(problems[0])};
        }
        if (k % 40 == 39) {
            auto const bytes = state_of(fleet);
            F other(filters, problems[size_t(i)]);
            ASSERT_EQ(load(other, bytes), StateFault::none);
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
            std::string const where = std::string(One::name) + " " + std::to_string(k) + " " + std::to_string(m);
            bool const taken = psi.row(m).allFinite() && std::isfinite(y[m]);
            ASSERT_EQ(steps.taken[size_t(m)], taken) << where;
            if (taken) {
                auto const step = one.update(Vector<T>(psi.row(m)), y[m]);
                if (one.signal() != GuardSignal::unusable) health = step.health;
                ASSERT_EQ(steps.health[size_t(m)], step.health) << where;
                ASSERT_TRUE(same(steps.innovation[m], step.innovation)) << where;
                ASSERT_TRUE(same(steps.gamma[m], step.gamma)) << where;
                ASSERT_EQ(signals[size_t(m)], one.signal()) << where;
            }
            ASSERT_EQ(fleet.health(m), health) << where;
            ASSERT_EQ(as_list(fleet.guard_counts(m)), as_list(one.counts())) << where;
            auto const theta = fleet.theta(m);
            for (Index j = 0; j < d; ++j) ASSERT_TRUE(same(theta[j], T(one.theta()[j]))) << where;
        }
    }
    for (Index m = 0; m < filters; ++m)
        EXPECT_TRUE((keeps_bounds<V<T, N>>) || state_of(fleet.filter(m)) == state_of(alone[size_t(m)].filter)) << m;
}
template <template <class, int> class V>
void expect_all_fleets_to_be_guarded() {
    for (Index filters = 1; filters <= 19; filters += 3) {
        expect_each_of_a_fleet_to_be_guarded_alone<V, double, 8, 3>(filters, 100 + std::uint64_t(filters));
        expect_each_of_a_fleet_to_be_guarded_alone<V, double, 4, Dynamic>(filters, 200 + std::uint64_t(filters));
        expect_each_of_a_fleet_to_be_guarded_alone<V, float, 8, 3>(filters, 300 + std::uint64_t(filters));
    }
}
TEST(GuardedFleet, EachFilterIsGuardedAlone) {
    expect_all_fleets_to_be_guarded<Ud>();
    expect_all_fleets_to_be_guarded<Conventional>();
    expect_all_fleets_to_be_guarded<Qr>();
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
