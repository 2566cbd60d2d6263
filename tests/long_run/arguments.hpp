// ROWS [SEED], the command line of the long runs.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <optional>

namespace rlslab::long_run {

struct Length {
    long long rows, seed;
};

/// nullopt, and a line on standard error, for words that are no ROWS [SEED].
inline std::optional<Length> length_of(char const* program, int arguments, char** argument) {
    char* end = nullptr;
    Length const out{arguments > 1 ? std::strtoll(argument[1], &end, 10) : 0,
                     arguments > 2 ? std::strtoll(argument[2], nullptr, 10) : 71};
    if (out.rows >= 1 && out.rows <= 1'000'000'000'000 && !*end && arguments <= 3) return out;
    std::fprintf(stderr, "%s: expected ROWS [SEED], rows from 1 to 1e12\n", program);
    return {};
}

}  // namespace rlslab::long_run
