// What people read when their words or data cannot be used.
#pragma once

#include <rlslab/core/input_error.hpp>

#include <fmt/format.h>

namespace rlslab::report {

/// Throws InputError with this message.
template <class... Values>
[[noreturn]] void refuse(fmt::format_string<Values...> message, Values&&... values) {
    throw InputError(fmt::format(message, std::forward<Values>(values)...));
}

}  // namespace rlslab::report
