// What people read while something takes long, and where their words or data cannot be used.
#pragma once

#include <rlslab/core/input_error.hpp>

#include <fmt/format.h>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace rlslab::report {

/// Throws InputError with this message.
template <class... Values>
[[noreturn]] void refuse(fmt::format_string<Values...> message, Values&&... values) {
    throw InputError(fmt::format(message, std::forward<Values>(values)...));
}

/// Called with the fraction that is done, in (0, 1], by one thread at a time.
using Progress = std::function<void(double)>;

/// Called with the stage's name and the fraction of it that is done, as Progress is.
using StagedProgress = std::function<void(std::string_view, double)>;

/// "reference  40 %", "comparing  42 %, 3 min left": a stage, the part of it that is done, and from a tenth of it on
/// the time that the rest takes, if it takes 5 seconds or more. seconds: since the stage began.
inline std::string progress_text(std::string_view stage, double part, double seconds) {
    std::string const line = fmt::format("{} {:3} %", stage, int(100 * part));
    double const left = part < 0.1 ? 0 : seconds * (1 - part) / part;
    if (left < 5) return line;
    return line + (left < 90 ? fmt::format(", {:.0f} s left", left) : fmt::format(", {:.0f} min left", left / 60));
}

}  // namespace rlslab::report
