// A filter turned into another variant, or into another arithmetic, by its factors.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/finite.hpp>
#include <rlslab/linalg/triangle_of_stored.hpp>

namespace rlslab {

/// x as a To, rounded once where To or x's own type knows how; else by way of double.
template <Field To, Field From>
To number_as(From const& x) {
    if constexpr (std::same_as<To, From>) return x;
    else if constexpr (requires {
                           { widen(x) } -> std::same_as<To>;
                       })
        return widen(x);
    else if constexpr (requires { To(x.backend().data()); } && ArithmeticTraits<To>::digits > 53)
        return To(x.backend().data());
    else if constexpr (std::constructible_from<To, From const&>) return static_cast<To>(x);
    else return To(static_cast<double>(x));
}

/// What a conversion gave. Where health is not sound there is no filter:
///   undetermined   information with a pivot of zero: too few rows without a prior
///   indefinite     a pivot below zero, of a plain P or P^-1 that rounding made indefinite
///   nonfinite      an infinity or a NaN, or a number beyond the range of the arithmetic converted to
template <class F>
struct [[nodiscard]] Converted {
    std::optional<F> filter = {};
    Health health = Health::sound;

    explicit operator bool() const { return filter.has_value(); }
    F& operator*() { return *filter; }
    F const& operator*() const { return *filter; }
    F* operator->() { return &*filter; }
    F const* operator->() const { return &*filter; }
};

namespace detail {

template <class T>
Health health_of(Triangle<T> const& factor) {
    if (factor.definite) return Health::sound;
    bool finite = true, negative = false, zero = false;
    for (Index j = 0; j < factor.D.size(); ++j) {
        for (Index i = 0; i < factor.D.size(); ++i) finite = finite && is_finite(factor.F(i, j));
        finite = finite && is_finite(factor.D[j]);
        negative = negative || factor.D[j] < T(0);
        zero = zero || factor.D[j] == T(0) || factor.F(j, j) == T(0);
    }
    return negative                     ? Health::indefinite
           : zero && !factor.covariance ? Health::undetermined
           : finite                     ? Health::indefinite
                                        : Health::nonfinite;
}

/// The triangle as F stores its own, numbers rounded to T.
template <class T, class W>
Stored<T> stored_as(Stored<T> const& pattern, Triangle<W>& factor) {
    using Form = typename Stored<T>::Form;
    bool const covariance = pattern.quantity == Stored<T>::Quantity::covariance, plain = pattern.form == Form::plain;
    factor.turn_into(covariance, by_unit_triangle(pattern));
    Stored<T> out{pattern.quantity, Form::factor, factor.F.view().unaryExpr(&number_as<T, W>), {}};
    if (plain && covariance) {
        Matrix<W> const P = outer(factor.F, factor.D);
        out.form = Form::plain;
        for (Index j = 0; j < P.cols(); ++j)
            for (Index i = 0; i <= j; ++i) out.F(i, j) = out.F(j, i) = number_as<T>(P(i, j));
    } else if (by_unit_triangle(pattern)) {
        out.D = factor.D.view().unaryExpr(&number_as<T, W>);
    }
    return out;
}

/// The problem of a filter that starts as one that stores `from` and answers theta; stored as `pattern` is. One text
/// for all pairs of variants.
template <class T, class S>
Health hand_over(Stored<S> const& from, Vector<S> const& theta, Stored<T> const& pattern, Problem<T>& problem) {
    using W = std::conditional_t<(ArithmeticTraits<T>::digits > ArithmeticTraits<S>::digits), T, S>;
    Vector<T>& start = problem.prior->theta.emplace(theta.size());
    for (Index i = 0; i < theta.size(); ++i) start[i] = number_as<T>(theta[i]);
    Triangle<W> factor(from.template mapped<W>(&number_as<W, S>));
    // Looked at before it is turned, which may divide by a pivot that is not there.
    if (Health const before = health_of(factor.turn_into(factor.covariance, by_unit_triangle(from)));
        before != Health::sound)
        return before;
    bool const same_plain = from.form == Stored<S>::Form::plain && pattern.form == Stored<T>::Form::plain &&
                            factor.covariance && pattern.quantity == Stored<T>::Quantity::covariance;
    problem.prior->stored = same_plain ? from.template mapped<T>(&number_as<T, S>) : stored_as(pattern, factor);
    Triangle<T> rounded(*problem.prior->stored);
    bool const held =
        health_of(rounded.turn_into(rounded.covariance, by_unit_triangle(*problem.prior->stored))) == Health::sound;
    return held && all_finite<T>(start) ? Health::sound : Health::nonfinite;
}

}  // namespace detail

/// A filter of type To that stands where `from` stands: the same P (and its factor, where both hold the same one) and
/// theta, the next row discounted by `forgetting`. lambda is given, since a form may hold only a rounding of its
/// root.
///
///   theta as `from` answers it: bit for bit where both store it in one arithmetic
///   P by docs/state.md's table, from factor to factor, in the longer of the two arithmetics; then each number is
///   rounded once
///
/// From any variant to any dense one. A walk (Kalman's Q) does not go along; gain() is zero until the next row.
/// Allocates; d^3 operations. Throws std::invalid_argument for a forgetting outside (0, 1], or a fixed size that is
/// another. Source: Bierman 1977.
template <OverOrderedField To, OverOrderedField From>
    requires(std::same_as<Truth<typename To::scalar>, bool> && std::same_as<Truth<typename From::scalar>, bool>)
Converted<To> convert(From const& from, typename To::scalar const& forgetting = typename To::scalar(1)) {
    using T = typename To::scalar;
    Vector<typename From::scalar> const theta = from.theta();
    Problem<T> problem{.size = theta.size(), .forgetting = forgetting};
    Health const health = detail::hand_over(from.stored(), theta, To(problem).stored(), problem);
    if (health != Health::sound) return {.health = health};
    return {.filter = To(problem)};
}

}  // namespace rlslab
