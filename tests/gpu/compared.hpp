// A fleet on a GPU, or what stands for one, beside the library's filters, one by one: every word of every record.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rlslab::gpu {

struct Compared {
    long different = 0;        ///< filters with another bit, or another health or count
    long first = -1;           ///< of them
    long not_sound = 0;        ///< filters that are not: rows that overflow are among them
    std::uint64_t digest = 0;  ///< of the library's filters: all words and healths
};
/// The form's fleet of M filters, of d parameters in float or double, takes the rows of `seed`: a fifth one a launch,
/// then ten a launch. on_gpu false: the library's filters alone.
Compared compared(std::string_view form, bool is_double, int d, long M, long rows, bool prior = true,
                  bool on_gpu = true);
/// A filter to the CPU and back, and all through a file: nothing is lost. The names of what is.
std::vector<std::string> lost_on_the_way(std::string_view form, bool is_double, int d);
/// Nanoseconds a filter and row of so many filters and rows a launch, and the bytes that must move for them.
struct Timed {
    double ns, bytes;
};
Timed timed(std::string_view form, bool is_double, int d, long M, long rows, double seconds);

}  // namespace rlslab::gpu
