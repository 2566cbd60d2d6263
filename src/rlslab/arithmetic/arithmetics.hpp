// THE list of arithmetics that the catalogue holds, from the shortest to the longest. Variants are compiled once for
// each, in an object library of its own.
#pragma once

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/core/type_list.hpp>

#include <tuple>

namespace rlslab {

// One a line: CMake reads them here.
// clang-format off
using Arithmetics = std::tuple<
    Chopped<bfloat16>,
    Chopped<bfloat16, Rounding::stochastic>,
    Chopped<binary16>,
    Chopped<binary16, Rounding::stochastic>,
    float,
    double,
    Quad,
    Reference
>;
// clang-format on

/// The place behind the list: VariablePrecision, whose length is set at run time.
inline constexpr int bits_index = std::tuple_size_v<Arithmetics>;
template <int I>
using ArithmeticAt = std::tuple_element_t<I, decltype(std::tuple_cat(Arithmetics{}, std::tuple<VariablePrecision>{}))>;

}  // namespace rlslab
