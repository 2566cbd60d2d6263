// The verdicts on claims: as lines, as JSON, as LaTeX, counted, and compared with the record in the tree.
#pragma once

#include <rlslab/studies/run.hpp>

#include <array>
#include <map>
#include <span>

namespace rlslab::studies {

std::string_view name_of(Kind kind);        ///< "verification" ...
std::string_view name_of(Verdict verdict);  ///< "holds" ...
/// The claim's own, or the study's.
std::string const& data_of(Study const& study, Claim const& claim);

struct Count {
    size_t holds = 0, fails = 0, undecided = 0;
    size_t claims() const { return holds + fails + undecided; }
};
/// One count for each kind, in the order of Kind.
std::array<Count, 3> counted(std::span<Outcome const> outcomes);
/// "verified    60 of 60" and so on, a line for each kind.
std::string count_lines(std::span<Outcome const> outcomes);
/// The expected number of wrong verdicts if every statistic lies at the edge of its band: the sum of the risks.
double expected_errors(std::vector<Outcome> const& outcomes);

/// The claims that fail, then the undecided, then the others; each with its kind, its verdict and the measurement.
std::string verdict_lines(Outcome const& outcome, bool colour, size_t width = std::string::npos);
std::string verdicts_json(std::vector<Outcome> const& outcomes, RunOptions const& options);
/// A line for each study and kind: how many claims hold, fail, are undecided.
std::string verdicts_csv(std::vector<Outcome> const& outcomes);

/// Verdicts by study and by claim.
using Record = std::map<std::string, std::map<std::string, Verdict>>;
/// The verdicts of seed 1 in studies/verdicts.json or studies/verdicts-full.json when the program was built.
Record const& recorded(Budget budget);
/// The text of the record: the claims of each study in their order; of one that was not run those in `old`.
std::string record_json(std::vector<Outcome> const& outcomes, Record const& old);
/// Throws InputError for a text that is no record.
Record record_from(std::string const& json);

/// "STUDY: claim: holds, fails in the record" for each verdict that changed. Claims outside the record are left out.
std::vector<std::string> changes(std::vector<Outcome> const& outcomes, Record const& record);
/// Claims that are not in the record, and claims in the record that these studies no longer make.
std::vector<std::string> unrecorded(std::vector<Outcome> const& outcomes, Record const& record);
/// Verifications that fail, as "STUDY: claim".
std::vector<std::string> failed_verifications(std::vector<Outcome> const& outcomes);

// --- LaTeX for papers: a table of claims for each study, and a macro for each measurement ----------------------------

/// Text for LaTeX: its special characters escaped, Greek letters and signs as mathematics; others stay as they are.
std::string latex(std::string_view text);

/// A longtable (booktabs) of the study's claims: kind, claim, measurement, verdict.
std::string table_tex(Outcome const& outcome, RunOptions const& options);

/// \input{numbers}: \measured{STUDY}{N}{WORDS} is the measurement for the study's claim N (from 1),
/// \claimed{STUDY}{N}{WORDS} its text, \verdict{STUDY}{N}{WORDS} its verdict. WORDS are the first words of the claim,
/// for people and for a test; they are not typeset. \runcount{KIND}{hold|fail|undecided}, \runbudget, \runseed,
/// \runrevision and \runstudies describe the run.
std::string numbers_tex(std::vector<Outcome> const& outcomes, RunOptions const& options);

}  // namespace rlslab::studies
