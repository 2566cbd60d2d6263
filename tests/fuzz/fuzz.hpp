// A fuzz target: take() must neither crash nor throw anything except the errors with which input is refused.
#pragma once

#include <rlslab/core/input_error.hpp>

#include <cstdio>
#include <cstdlib>

namespace rlslab::fuzz {

/// A property that failed ends the program, as libFuzzer wants it.
inline void expect(bool holds, char const* what) {
    if (holds) return;
    std::fprintf(stderr, "expected %s\n", what);
    std::abort();
}

/// The message of a refusal, which must be one line fit for a terminal and of bearable length.
inline std::string one_line(InputError const& error) {
    std::string const text = error.what();
    expect(!text.empty() && text.size() < 2000, "a message, not a page");
    for (std::string_view rest = text; !rest.empty(); rest.remove_prefix(printable_character(rest)))
        expect(printable_character(rest) > 0, "a printable line");
    return text;
}

/// The target: each file of tests/fuzz defines one.
void take(std::string_view bytes);

}  // namespace rlslab::fuzz

extern "C" int LLVMFuzzerTestOneInput(unsigned char const* data, std::size_t size) {
    rlslab::fuzz::take({reinterpret_cast<char const*>(data), size});
    return 0;
}
