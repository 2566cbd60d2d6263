// What a main() does: it prepares the process and runs a command line. Without CLI11, which takes long to parse.
#pragma once

#include <string>
#include <vector>

namespace rlslab::program {

/// From now on: a closed pipe ends the process silently, as with git, also if its parent ignores SIGPIPE; a file beyond
/// the limit is an error like any other; SIGINT, SIGTERM and SIGHUP leave no half-written file.
void prepare_process();

/// Runs the words of a command line (without the program's name, which is `name`). Returns the exit code. Any error is
/// one line on standard error and 2. Of processes with the same words, the one of rank 0 says what is wrong with them.
int run(std::vector<std::string> const& words, int rank = 0, std::string const& name = "rlslab");

/// The same for a program that compares and does nothing else; the first word is "compare".
int run_compare_alone(int argc, char const* const* argv);

}  // namespace rlslab::program
