// The words of a line of progress.
#include "src/lab/report/stages.hpp"

#include <fmt/format.h>

namespace rlslab::report {

std::string progress_text(std::string_view stage, double part, double seconds) {
    std::string const line = fmt::format("{} {:3} %", stage, int(100 * part));
    double const left = part < 0.1 ? 0 : seconds * (1 - part) / part;
    if (left < 5) return line;
    return line + (left < 90 ? fmt::format(", {:.0f} s left", left) : fmt::format(", {:.0f} min left", left / 60));
}

}  // namespace rlslab::report
