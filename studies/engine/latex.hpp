// What papers take from a run: a table of claims for each study, and every measured text as a macro.
#pragma once

#include "studies/engine/run.hpp"

namespace rlslab::studies {

/// Text as LaTeX shows it: its special characters escaped, Greek letters and signs as mathematics. Other characters stay as they are.
std::string latex(std::string_view text);

/// A longtable (booktabs) of the study's claims: kind, claim, what was measured, verdict.
std::string table_tex(Outcome const& outcome, RunOptions const& options);

/// \input{numbers}: \measured{STUDY}{N}{WORDS} is what was measured for the study's claim N (from 1), \claimed{STUDY}{N}{WORDS} its text,
/// \verdict{STUDY}{N}{WORDS} its verdict. WORDS begin the claim's text, for people and for a test; they are not set.
/// \runcount{KIND}{hold|fail|undecided}, \runbudget, \runseed, \runrevision and \runstudies tell of the run.
std::string numbers_tex(std::vector<Outcome> const& outcomes, RunOptions const& options);

}  // namespace rlslab::studies
