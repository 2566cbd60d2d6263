// What the claims came to: as lines, as JSON, counted, and against the record in the tree.
#pragma once

#include "studies/engine/run.hpp"

#include <array>
#include <map>
#include <span>

namespace rlslab::studies {

std::string_view name_of(Kind kind);        ///< "verification" ...
std::string_view name_of(Verdict verdict);  ///< "holds" ...

struct Count {
    size_t holds = 0, fails = 0, undecided = 0;
    size_t claims() const { return holds + fails + undecided; }
};
/// Apart by kind, in its order.
std::array<Count, 3> counted(std::span<Outcome const> outcomes);
/// "verified    60 of 60" and so on, a line for each kind.
std::string count_lines(std::span<Outcome const> outcomes);
/// How many of the verdicts are expected to be wrong: the sum of the risks, for claims whose number lies at the edge of its band.
double expected_errors(std::vector<Outcome> const& outcomes);

/// Its claims, those that fail first, then the undecided; each with its kind, its verdict and what was measured.
std::string verdict_lines(Outcome const& outcome, bool colour);
std::string verdicts_json(std::vector<Outcome> const& outcomes, RunOptions const& options);
/// A line for each study and kind: how many claims hold, fail, are undecided.
std::string verdicts_csv(std::vector<Outcome> const& outcomes);

/// Verdicts by study and by claim.
using Record = std::map<std::string, std::map<std::string, Verdict>>;
/// What studies/verdicts.json, or studies/verdicts-full.json, held when the program was built: verdicts of seed 1.
Record const& recorded(Budget budget);
/// The file's text: a study's claims in their order. Of studies that were not run, what `old` has of them.
std::string record_json(std::vector<Outcome> const& outcomes, Record const& old);
/// Throws InputError for a text that is no record.
Record record_from(std::string const& json);

/// "STUDY: claim: holds, fails in the record"; nothing of claims that the record does not have.
std::vector<std::string> changes(std::vector<Outcome> const& outcomes, Record const& record);
/// Claims that the record does not have, and recorded ones that these studies no longer make.
std::vector<std::string> unrecorded(std::vector<Outcome> const& outcomes, Record const& record);
/// Verifications that fail, as "STUDY: claim".
std::vector<std::string> failed_verifications(std::vector<Outcome> const& outcomes);

}  // namespace rlslab::studies
