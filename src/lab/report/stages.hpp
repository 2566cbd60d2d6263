// The progress of a computation in stages, and the words of a line of progress.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace rlslab::report {

/// Called with the stage's name and the fraction of it that is done, as Progress is.
using StagedProgress = std::function<void(std::string_view, double)>;

/// "reference  40 %", "comparing  42 %, 3 min left": a stage, the part of it that is done, and from a tenth of it on
/// the time that the rest takes, if it takes 5 seconds or more. seconds: since the stage began.
std::string progress_text(std::string_view stage, double part, double seconds);

}  // namespace rlslab::report
