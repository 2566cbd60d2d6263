// The lanes of a filter over packs, one by one: kept and put back, copied to a filter of their own and from it.
#pragma once

#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/state/state.hpp>

#include <vector>

namespace rlslab {

namespace detail {
/// What a filter over packs holds for each lane, in the order of its state.
template <class P>
struct NumbersOfLanes : Silent {
    using Count = Lanes<Index, P::lanes>;
    std::vector<P> numbers = {};
    std::vector<typename P::Mask> truths = {};
    std::vector<Count> counts = {};
    void number(P const& x) { numbers.push_back(x); }
    void number(typename P::Mask const& x) { truths.push_back(x); }
    void number(Count const& x) { counts.push_back(x); }
    template <class X>
    void number(X const&) {}
    void clear() { numbers.clear(), truths.clear(), counts.clear(); }
};
/// Puts it back in the lanes of the mask.
template <class P>
struct LanesPutBack : Silent {
    typename P::Mask mask;
    P const* number_at;
    typename P::Mask const* truth_at;
    Lanes<Index, P::lanes> const* count_at;
    LanesPutBack(NumbersOfLanes<P> const& from, typename P::Mask const& lanes)
        : mask(lanes), number_at(from.numbers.data()), truth_at(from.truths.data()), count_at(from.counts.data()) {}
    void number(P& x) { x = select(mask, *number_at++, x); }
    void number(typename P::Mask& x) { x = (mask && *truth_at++) || (!mask && x); }
    void number(Lanes<Index, P::lanes>& x) { x = select(mask, *count_at++, x); }
    template <class X>
    void number(X const&) {}
};

/// One lane of a filter over packs, or a filter of numbers, as the doubles that both have in their states: float's and
/// counts up to 2^53 fit. A bound that a filter of floats keeps in double is rounded to the lane's float.
struct LaneRead : Silent {
    int lane;
    std::vector<double> values = {};
    explicit LaneRead(int of) : lane(of) {}
    template <class X>
    void number(X const& x) {
        if constexpr (requires { x[lane]; }) values.push_back(double(x[lane]));
        else values.push_back(double(x));
    }
};
/// What is one for all lanes is compared, not written. keep: else all is only compared.
struct LaneWritten : Silent {
    int lane;
    bool keep, same = true;
    double const* at;
    LaneWritten(int to, bool keep_them, std::vector<double> const& values)
        : lane(to), keep(keep_them), at(values.data()) {}
    template <class T, int L>
    void number(Pack<T, L>& x) {
        if (keep) x.set(lane, T(*at));
        ++at;
    }
    template <class T, int L>
    void number(PackMask<T, L>& x) {
        Lanes<bool, L> truths;
        for (int i = 0; i < L; ++i) truths.value[size_t(i)] = i == lane ? *at != 0 : x[i];
        if (keep) x = PackMask<T, L>(truths);
        ++at;
    }
    template <class X, int L>
    void number(Lanes<X, L>& x) {
        if (keep) x.value[size_t(lane)] = X(*at);
        ++at;
    }
    template <class X>
    void number(X& x) {
        same = same && double(x) == *at;
        if (keep) x = X(*at);
        ++at;
    }
};
/// The filter of numbers whose bits one lane has: Ud<double, 4> of Ud<Pack<double, 8>, 4>.
template <class F>
struct OneLane {};
template <template <class, int> class V, class T, int L, int N>
struct OneLane<V<Pack<T, L>, N>> {
    using type = V<T, N>;
};
template <class F>
using OneLaneOf = typename OneLane<F>::type;
template <class F>
concept HasOneLane = requires { typename OneLaneOf<F>; };
template <template <class> class Around, HasOneLane F>
struct OneLane<Around<F>> {
    using type = Around<OneLaneOf<F>>;
};

template <class X>
constexpr bool counts_all_lanes_at_once();
template <class... Members>
constexpr bool any_counts(std::tuple<Members&...> const*) {
    return (counts_all_lanes_at_once<std::remove_const_t<Members>>() || ...);
}
template <class X>
constexpr bool counts_all_lanes_at_once() {
    if constexpr (NamesItsState<X>) return any_counts(static_cast<decltype(X::state(std::declval<X&>()))*>(nullptr));
    else return std::integral<X> && !std::same_as<X, bool>;
}
}  // namespace detail

/// A variant over a Pack whose lanes have nothing in common but options. QrBlock counts the rows of all lanes at once:
/// a fleet of it would take the rows of one filter for another's.
template <class F>
concept KeepsLanesApart = requires { F::scalar::lanes; } && NamesItsState<F> && !detail::counts_all_lanes_at_once<F>();

}  // namespace rlslab
