// Rolling and grouped regressions, compiled once. Needs headers and Eigen where it is compiled, and neither where it is
// used.
#pragma once

#include <rlslab/many/rolled.hpp>

namespace rlslab::native {

/// rlslab::rolling (many/rolling.hpp): for each row the least squares of the last rows of its group.
void rolling(RollingRows<double> const& rows, RollingOptions const& options, Rolled const& out);
void rolling(RollingRows<float> const& rows, RollingOptions const& options, Rolled const& out);
/// As many threads as `use_threads` (native/outputs.hpp) said last.
std::ptrdiff_t threads();

}  // namespace rlslab::native
