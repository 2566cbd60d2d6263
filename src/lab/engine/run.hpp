// Runs studies: trials on all cores, whose number no result depends on. A run that is killed can be continued.
#pragma once

#include <rlslab/catalogue/catalogue.hpp>
#include "src/lab/report/messages.hpp"
#include "src/lab/report/provenance.hpp"
#include <rlslab/studies/journal.hpp>
#include <rlslab/studies/study.hpp>

#include <filesystem>
#include <optional>

namespace rlslab::studies {

/// Other values for a factor, as words of a command line.
struct FactorValues {
    std::string name;
    std::vector<std::string> values;
    friend bool operator==(FactorValues const&, FactorValues const&) = default;
};

struct RunOptions {
    Budget budget = Budget::quick;
    std::uint64_t seed = 1;
    int threads = 0;                 ///< 0: all cores
    std::string program = "rlslab";  ///< that runs: commands begin with it; another is the heading of its report
    std::filesystem::path out;       ///< the folder of tables, verdicts, figures and the report; created if missing
    std::vector<CatalogueEntry> const* entries = &catalogue();
    std::vector<FactorValues> set = {};          ///< other values for some factors; claims are then not judged
    int seeds = 0;                               ///< other than 0: so many replicates, likewise
    std::optional<report::Provenance> run = {};  ///< of a study that is made at run time; absent: `rlslab study NAME`
    bool changed() const { return !set.empty() || seeds > 0; }
};

struct Outcome {
    Study const* study;
    Table table;
    std::vector<Judgement> judgements;      ///< one for each claim; none if options.changed()
    std::vector<std::string> provenance;    ///< "key: value", the lines above the CSV's header
    size_t trials, resumed;                 ///< all trials, and the trials that an interrupted run had finished
    std::string changed = {};               ///< "kappa = 1e2, 1e4": what differs from the study's own factors
    std::vector<std::string> numbers = {};  ///< of changed factors: what each claim would have been judged by
    bool holds() const;                     ///< every claim
};

/// Every combination of the factors' values that the study admits, the last factor fastest. Throws InputError if it
/// admits none. `factors` outlives the trials.
std::vector<Trial> trials_of(Study const& study, std::vector<Factor> const& factors, RunOptions const& options);

/// Runs the trials of the studies and writes out/NAME.csv for each (a header of provenance in lines with #, then the
/// table in the order of its factors). Finished trials are stored in out/.trials, and the same program uses them again
/// for the same study, budget and seed. Throws InputError if a file cannot be written. An exception of a trial is
/// thrown again with the trial's name.
std::vector<Outcome> run_studies(std::vector<Study const*> const& chosen, RunOptions const& options,
                                 report::Progress const& progress);

/// What the files of a run of studies say about it. No word of it depends on the machine, the number of threads or the
/// parts: neither do their bytes.
report::Provenance run_of(std::vector<Outcome> const& outcomes, RunOptions const& options);

/// The numbers of all trials, of a part's own, and of those among its own that were finished already.
struct Share {
    size_t all = 0, own = 0, resumed = 0;
};
/// Runs the trials of one part and writes its journals in out/.trials, nothing else. Parts may run at the same time, on
/// any machines that share the folder, or in folders that are merged later. The part of a trial depends on the chosen
/// studies alone: all trials are sorted by a hash of study and number, and dealt in turn. So the parts differ by one
/// trial at most, and long trials spread over the parts.
Share run_part(std::vector<Study const*> const& chosen, RunOptions const& options, Part part,
               report::Progress const& progress);

/// Copies the finished trials of the parts in these folders and in options.out into options.out, where run_studies then
/// finds them. Throws InputError before it writes anything if a trial is missing, if a folder's trials have another
/// program, budget or seed, or if another run is writing into options.out.
void merge_parts(std::vector<Study const*> const& chosen, RunOptions const& options,
                 std::vector<std::filesystem::path> const& folders);

}  // namespace rlslab::studies
