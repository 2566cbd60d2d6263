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
/// Runs the trials of run.part, and says so; `or_merge` follows "the same command without --part". Writes `text` as
/// what the parts are of; throws InputError that the folder holds parts of `others` if another text stands there.
void run_one_part(std::vector<studies::Study const*> const& chosen, StudyRun const& run, std::string const& text,
                  char const* others, std::string const& or_merge);

/// Runs all unfinished trials. Writes tables, figures, report.html into run.options.out, whose lock the caller holds.
std::vector<studies::Outcome> run_whole(std::vector<studies::Study const*> const& chosen, StudyRun const& run);

}  // namespace rlslab::program
