// The options that every run of trials has, and such a run: whole, or a part of it.
#pragma once

#include "src/lab/program/commands.hpp"
#include <rlslab/studies/run.hpp>

namespace rlslab::program {

struct StudyRun {
    bool fresh = false;
    std::string out = "out", figures = "svg";
    studies::Part part;
    studies::RunOptions options;
};
/// --seed, --threads, --out, --fresh, --figures, --part. `run` outlives the command's run. `or_merge` follows "into one
/// folder that all see".
void define_run(CLI::App& command, StudyRun& run, char const* seed_help, char const* or_merge);

/// Throws InputError where another option does not go with --part.
void check_part(StudyRun const& run);
/// What the parts in a folder are of, DIR/.trials/run.json; "" if it holds none. Throws InputError for what is no file
/// of its size.
std::string noted_run(std::string const& folder);
/// Throws an InputError where the folder holds this file of another command.
void expect_no_other_run(std::string const& folder, char const* file, char const* command);
/// Writes that. Throws InputError that the folder holds parts of `others` if another text stands there.
void note_run(StudyRun const& run, std::string const& text, char const* others);
/// Runs the trials of run.part; the caller holds the folder's lock.
studies::Share run_share(std::vector<studies::Study const*> const& chosen, StudyRun const& run);
/// "part 1 of 4: 12 of 50 trials ..."; `or_merge` follows "the same command without --part".
std::string part_text(StudyRun const& run, studies::Share const& share, char const* or_merge);

/// Runs all unfinished trials. Writes tables, figures, report.html into run.options.out, whose lock the caller holds.
std::vector<studies::Outcome> run_whole(std::vector<studies::Study const*> const& chosen, StudyRun const& run);

}  // namespace rlslab::program
