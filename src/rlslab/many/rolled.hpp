// What a rolling regression is given and what it leaves, in plain numbers.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rlslab {

struct RollingOptions {
    std::ptrdiff_t window = 0;  ///< rows of a group, with those that are left out; 0: all since its first
    double forgetting = 1;      ///< lambda, 0 < lambda <= 1: a row of the group's weighs lambda to its age in rows
    std::ptrdiff_t min_periods = -1;  ///< rows that are not left out, at least; -1: none, but the window has to be full
    std::ptrdiff_t threads = 1;       ///< 1 to 1024; the bits are the same
};

/// Rows of `size` contiguous numbers, `stride` >= size numbers apart. `group`: a number below `rows` for each row,
/// negative: of no group; null: all are of one.
template <class X>
struct RollingRows {
    X const* psi;
    X const* y;
    std::ptrdiff_t rows, size, stride;
    std::int64_t const* group = nullptr;
};

/// Room for the answers, a row each: theta, t and error of `size` numbers, the others of one. Null: not wanted.
struct Rolled {
    double* theta = nullptr;
    double* t = nullptr;
    double* error = nullptr;
    double* residual = nullptr;
    double* innovation = nullptr;
    double* sigma = nullptr;
    double* r2 = nullptr;
    double* rows = nullptr;
};

}  // namespace rlslab
