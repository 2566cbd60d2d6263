// Rules of forgetting in packs: each lane has the bits of the scalar composition on its own rows.
#include "tests/many/lanes.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace lanes;

/// Numbers with which each rule acts in some lanes and not in others.
template <class Rule>
struct Chosen;
template <class T>
struct Chosen<ConstantForgetting<T>> {
    static constexpr ConstantForgetting<T> rule{};
};
template <class T>
struct Chosen<Fortescue<T>> {
    static inline Fortescue<T> const rule{.noise_variance = T(0.03125), .memory = T(20), .largest_trace = T(300)};
};
template <class T>
struct Chosen<Kulhavy<T>> {
    static inline Kulhavy<T> const rule{.forgetting = T(0.9), .least_excitation = T(1)};
};
template <class T>
struct Chosen<CaoSchwartz<T>> {
    static inline CaoSchwartz<T> const rule{.forgetting = T(0.9), .least_excitation = T(1)};
};
template <class T>
struct Chosen<RotatingRidge<T>> {
    static inline RotatingRidge<T> const rule{.ridge = T(0.5)};
};
template <class T>
struct Chosen<CovarianceReset<T>> {
    static inline CovarianceReset<T> const rule{.period = 7, .variance = T(50)};
};
template <class T>
struct Chosen<RandomWalk<T>> {
    static inline RandomWalk<T> const rule{.variance = T(0.015625)};
};

template <template <class, int> class V, template <class> class Rule, bool guarded>
struct Ruled {
    template <class T, int N>
    using Bare = Forgetting<V<T, N>, Rule<T>>;
    template <class T, int N>
    using Filter = std::conditional_t<guarded, Guarded<Bare<T, N>>, Bare<T, N>>;

    template <int N>
    struct Make {
        template <class T>
        auto operator()(Problem<T> const& problem) const {
            Bare<T, N> const bare(problem, Chosen<Rule<T>>::rule);
            if constexpr (guarded) return Guarded<Bare<T, N>>(bare, problem);
            else return bare;
        }
    };
};

template <class R, class T, int L, int N>
void expect_each_lane_to_be_ruled_alone(std::uint64_t from, bool with_prior) {
    using P = Pack<T, L>;
    Problem<T> own = some_problem<T>(3);
    if (!with_prior) own.prior.reset();
    typename R::template Make<N> const make;
    auto together = make(own.template mapped<P>([](T x) { return P(x); }));
    std::vector alone(size_t{L}, make(own));
    std::vector<Rows<T>> rows;
    for (int lane = 0; lane < L; ++lane) rows.push_back({Seed{from + std::uint64_t(lane)}});
    Twins twins;
    for (int k = 0; k < 300; ++k) {
        Vector<P> psi(d);
        P y;
        for (int lane = 0; lane < L; ++lane) {
            auto& row = rows[size_t(lane)];
            row.next(false);
            if (k < lane) row.psi.setZero();  // theta is not determined in all lanes at once
            for (Index j = 0; j < d; ++j) psi[j].set(lane, row.psi[j]);
            y.set(lane, row.y);
        }
        auto const step = together.update(psi, y);
        for (int lane = 0; lane < L; ++lane) {
            auto& one = alone[size_t(lane)];
            auto const mine = one.update(rows[size_t(lane)].psi, rows[size_t(lane)].y);
            add_steps(twins, step, lane, mine);
            add_lanes(twins, together.theta(), lane, one.theta());
            if (!keeps_bounds<std::remove_cvref_t<decltype(one)>> && mine.health != Health::nonfinite)
                add_states(twins, together, lane, one);
            if (!twins.agree(one.name, k, lane)) return;
        }
    }
}
template <template <class, int> class V, template <class> class Rule, bool guarded, class T, int L, int N>
void expect_lanes_to_be_ruled_alone(std::uint64_t from) {
    SCOPED_TRACE(Rule<double>::name);
    for (bool with_prior : {true, false})
        if (with_prior || ReportsInformation<V<double, 3>>)
            expect_each_lane_to_be_ruled_alone<Ruled<V, Rule, guarded>, T, L, N>(from, with_prior);
}
template <template <class, int> class V, bool guarded = false, class T = double, int L = 8, int N = 3>
void expect_all_rules_in_lanes(std::uint64_t from) {
    expect_lanes_to_be_ruled_alone<V, ConstantForgetting, guarded, T, L, N>(from);
    expect_lanes_to_be_ruled_alone<V, Fortescue, guarded, T, L, N>(from);
    expect_lanes_to_be_ruled_alone<V, Kulhavy, guarded, T, L, N>(from);
    if constexpr (ReportsInformationAlong<V<double, 3>>)
        expect_lanes_to_be_ruled_alone<V, CaoSchwartz, guarded, T, L, N>(from);
    expect_lanes_to_be_ruled_alone<V, RotatingRidge, guarded, T, L, N>(from);
    expect_lanes_to_be_ruled_alone<V, CovarianceReset, guarded, T, L, N>(from);
    expect_lanes_to_be_ruled_alone<V, RandomWalk, guarded, T, L, N>(from);
}
TEST(RuledLanes, EachHasTheBitsOfItsOwnRule) {
    expect_all_rules_in_lanes<Ud>(1);
    expect_all_rules_in_lanes<Carlson>(1);
    expect_all_rules_in_lanes<Symmetric>(1);
}
TEST(RuledLanes, EachHasTheBitsOfItsOwnRuleInInformationForms) {
    expect_all_rules_in_lanes<Qr>(1);
    expect_all_rules_in_lanes<Gentleman>(1);
    expect_all_rules_in_lanes<Information>(1);
}
TEST(RuledLanes, EachHasTheBitsOfItsOwnRuleInOtherShapes) {
    expect_all_rules_in_lanes<Ud, false, double, 4, Dynamic>(20);
    expect_all_rules_in_lanes<Gentleman, false, float, 8, 3>(40);
    expect_all_rules_in_lanes<Ud, true>(60);
}

TEST(RuledLanes, RefuseNumbersThatAreNotAlike) {
    using P = Pack<double, 4>;
    P phi(0.9);
    EXPECT_NO_THROW((Forgetting<Ud<P, 2>, Kulhavy<P>>(Problem<P>{}, {.forgetting = phi})));
    phi.set(1, 0.8);
    EXPECT_THROW((Forgetting<Ud<P, 2>, Kulhavy<P>>(Problem<P>{}, {.forgetting = phi})), std::invalid_argument);
}
template <class F, class Rule>
concept CanBeRuled = requires { typename Forgetting<F, Rule>; };
static_assert(CanBeRuled<Ud<Pack<double, 8>, 4>, Kulhavy<Pack<double, 8>>>);
static_assert(!CanBeRuled<QrBlock<Pack<double, 8>, 4>, CovarianceReset<Pack<double, 8>>>);

/// Filters miss samples, begin anew, go from number to number and through a file, each with the bits of its own.
template <class R, class T, int L, int N>
void expect_each_of_a_fleet_to_be_ruled_alone(Index filters, std::uint64_t from) {
    typename R::template Make<N> const make;
    using F = Fleet<typename R::template Filter<Pack<T, L>, N>>;
    std::vector<Problem<T>> problems;
    std::vector<typename R::template Filter<T, N>> alone;
    std::vector<Rows<T>> rows;
    for (Index i = 0; i < filters; ++i) {
        problems.push_back(some_problem<T>(i));
        alone.push_back(make(problems.back()));
        rows.push_back({Seed{from + std::uint64_t(i)}});
    }
    F fleet(problems, make);
    FleetSteps<T> steps(filters);
    Seed seed{from};
    Matrix<T> psi(filters, d);
    Vector<T> y(filters);
    Twins twins;
    for (int k = 0; k < 200; ++k) {
        Index const i = std::min(filters - 1, Index(seed.uniform() * double(filters))), to = (i + 1) % filters;
        if (k % 40 == 20) {
            fleet.reset(i);
            alone[size_t(i)] = make(problems[0]);
        }
        if (k % 40 == 30) {
            fleet.put(to, fleet.filter(i));
            alone[size_t(to)] = alone[size_t(i)];
        }
        if (k % 40 == 39) {
            auto const bytes = state_of(fleet);
            F other(filters, problems[size_t(i)], make);
            twins.add(load(other, bytes) == StateFault::none, true);
            fleet = other;
        }
        for (Index m = 0; m < filters; ++m) {
            Rows<T>& mine = rows[size_t(m)];
            mine.next(false);
            psi.row(m) = mine.psi;
            y[m] = seed.uniform() < 0.2 ? std::numeric_limits<T>::quiet_NaN() : mine.y;
        }
        fleet.update(psi, y, steps, 1 + unsigned(k % 3));
        for (Index m = 0; m < filters; ++m) {
            auto& one = alone[size_t(m)];
            if (!std::isfinite(y[m])) continue;
            auto const step = one.update(Vector<T>(psi.row(m)), y[m]);
            if (fleet.health(m) == Health::nonfinite) continue;
            twins.add(steps.health[size_t(m)], step.health);
            twins.add(steps.innovation[m], step.innovation);
            twins.add_all(fleet.theta(m), one.theta());
            if (!twins.agree(one.name, k, m)) return;
        }
    }
}
template <template <class, int> class V, template <class> class Rule, bool guarded = false, int L = 8, int N = 3>
void expect_fleets_to_be_ruled() {
    for (Index filters : {1, 5, 19})
        expect_each_of_a_fleet_to_be_ruled_alone<Ruled<V, Rule, guarded>, double, L, N>(filters, 100);
}
TEST(RuledFleet, EachFilterIsRuledAlone) {
    expect_fleets_to_be_ruled<Ud, Fortescue>();
    expect_fleets_to_be_ruled<Ud, RotatingRidge>();
    expect_fleets_to_be_ruled<Symmetric, CovarianceReset>();
    expect_fleets_to_be_ruled<Qr, Kulhavy>();
    expect_fleets_to_be_ruled<Ud, Fortescue, false, 4, Dynamic>();
    expect_fleets_to_be_ruled<Ud, Fortescue, true>();
}
/// The saboteur: one bit, a NaN, a number too few.
TEST(RuledLanes, ABitThatDiffersIsSeen) {
    Twins twins;
    twins.add(1.0, 1.0), twins.add(NAN, NAN), twins.add(0.1, 0.1);
    EXPECT_EQ(twins.parted(), "");
    twins.add(1.0, 1.0 + 0x1p-52);
    EXPECT_NE(twins.parted(), "");
    twins.add(1.0, NAN);
    EXPECT_NE(twins.parted(), "");
    Ud<double, 3> one({.forgetting = 0.9}), other({.forgetting = 0.9});
    other.update({1, 2, 3}, 0);
    add_states(twins, one, 0, other);
    EXPECT_NE(twins.parted(), "");
}
/// Options are the fleet's: a guard's, too.
TEST(RuledFleet, FiltersTakeTheOptionsOfTheFleet) {
    auto const make = []<class T>(Problem<T> const& problem) {
        return Guarded<Ud<T, 2>>(problem, {.innovation = T(4), .noise_memory = 50});
    };
    Fleet<Guarded<Ud<Pack<double, 8>, 2>>> fleet(3, {}, make);
    EXPECT_NO_THROW(fleet.put(1, make(Problem<double>{})));
    EXPECT_NO_THROW(fleet.put(2, fleet.filter(1)));
    EXPECT_THROW(fleet.put(1, Guarded<Ud<double, 2>>(Problem<double>{})), std::invalid_argument);
    Fleet<Guarded<Ud<Pack<double, 8>, 2>>> without(3, {});
    EXPECT_NE(load(without, state_of(fleet)), StateFault::none);
}

}  // namespace
}  // namespace rlslab
