// Runs studies: trials on all cores, with bits that do not depend on their number. A run that is killed can be continued.
#pragma once

#include "catalogue/catalogue.hpp"
#include "report/progress.hpp"
#include "studies/engine/study.hpp"

#include <filesystem>

namespace rlslab {

struct RunOptions {
    Budget budget = Budget::quick;
    std::uint64_t seed = 1;
    int threads = 0;            ///< 0: all cores
    std::filesystem::path out;  ///< where tables, verdicts, figures and the report go; created if missing
    std::vector<Entry> const* entries = &catalogue();
};

struct Outcome {
    Study const* study;
    Table table;
    std::vector<Finding> findings;        ///< one for each claim
    std::vector<std::string> provenance;  ///< "key: value", as above the CSV's header
    size_t trials, resumed;               ///< how many there are, and how many came from an interrupted run
    bool holds() const;
};

/// Runs the trials of the studies and writes out/NAME.csv for each (a header of provenance in lines with #, then the table in the order of
/// its factors). Finished trials are stored in out/.trials, and the same program uses them again for the same study, budget and seed.
/// Throws InputError when a file cannot be written, and what a trial throws, with its name.
std::vector<Outcome> run_studies(std::vector<Study const*> const& chosen, RunOptions const& options, Progress const& progress);

/// For each study its claims, each with its verdict and what was measured.
std::string verdict_lines(Outcome const& outcome, bool colour);
std::string verdicts_json(std::vector<Outcome> const& outcomes, RunOptions const& options);

}  // namespace rlslab
