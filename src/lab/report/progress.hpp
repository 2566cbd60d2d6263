// The progress of a long computation.
#pragma once

#include <functional>

namespace rlslab::report {

/// Called with the fraction that is done, in (0, 1], by one thread at a time.
using Progress = std::function<void(double)>;

}  // namespace rlslab::report
