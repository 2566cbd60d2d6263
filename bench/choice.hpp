// Which rows a user of the benchmarks asked for, by options of ours beside those of Google Benchmark.
#pragma once

#include <rlslab/core/problem.hpp>

#include <array>
#include <string>
#include <vector>

namespace rlslab::bench {

/// The sizes of the rows fixed/: all five where times are quoted from, compiled for one machine's instruction set.
/// Elsewhere one of registers alone and one of loops show that they compile.
#ifdef RLSLAB_BENCH_EVERY_SIZE
inline constexpr std::array fixed_sizes{2, 3, 4, 6, 8};
#else
inline constexpr std::array fixed_sizes{4, 8};
#endif

/// The parts of a row's name, or of a list.
std::vector<std::string> split(std::string const& text, char at);

/// Without an option of ours every row is there. With one, the rows are those of one filter at a time, at these sizes:
/// the variants in the arithmetics that are named, the peers, and the user's own class.
struct Choice {
    bool made = false;  ///< one of our options was given; single updates are timed, too
    std::vector<Index> sizes{2, 4, 8, 16, 24, 32, 64, 128, 256};
    bool in_double = false, in_float = false, fixed = false;
    bool mine = false;  ///< the user's own class was named
    std::string csv;    ///< a file; none where it is empty

    /// Whether the row is among them; its name is GROUP/NAME/ARITHMETIC/SIZE or shorter.
    bool has(std::string const& row) const;
};

/// That of this run of the program.
Choice& choice();

/// Takes our options out of argv:
///   --sizes LIST    parameters, whole numbers from 1 to 512 (4,16,64)
///   --double, --float  the variants' arithmetics (double)
///   --fixed         the variants whose size the compiler knows, in double, at --sizes among fixed_sizes (all of these)
///   --mine          nothing more than the choice: the class of one's own is compiled in
///   --csv FILE      the table as CSV, too
/// Throws std::runtime_error, with a line for people, for a value that cannot be used.
void take_choice(int& argc, char** argv);

/// Runs the rows with our options and Google Benchmark's; argv[0] is the program. Returns 0, or 2: an unknown option.
int run_rows(int argc, char** argv);

}  // namespace rlslab::bench
