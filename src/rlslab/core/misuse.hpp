// What happens on misuse, with exceptions and without.
#pragma once

#include <cstddef>

#ifdef __cpp_exceptions
#include <cstdio>
#include <stdexcept>
#endif

namespace rlslab {

#ifndef __cpp_exceptions
/// Called on misuse where exceptions are compiled out (-fno-exceptions), with what was expected: "size >= 1". An
/// application may define it; it must not return. Where it is not defined, or returns, the program stops at a trap.
[[gnu::weak]] void on_misuse(char const* expected);
#endif

namespace detail {
/// Not inlined and not std::string: both would be compiled in every file for a message that is almost never needed.
[[noreturn, gnu::noinline, gnu::cold]] inline void misused(char const* what) {
#ifdef __cpp_exceptions
    char message[256];
    std::snprintf(message, sizeof message, "expected %s", what);
    throw std::invalid_argument(message);
#else
    if (on_misuse) on_misuse(what);
    __builtin_trap();
#endif
}
}  // namespace detail

/// Throws std::invalid_argument("expected " + what), of at most 255 characters, unless `holds`; without exceptions
/// calls on_misuse(what).
inline void expects(bool holds, char const* what) {
    if (!holds) detail::misused(what);
}

/// Whether memory could hold a b numbers: their bytes, and those of a few copies, fit a pointer difference. Asked at
/// every door at which two sizes meet, since a product that wrapped would be a vector that is too short.
constexpr bool product_fits(std::size_t a, std::size_t b) {
    constexpr std::size_t most = static_cast<std::size_t>(-1) / 128;
    return b == 0 || a <= most / b;
}

}  // namespace rlslab
