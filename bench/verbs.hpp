// The verbs of rlslab_bench that are files of their own.
#pragma once

#include "bench/measured.hpp"

namespace rlslab::bench {

/// The options of ours in run_rows, a line each.
extern char const* const run_options;

/// Runs the rows with our options and those of Google Benchmark; argv[0] is the program. Returns 0, or 2 for an option
/// that it does not know.
int run_rows(int argc, char** argv);

std::string page_of(Run const& run);

/// argv: the program, "ranks", and up to four numbers: ranks, parameters, rows, rows of a group. Outside of an MPI job
/// it starts mpirun with the same words. Throws std::runtime_error for other words and where mpirun does not start.
int run_ranks(char** argv);

}  // namespace rlslab::bench
