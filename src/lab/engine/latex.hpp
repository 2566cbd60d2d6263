// LaTeX for papers: a table of claims for each study, and a macro for each measurement.
#pragma once

#include <rlslab/studies/run.hpp>

namespace rlslab::studies {

/// Text as LaTeX shows it: its special characters escaped, Greek letters and signs as mathematics. Other characters
/// stay as they are.
std::string latex(std::string_view text);

/// A longtable (booktabs) of the study's claims: kind, claim, measurement, verdict.
std::string table_tex(Outcome const& outcome, RunOptions const& options);

/// \input{numbers}: \measured{STUDY}{N}{WORDS} is the measurement for the study's claim N (from 1),
/// \claimed{STUDY}{N}{WORDS} its text, \verdict{STUDY}{N}{WORDS} its verdict. WORDS are the first words of the claim,
/// for people and for a test; they are not typeset. \runcount{KIND}{hold|fail|undecided}, \runbudget, \runseed,
/// \runrevision and \runstudies describe the run.
std::string numbers_tex(std::vector<Outcome> const& outcomes, RunOptions const& options);

}  // namespace rlslab::studies
