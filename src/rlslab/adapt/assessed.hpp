// How far theta and a prediction may be off: the noise's variance, and what follows from P.
#pragma once

#include <rlslab/adapt/around.hpp>
#include <rlslab/adapt/diagnostics.hpp>

#include <tuple>

namespace rlslab {

struct AssessedOptions {
    Index noise_memory = 1000;  ///< rows that the noise's variance is averaged over, >= 1
};

/// A number and its standard deviation; `low` and `high` are so many of these away.
template <Field T>
struct Interval {
    T value, deviation, low, high;
};

namespace detail {
/// Rows in the window of f, or of what f is around; -1: f has none.
template <class F>
Index window_rows(F const& f) {
    if constexpr (requires { f.refactored(); }) return f.rows();
    else if constexpr (requires { f.filter(); }) return window_rows(f.filter());
    else return -1;
}
/// A rule of its own says how f forgets. Where only the run knows, f tells.
template <class F>
bool has_a_rule(F const& f) {
    if constexpr (requires { f.follows_a_rule(); }) return f.follows_a_rule();
    else if constexpr (requires { f.rule(); }) return true;
    else if constexpr (requires { f.filter(); }) return has_a_rule(f.filter());
    else return false;
}
/// The guard that f is, or is around; or none, which never did anything.
template <class F>
auto const& guard_of(F const& f) {
    static constexpr struct {
        bool set_aside() const { return false; }
        bool restarted() const { return false; }
    } none;
    if constexpr (requires { f.set_aside(), f.restarted(); }) return f;
    else if constexpr (requires { f.filter(); }) return guard_of(f.filter());
    else return none;
}
}  // namespace detail

/// F, and what its numbers are worth. With sigma^2 the noise's variance, n the rows in memory (in the window; else
/// taken so far):
///
///   (1) r = (1 + lambda^n) / (1 + lambda): cov theta = sigma^2 r P for stationary rows, to first order in d (1 -
///       lambda); at most sigma^2 P for any rows
///   (2) E gamma e^2 = sigma^2 (gamma + r lambda (1 - gamma)), r of before the row: s2 is the mean of gamma e^2 over
///       that, of all rows at first, then over `noise_memory` rows. Rows of gamma <= 0.001 show theta, not the noise,
///       and do not enter
///   (3) theta_j +- q sqrt(s2 r P_jj)        (4) psi'theta +- q sqrt(s2 (1 + r psi'P psi)), an interval of the next y
///
/// q           the quantile: 1.96 for 95 % where s2 is known well, else Student's with degrees() degrees of freedom
/// F           a variant, or what is around one. Where a rule forgets, r = 1: intervals up to sqrt(2) too wide, not too
///             narrow. Rows that a guard sets aside do not enter s2; where it starts anew n = 0. A row by which it
///             holds P down counts as knowledge, as the prior does
/// Assumes a fixed theta and noise white and independent of psi. Until s2 has rows, deviations are NaN. Cost O(1) a
/// row; (3) that of variance(F, j), (4) that of variance_along. Allocates as F does.
/// Throws std::invalid_argument for a noise memory below 1, a psi of another size, or j outside 0 ... d-1. Source:
/// docs/theory.md 61.
template <OverOrderedField F>
    requires Real<typename F::scalar> && std::same_as<Truth<typename F::scalar>, bool> &&
             requires(F& f, Regressor<typename F::scalar> psi) { variance(f, Index(0)), variance_along(f, psi); }
class Assessed : public detail::AroundFilter<F> {
    using T = typename F::scalar;
    using detail::AroundFilter<F>::filter_;
    StateVector<T, detail::size_of<F>> scratch_;
    AssessedOptions options_;
    T lambda_, power_ = T(1), s2_ = T(0);  // lambda^n
    Index learnt_ = 0, in_power_ = 0;      // rows of s2; n, where there is a window

public:
    static constexpr bool departs = true;  ///< nothing goes around it but weights

    explicit Assessed(Problem<T> const& problem, AssessedOptions const& options = {})
        : Assessed(F(problem), problem.forgetting, options) {}
    /// Around a filter that was made with options of its own. `forgetting` is the problem's.
    Assessed(F const& filter, T const& forgetting, AssessedOptions const& options = {})
        : detail::AroundFilter<F>(filter), scratch_(filter.theta().size()), options_(options), lambda_(forgetting) {
        expects(all(is_forgetting_factor(forgetting)), "0 < forgetting <= 1");
        expects(options.noise_memory >= 1, "a noise memory of >= 1 row");
    }

    Step<T> update(Regressor<T> psi, T y) {
        T const r = share();
        Step<T> const step = filter_.update(psi, y);
        T const square = step.innovation * step.residual, expected = step.gamma + r * lambda_ * (T(1) - step.gamma);
        if (step.health == Health::sound && !detail::guard_of(filter_).set_aside() && T(0) <= square &&
            is_finite(square) && T(0.001) < step.gamma) {
            if (learnt_ < options_.noise_memory) ++learnt_;
            s2_ += (square / expected - s2_) / T(double(learnt_));  // (2)
        }
        grow();
        return step;
    }
    /// Time passes and nothing is learnt, of the noise neither.
    Step<T> pass_time() {
        Step<T> const step = detail::pass_time(filter_, scratch_);
        grow();
        return step;
    }
    static constexpr std::string_view layer = "assessed";
    static std::array<StateOption, 1> options(auto const& f) {
        return {{{"noise_memory", double(f.options_.noise_memory)}}};
    }
    static auto state(auto& f) { return std::tie(f.filter_, f.lambda_, f.power_, f.s2_, f.learnt_, f.in_power_); }

    T noise_variance() const { return s2_; }   ///< s2; 0 before the first row
    Index degrees() const { return learnt_; }  ///< of freedom of s2, about
    T share() const { return detail::has_a_rule(filter_) ? T(1) : (T(1) + power_) / (T(1) + lambda_); }  ///< r, (1)

    /// (3). Of a const filter a copy answers, which allocates as F does: (3) and (4) use F's workspace.
    Interval<T> interval(Index j, T const& q = T(1.96)) {
        expects(0 <= j && j < filter_.theta().size(), "a parameter from 0 to d - 1");
        return around(filter_.theta()[j], share() * variance(filter_, j), q);
    }
    /// (4). psi may be the gain's own numbers.
    Interval<T> prediction(Regressor<T> psi, T const& q = T(1.96)) {
        auto const theta = filter_.theta();
        expects(psi.size() == theta.size(), "a regressor of the problem's size");
        T const value = dot(psi.data(), theta.data(), psi.size());
        return around(value, T(1) + share() * variance_along(filter_, psi), q);
    }
    Interval<T> interval(Index j, T const& q = T(1.96)) const { return Assessed(*this).interval(j, q); }
    Interval<T> prediction(Regressor<T> psi, T const& q = T(1.96)) const { return Assessed(*this).prediction(psi, q); }

private:
    void grow() {
        Index const rows = detail::window_rows(filter_);
        if (rows < 0) {
            power_ = detail::guard_of(filter_).restarted() ? T(1) : T(power_ * lambda_);
            return;
        }
        if (rows < in_power_) power_ = T(1), in_power_ = 0;
        for (; in_power_ < rows; ++in_power_) power_ *= lambda_;
    }
    Interval<T> around(T const& value, T const& factor, T const& q) const {
        T const deviation = learnt_ > 0 ? square_root(T(s2_ * factor)) : undefined<T>();
        return {value, deviation, value - q * deviation, value + q * deviation};
    }
};

}  // namespace rlslab
