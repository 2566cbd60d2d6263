// How far along something is.
#pragma once

#include <functional>

namespace rlslab {

/// Called with the part that is done, in (0, 1], from one thread at a time.
using Progress = std::function<void(double)>;

}  // namespace rlslab
