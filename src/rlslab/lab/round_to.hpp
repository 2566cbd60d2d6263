// Data are binary64: how an arithmetic takes them, and from where a stochastic one draws.
#pragma once

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/core/problem.hpp>

namespace rlslab {

/// While one is alive the thread's stochastic roundings draw from the seed; nothing in other arithmetics.
template <class Scalar>
struct Draws {
    explicit Draws(Seed&) {}
};
template <Format F>
struct Draws<Chopped<F, Rounding::stochastic>> : StochasticStream {
    using StochasticStream::StochasticStream;
};

/// A datum as T stores it. Data are rounded to nearest whatever the rounding of the operations: the same bits are then
/// given to the reference.
template <class Scalar>
struct Datum {
    static constexpr bool stochastic = false;
    static double round(double x) { return std::same_as<Scalar, float> ? double(float(x)) : x; }
};
template <Format F, Rounding R>
struct Datum<Chopped<F, R>> {
    static constexpr bool stochastic = R == Rounding::stochastic;
    static double round(double x) { return static_cast<double>(Chopped<F>(x)); }
};

template <>
struct Datum<Bits> {
    static constexpr bool stochastic = false;
    static double round(double x) { return static_cast<double>(Bits(x)); }
};

template <class T>
T datum(double x) {
    return T(Datum<T>::round(x));
}

/// The problem with every number as T stores it.
template <class T>
Problem<T> converted(Problem<double> const& problem) {
    Problem<T> out{.size = problem.size, .forgetting = datum<T>(problem.forgetting), .prior = std::nullopt};
    if (problem.prior) {
        out.prior = Prior<T>{.variance = datum<T>(problem.prior->variance)};
        if (problem.prior->theta) out.prior->theta = problem.prior->theta->unaryExpr(&datum<T>);
        if (problem.prior->covariance) out.prior->covariance = problem.prior->covariance->unaryExpr(&datum<T>);
    }
    return out;
}

}  // namespace rlslab
