// Runs studies: trials on all cores, with bits that do not depend on their number. A run that is killed can be continued.
#pragma once

#include <rlslab/catalogue/catalogue.hpp>
#include "report/progress.hpp"
#include "studies/engine/journal.hpp"
#include "studies/engine/study.hpp"

#include <filesystem>

namespace rlslab::studies {

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
    bool holds() const;                   ///< every claim
};

/// Runs the trials of the studies and writes out/NAME.csv for each (a header of provenance in lines with #, then the table in the order of
/// its factors). Finished trials are stored in out/.trials, and the same program uses them again for the same study, budget and seed.
/// Throws InputError when a file cannot be written, and what a trial throws, with its name.
std::vector<Outcome> run_studies(std::vector<Study const*> const& chosen, RunOptions const& options, report::Progress const& progress);

/// How many trials there are, how many fall to a part, and how many of these were finished already.
struct Share {
    size_t all = 0, own = 0, resumed = 0;
};
/// Runs the trials that fall to one part, into its journals in out/.trials, and writes nothing else. Parts may run at the same time, on
/// any machines that share the folder, or in folders that are merged later. What falls to a part depends on the chosen studies alone:
/// all trials are sorted by a hash of study and number and dealt in turn. So the parts differ by one trial at most, and trials that take
/// long are spread.
Share run_part(std::vector<Study const*> const& chosen, RunOptions const& options, Part part, report::Progress const& progress);

/// Takes the trials that the parts in these folders, and options.out, have finished into options.out, where run_studies then finds them.
/// Throws InputError, before anything is written, when a trial is missing, a folder's trials are of another program, budget or
/// seed, or another run is writing into options.out.
void merge_parts(std::vector<Study const*> const& chosen, RunOptions const& options, std::vector<std::filesystem::path> const& folders);

}  // namespace rlslab::studies
