// The lanes of a filter over packs, one by one: kept and put back, copied to a filter of their own and from it.
#pragma once

#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/state/bounded_count.hpp>
#include <rlslab/state/state.hpp>

#include <vector>

namespace rlslab {

namespace detail {
/// What a filter over packs holds for each lane, in the order of its state: also the doubles of one in float (probes).
template <class P>
struct NumbersOfLanes : BareCounts {
    using Count = Lanes<Index, P::lanes>;
    using Wide = Pack<double, P::lanes>;
    static constexpr bool in_float = !std::same_as<Wide, P>;
    std::vector<P> numbers = {};
    std::vector<typename P::Mask> truths = {};
    std::vector<Count> counts = {};
    std::vector<Wide> wide = {};
    std::vector<typename Wide::Mask> wide_truths = {};
    void number(P const& x) { numbers.push_back(x); }
    void number(typename P::Mask const& x) { truths.push_back(x); }
    void number(Count const& x) { counts.push_back(x); }
    void number(Complex<P> const& x) { number(x.re), number(x.im); }
    template <class X>
    void number(X const& x) {
        if constexpr (in_float && std::same_as<X, Wide>) wide.push_back(x);
        if constexpr (in_float && std::same_as<X, typename Wide::Mask>) wide_truths.push_back(x);
    }
    void clear() { numbers.clear(), truths.clear(), counts.clear(), wide.clear(), wide_truths.clear(); }
};
/// Puts it back in the lanes of the mask.
template <class P>
struct LanesPutBack : BareCounts {
    using Kept = NumbersOfLanes<P>;
    using WideMask = typename Kept::Wide::Mask;
    typename P::Mask mask;
    WideMask wide_mask = false;
    P const* number_at;
    typename P::Mask const* truth_at;
    Lanes<Index, P::lanes> const* count_at;
    typename Kept::Wide const* wide_at;
    WideMask const* wide_truth_at;
    LanesPutBack(Kept const& from, typename P::Mask const& lanes)
        : mask(lanes), number_at(from.numbers.data()), truth_at(from.truths.data()), count_at(from.counts.data()),
          wide_at(from.wide.data()), wide_truth_at(from.wide_truths.data()) {
        Lanes<bool, P::lanes> each;
        for (int i = 0; !from.wide.empty() && i < P::lanes; ++i) each.value[size_t(i)] = lanes[i];
        wide_mask = WideMask(each);
    }
    void number(P& x) { x = select(mask, *number_at++, x); }
    void number(typename P::Mask& x) { x = (mask && *truth_at++) || (!mask && x); }
    void number(Lanes<Index, P::lanes>& x) { x = select(mask, *count_at++, x); }
    void number(Complex<P>& x) { number(x.re), number(x.im); }
    template <class X>
    void number(X& x) {
        if constexpr (Kept::in_float && std::same_as<X, typename Kept::Wide>) x = select(wide_mask, *wide_at++, x);
        if constexpr (Kept::in_float && std::same_as<X, WideMask>)
            x = (wide_mask && *wide_truth_at++) || (!wide_mask && x);
    }
};
/// Keeps f, and puts it back in the lanes of the mask when it ends. Its memory is the thread's own, and taken again.
template <class P, class F>
class LanesKept {
    F& filter_;
    typename P::Mask mask_;
    NumbersOfLanes<P> before_;
    static NumbersOfLanes<P>& spare() {
        static thread_local NumbersOfLanes<P> numbers;
        return numbers;
    }

public:
    LanesKept(F& f, typename P::Mask const& lanes) : filter_(f), mask_(lanes), before_(std::move(spare())) {
        before_.clear();
        walk(before_, filter_);
    }
    LanesKept(LanesKept const&) = delete;
    ~LanesKept() {
        LanesPutBack<P> back(before_, mask_);
        walk(back, filter_);
        spare() = std::move(before_);
    }
};
/// action(), which changes f, in these lanes, at least one: in the others f keeps what is in its state. Returns what
/// the action does. Where not all lanes change, a thread allocates at its first such call.
template <class T, class F, class Action>
auto on_lanes(F& f, Truth<T> const& lanes, Action action) {
    if constexpr (!std::same_as<Truth<T>, bool>)
        if (!all(lanes)) {
            LanesKept<T, F> const kept(f, !lanes);
            return action();
        }
    return action();
}
/// work(lane) for each of these lanes: one where T is a number.
template <class T, class Work>
void each_lane(Truth<T> const& lanes, Work work) {
    if constexpr (std::same_as<Truth<T>, bool>) {
        if (lanes) work(0);
    } else if (all(lanes)) {
        for (int lane = 0; lane < T::lanes; ++lane) work(lane);
    } else if (any(lanes)) {
        for (int lane = 0; lane < T::lanes; ++lane)
            if (lanes[lane]) work(lane);
    }
}
/// What x is in a lane.
template <class X>
    requires(!requires(X& x) { x[0]; })
X& of_lane(X& x, int) {
    return x;
}
template <class X, int L>
X& of_lane(Lanes<X, L>& x, int lane) {
    return x.value[size_t(lane)];
}
template <class X, int L>
X const& of_lane(Lanes<X, L> const& x, int lane) {
    return x[lane];
}
template <class T, int L>
T of_lane(Pack<T, L> const& x, int lane) {
    return x[lane];
}
template <class T, int L>
bool of_lane(PackMask<T, L> const& x, int lane) {
    return x[lane];
}
/// f(x) for what x is in each of T's lanes.
template <class T, class X, class Function>
auto in_each_lane(X const& x, Function f) {
    if constexpr (std::same_as<Truth<T>, bool>) {
        return f(x);
    } else {
        Lanes<decltype(f(x[0])), T::lanes> out;
        for (int lane = 0; lane < T::lanes; ++lane) out.value[size_t(lane)] = f(x[lane]);
        return out;
    }
}
/// Where a, one X for each of T's lanes, is b.
template <class T, class A, class X>
Truth<T> equal_to(A const& a, X const& b) {
    if constexpr (std::same_as<Truth<T>, bool>) {
        return a == b;
    } else {
        if (a.value == A(b).value) return true;
        Lanes<bool, T::lanes> out;
        for (size_t i = 0; i < a.value.size(); ++i) out.value[i] = a.value[i] == b;
        return Truth<T>(out);
    }
}

/// One lane of a filter over packs, or a filter of numbers, as the doubles that both have in their states: float's and
/// counts up to 2^53 fit. A bound that a filter of floats keeps in double is rounded to the lane's float.
struct LaneRead : BareCounts {
    int lane;
    std::vector<double> values = {};
    explicit LaneRead(int of) : lane(of) {}
    template <class X>
    void number(X const& x) {
        if constexpr (requires { x[lane]; }) values.push_back(double(x[lane]));
        else values.push_back(double(x));
    }
    template <class P>
    void number(Complex<P> const& x) {
        number(x.re), number(x.im);
    }
};
/// What is one for all lanes is compared, not written. keep: else all is only compared.
struct LaneWritten : BareCounts {
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
    template <class P>
    void number(Complex<P>& x) {
        number(x.re), number(x.im);
    }
    template <class X>
    void number(X& x) {
        same = same && double(x) == *at;
        if (keep) x = X(*at);
        ++at;
    }
};
/// Tells what each row showed, and takes a row in some lanes.
template <class F>
concept IsGuarded =
    requires(F& f, typename F::scalar x, Regressor<typename F::scalar> psi, Truth<typename F::scalar> m) {
        f.signal();
        f.update_lanes(m, psi, x);
    };

/// The filter of numbers whose bits one lane has: Ud<double, 4> of Ud<Pack<double, 8>, 4>.
template <class F>
struct OneLane {};
template <template <class, int> class V, class T, int L, int N>
struct OneLane<V<Pack<T, L>, N>> {
    using type = V<T, N>;
};
template <template <class, int> class V, class T, int L, int N>
struct OneLane<V<Complex<Pack<T, L>>, N>> {
    using type = V<Complex<T>, N>;
};
template <class F>
using OneLaneOf = typename OneLane<F>::type;
template <class F>
concept HasOneLane = requires { typename OneLaneOf<F>; };
template <template <class> class Around, HasOneLane F>
    requires(!IsGuarded<Around<F>>)  // which names it itself
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
/// Over numbers, or with lanes apart: what is composed around a filter may act in some lanes alone.
template <class F>
concept KeepsItsRows = std::same_as<Truth<typename F::scalar>, bool> || KeepsLanesApart<F>;

}  // namespace rlslab
