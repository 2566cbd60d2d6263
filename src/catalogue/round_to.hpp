// How binary64 data are rounded to an arithmetic, and the random stream of a stochastic one.
#pragma once

#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/core/problem.hpp>

namespace rlslab {

/// While this object exists, stochastic rounding in this thread draws from the seed. In other arithmetics it has no
/// effect.
template <class Scalar>
struct RoundingSeedScope {
    explicit RoundingSeedScope(Seed&) {}
};
template <class Rule>
    requires Rule::may_draw
struct RoundingSeedScope<Rounded<Rule>> : StochasticStream {
    using StochasticStream::StochasticStream;
};

/// What a filter in T keeps of the arithmetic that was set when it was made: VariablePrecision's format. Nothing for
/// others. An `In` sets it again in this thread until it is destroyed.
template <class Scalar>
struct ArithmeticOfNow {
    struct In {
        explicit In(ArithmeticOfNow const&) {}
    };
};
template <>
struct ArithmeticOfNow<VariablePrecision> {
    RunTimeFormat format = PrecisionScope::format();
    struct In : PrecisionScope {
        explicit In(ArithmeticOfNow const& then) : PrecisionScope(then.format) {}
    };
};

/// How T stores a binary64 number: through T's constructor and back where T has at most 53 bits, as it is otherwise.
template <class Scalar>
struct DataRounding {
    static constexpr bool stochastic = false;
    static double round(double x) {
        if constexpr (requires {
                          static_cast<double>(Scalar(x));
                          requires ArithmeticTraits<Scalar>::digits <= 53;
                      })
            return static_cast<double>(Scalar(x));
        else return x;
    }
};
/// Data are rounded to nearest, whatever the rounding of the operations, and the reference is given the same bits.
template <class Rule>
struct DataRounding<Rounded<Rule>> {
    /// Where a setting of the thread decides, the arithmetic at run time says so.
    static constexpr bool stochastic = Rule::may_draw && std::is_empty_v<typename Rule::Setting>;
    static double round(double x) { return Rule::nearest(x); }
};

/// x as T stores it.
template <class T>
T round_to(double x) {
    return T(DataRounding<T>::round(x));
}

/// The problem with every number as T stores it.
template <class T>
Problem<T> problem_as(Problem<double> const& problem) {
    return problem.mapped<T>(&round_to<T>);
}

}  // namespace rlslab
