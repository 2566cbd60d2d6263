// The progress of a long computation.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace rlslab {

/// Called with the fraction that is done, in (0, 1], by one thread at a time.
using Progress = std::function<void(double)>;

/// Of a computation in stages: the stage's name, and the fraction of it that is done.
using StagedProgress = std::function<void(std::string_view, double)>;

/// "reference  40 %", "comparing  42 %, 3 min left": a stage, the part of it that is done, and from a tenth of it on the time that the
/// rest takes, if it takes 5 seconds or more. seconds: since the stage began.
std::string progress_text(std::string_view stage, double part, double seconds);

}  // namespace rlslab
