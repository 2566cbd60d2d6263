// Data are binary64: how an arithmetic takes them, and from where a stochastic one draws.
#pragma once

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/core/problem.hpp>

namespace rlslab {

/// While one is alive the thread's stochastic roundings draw from the seed; nothing in other arithmetics.
template <class Scalar>
struct RoundingSeedScope {
    explicit RoundingSeedScope(Seed&) {}
};
template <Format F>
struct RoundingSeedScope<Chopped<F, Rounding::stochastic>> : StochasticStream {
    using StochasticStream::StochasticStream;
};

/// A datum as T stores it. Data are rounded to nearest whatever the rounding of the operations: the same bits are then
/// given to the reference.
template <class Scalar>
struct DataRounding {
    static constexpr bool stochastic = false;
    static double round(double x) { return std::same_as<Scalar, float> ? double(float(x)) : x; }
};
template <Format F, Rounding R>
struct DataRounding<Chopped<F, R>> {
    static constexpr bool stochastic = R == Rounding::stochastic;
    static double round(double x) { return static_cast<double>(Chopped<F>(x)); }
};

template <>
struct DataRounding<VariablePrecision> {
    static constexpr bool stochastic = false;
    static double round(double x) { return static_cast<double>(VariablePrecision(x)); }
};

template <class T>
T round_to(double x) {
    return T(DataRounding<T>::round(x));
}

/// The problem with every number as T stores it.
template <class T>
Problem<T> problem_as(Problem<double> const& problem) {
    Problem<T> out{.size = problem.size, .forgetting = round_to<T>(problem.forgetting), .prior = std::nullopt};
    if (problem.prior) {
        out.prior = Prior<T>{.variance = round_to<T>(problem.prior->variance)};
        if (problem.prior->theta) out.prior->theta = problem.prior->theta->unaryExpr(&round_to<T>);
        if (problem.prior->covariance) out.prior->covariance = problem.prior->covariance->unaryExpr(&round_to<T>);
        if (problem.prior->stored) out.prior->stored = problem.prior->stored->template mapped<T>(&round_to<T>);
    }
    return out;
}

}  // namespace rlslab
