// THE list of arithmetics that the catalogue holds, from the shortest to the longest. Variants are compiled once for
// each, in an object library of its own (variants/CMakeLists.txt counts them).
#pragma once

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/type_list.hpp>

#include <tuple>

namespace rlslab {

using Arithmetics = std::tuple<
    Chopped<bfloat16>,
    Chopped<bfloat16, Rounding::stochastic>,
    Chopped<binary16>,
    Chopped<binary16, Rounding::stochastic>,
    float,
    double,
    long double,
    Quad,
    Reference>;

}  // namespace rlslab
