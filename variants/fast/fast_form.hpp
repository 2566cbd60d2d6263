// Fast forms: exponentially weighted least squares of a delay line in O(d) operations a row. The problem that all of
// them solve, and the concept that all of them satisfy.
#pragma once

#include <rlslab/core/problem.hpp>

namespace rlslab {

/// Least squares of psi_k = (u_k, u_{k-1}, ..., u_{k-d+1}), samples before the first being 0 (prewindowed): after k
/// rows theta minimises
///
///   J_k = lambda^k theta' P0^-1 theta + sum_i lambda^(k-i) (y_i - psi_i'theta)^2,
///   P0^-1 = delta diag(1, lambda^-1, ..., lambda^-(d-1))
///
/// No other diagonal P0 fits all orders at once: P0^-1 of order m is the first block of that of order m + 1, and
/// lambda times the last (docs/theory.md 100). With lambda = 1 it is the prior P0 = c^2 I of Problem, c^2 = 1 / delta.
template <Field T>
struct FastProblem {
    Index size = 0;            ///< d >= 1, the number of taps; may be left out for a form of fixed size
    T forgetting = T(1);       ///< lambda, 0 < lambda <= 1
    T energy = T(1) / T(16384);  ///< delta > 0, in units of u^2; 2^-14 is exact in every arithmetic
};

/// Returns the problem. Throws std::invalid_argument unless size >= 1 (or, if fixed_size is not Dynamic, size is that
/// or 0), 0 < forgetting <= 1 and energy > 0.
template <Field T>
FastProblem<T> const& checked(FastProblem<T> const& problem, int fixed_size = Dynamic) {
    bool const implied = fixed_size != Dynamic && problem.size == 0;
    Index const size = implied ? fixed_size : problem.size;
    expects(size >= 1, "size >= 1");
    expects(fixed_size == Dynamic || size == fixed_size, "size equal to the form's fixed size");
    expects(all(is_forgetting_factor(problem.forgetting)), "0 < forgetting <= 1");
    expects(all(T(0) < problem.energy), "energy > 0");
    return problem;
}

namespace detail {
/// The step of a form that keeps gamma from row to row, or subtracts on the way to it. Where it should be 1, rounding
/// may carry it beyond; where it should be 0, below, if nothing divides by it (`may_vanish`). Health is indefinite only
/// if more than half of its digits are gone.
template <Field T>
Step<T> step_of_kept(T const& e, T const& gamma, Truth<T> const& finite, bool may_vanish = false) {
    Step<T> step = step_of(e, gamma);
    if constexpr (Real<T>) {
        T const rounding = T(std::ldexp(1.0, -significand_bits<T>() / 2));
        Truth<T> const above = T(1) < gamma && gamma - T(1) < rounding, below = gamma < T(0) && -gamma < rounding,
                       by_rounding = (above || (Truth<T>(may_vanish) && below)) && is_finite(e);
        step.health = select(by_rounding, PerLane<T, Health>(Health::sound), step.health);
    }
    return if_finite(finite, step);
}
/// A form that was moved from has no taps and refuses every sample.
inline Index taps_of(Index size) {
    expects(size > 0, "a form that was not moved from");
    return size;
}
}  // namespace detail

/// Mathematics: after k rows the form holds what predicts y from the last d samples u as theta of FastProblem does,
///              exactly in exact arithmetic, in O(d) numbers.
/// Members:     scalar, name                  T and the form's name
///              F(FastProblem<T>)             throws std::invalid_argument for a problem that is not well posed
///              update(u, y) -> Step<T>       one sample in; out come the a priori prediction error
///                                            y_k - psi_k'theta_{k-1} (innovation), the a posteriori one (residual),
///                                            gamma and health. Allocates nothing. Breakdown is Step::health, never an
///                                            exception: indefinite where gamma left [0, 1], nonfinite for an infinity
///                                            or a NaN, by the next row at the latest. A NaN never leaves the
///                                            recursion: start anew. Throws std::invalid_argument
///                                            where the form was moved from
///              size()                        d
/// Unchecked:   determinism; that copying copies the whole state (tests/fast check these).
/// These are no variants of the list: they take a sample, not a regressor, and hold neither P nor R.
template <class F>
concept FastForm =
    Field<typename F::scalar> && std::copyable<F> && std::constructible_from<F, FastProblem<typename F::scalar>> &&
    requires(F f, F const c, typename F::scalar u, typename F::scalar y) {
        { F::name } -> std::convertible_to<std::string_view>;
        { f.update(u, y) } -> std::same_as<Step<typename F::scalar>>;
        { c.size() } -> std::convertible_to<Index>;
    };

/// Has theta itself, not only its prediction: theta() is a view of d numbers, which the next update changes.
template <class F>
concept HasTaps = FastForm<F> && requires(F const c) {
    { c.theta() } -> std::convertible_to<Vector<typename F::scalar>>;
};

}  // namespace rlslab
