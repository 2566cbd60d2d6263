// Filters over packs: each lane has the bits, signals, counts and state of the scalar filter on its own rows.
//
// A pack is compiled anew for each variant, rule, policy and shape. What a shape (the number of lanes, float or double,
// a size that the compiler knows or not) does is the same text for all of them, and so is what a rule does to a shape:
// each variant with each rule or policy is tried in one shape, each other shape with one variant and a few rules.
#pragma once

#include "tests/many/together.hpp"

#include <rlslab/adapt/rules.hpp>

namespace rlslab::lanes {

using twins::in;

/// make(problem) makes the filter over packs and that of numbers. Returns what the latter left.
template <class T, int L, class Make, class Act = twins::Update>
std::vector<twins::Trace> expect_lanes_of(Make make, Problem<double> const& problem,
                                          std::vector<twins::Rows> const& rows, Act const& act = {}) {
    auto const alone = make(in<T>(problem));
    using F = std::remove_cvref_t<decltype(alone)>;
    bool const with_state = !(twins::may_keep_bounds<F> && std::same_as<T, float>);
    std::vector<twins::Trace> out;
    for (twins::Rows const& mine : rows) out.push_back(twins::trace(alone, mine, with_state, act));
    twins::expect_one(F::name, twins::traces(make(in<Pack<T, L>>(problem)), rows, with_state, act), out);
    return out;
}
template <class T>
constexpr double beyond = sizeof(T) == 4 ? 1e30 : 1e200;

/// Numbers with which each rule acts in some lanes and not in others.
template <template <class> class Rule, class T>
Rule<T> chosen() {
    if constexpr (requires(Rule<T> r) { r.memory; })
        return {.noise_variance = T(0.03125), .memory = T(20), .largest_trace = T(300)};
    else if constexpr (requires(Rule<T> r) { r.least_excitation; })
        return {.forgetting = T(0.9), .least_excitation = T(1)};
    else if constexpr (requires(Rule<T> r) { r.ridge; }) return {.ridge = T(0.5)};
    else if constexpr (requires(Rule<T> r) { r.period; }) return {.period = 7, .variance = T(50)};
    else if constexpr (requires(Rule<T> r) { r.variance; }) return {.variance = T(0.015625)};
    else {
        static_assert(std::same_as<Rule<T>, ConstantForgetting<T>>, "numbers for a new rule");
        return {};
    }
}
template <template <class, int> class V, template <class> class Rule, int N>
struct Ruled {
    template <class T>
    auto operator()(Problem<T> const& problem) const {
        return Forgetting<V<T, N>, Rule<T>>(problem, chosen<Rule, T>());
    }
};
template <template <class, int> class V, template <class> class Rule, class T = double, int L = 8, int N = 3>
void expect_lanes_to_be_ruled() {
    for (bool const with_prior : {true, false}) {
        if (!with_prior && !StartsWithoutPrior<V<T, N>>) continue;
        Problem<double> problem{.size = 3, .forgetting = 0.9, .prior = Prior<double>{.variance = 16384}};
        if (!with_prior) problem.prior.reset();
        std::vector<twins::Rows> rows;
        for (int lane = 0; lane < L; ++lane) {
            rows.push_back(twins::taken({.seed = Seed{std::uint64_t(lane + 1)}, .beyond = beyond<T>}, 300));
            for (int k = 0; k < lane; ++k) rows.back()[std::size_t(k)].psi.setZero();  // determined at another row each
        }
        expect_lanes_of<T, L>(Ruled<V, Rule, N>{}, problem, rows);
    }
}
template <template <class, int> class V>
void expect_lanes_to_be_ruled_by_each() {
    expect_lanes_to_be_ruled<V, ConstantForgetting>();
    expect_lanes_to_be_ruled<V, Fortescue>();
    expect_lanes_to_be_ruled<V, Kulhavy>();
    if constexpr (ReportsInformationAlong<V<double, 3>>) expect_lanes_to_be_ruled<V, CaoSchwartz>();
    expect_lanes_to_be_ruled<V, RotatingRidge>();
    expect_lanes_to_be_ruled<V, CovarianceReset>();
    expect_lanes_to_be_ruled<V, RandomWalk>();
}

}  // namespace rlslab::lanes
