// The main of a program of somebody's own studies.
#pragma once

#include <rlslab/studies/study.hpp>

namespace rlslab {

/// Runs these studies as rlslab runs its own: `study`, `merge` and `list` with the options, files and exit codes of
/// `rlslab study`, `rlslab merge` and `rlslab list`. Messages, tables and the report name the program by the file name
/// of argv[0]. No verdict is recorded: `--record FILE` writes a record, `--against FILE` compares with it. Returns the
/// exit code; every error is one line on standard error and 2. To be called once, from main. Throws
/// std::invalid_argument if there is no study, or if a name is used twice or has other characters than A-Z, a-z, 0-9,
/// _ and -.
int study_main(int argc, char const* const* argv, std::vector<studies::Study> const& studies);

}  // namespace rlslab
