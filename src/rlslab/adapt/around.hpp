// What every type around a filter answers as the filter does.
#pragma once

#include <rlslab/adapt/time_update.hpp>

#include <utility>

namespace rlslab::detail {

/// theta and the gain of f in `out`, which has its size; without the heap, also of a variant that solves for them.
template <class F, class T, int N>
void theta_of(F const& f, StateVector<T, N>& out) {
    if constexpr (requires { f.theta(out); }) {
        f.theta(out);
    } else {
        auto const theta = f.theta();
        keep_regressor(Regressor<T>(theta), out);
    }
}
template <class F, class T, int N>
void gain_of(F const& f, StateVector<T, N>& out) {
    if constexpr (requires { f.gain(out); }) {
        f.gain(out);
    } else {
        auto const K = f.gain();
        keep_regressor(Regressor<T>(K), out);
    }
}

/// The base of the types around a filter F: F itself, and F's answers where the type has none of its own. shows_form:
/// others may discount, inflate and reset F through the type.
template <class F, bool shows_form = false>
class AroundFilter {
protected:
    F filter_;
    explicit AroundFilter(F const& filter) : filter_(filter) {}
    explicit AroundFilter(F&& filter) : filter_(std::move(filter)) {}  // one copy of a large F at a time

public:
    using scalar = typename F::scalar;
    static constexpr std::string_view name = F::name;
    static constexpr bool mirrored = requires { requires F::mirrored; };

    auto theta() const { return filter_.theta(); }
    auto gain() const { return filter_.gain(); }
    Stored<scalar> stored() const { return filter_.stored(); }
    auto form()
        requires(shows_form && NamesItsForm<F>)
    {
        return filter_.form();
    }
    F const& filter() const { return filter_; }
    /// What probes inside find (Certified).
    auto certificate()
        requires requires(F& f) { f.certificate(); }
    {
        return filter_.certificate();
    }
    auto certificate() const
        requires requires(F const& f) { f.certificate(); }
    {
        return filter_.certificate();
    }
    /// Of a filter whose type only the run knows.
    std::string_view variant_name() const
        requires requires(F const& f) { f.variant_name(); }
    {
        return filter_.variant_name();
    }
};

}  // namespace rlslab::detail
