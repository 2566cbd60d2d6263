// What happens on misuse, with exceptions and without.
#pragma once

#ifdef __cpp_exceptions
#include <stdexcept>
#include <string>
#endif

namespace rlslab {

#ifndef __cpp_exceptions
/// Called on misuse where exceptions are compiled out (-fno-exceptions), with what was expected: "size >= 1". An
/// application may define it; it must not return. Where it is not defined, or returns, the program stops at a trap.
[[gnu::weak]] void on_misuse(char const* expected);
#endif

/// Throws std::invalid_argument("expected " + what) unless `holds`; without exceptions calls on_misuse(what).
inline void expects(bool holds, char const* what) {
    if (holds) return;
#ifdef __cpp_exceptions
    throw std::invalid_argument(std::string("expected ") + what);
#else
    if (on_misuse) on_misuse(what);
    __builtin_trap();
#endif
}

}  // namespace rlslab
