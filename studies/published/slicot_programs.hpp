// One of SLICOT's example programs by one form: each number that it prints, and the one computed here.
#pragma once

#include <rlslab/studies/study.hpp>

namespace rlslab::studies {

/// Thrown where a filter's numbers are not finite.
struct Broken {};

/// Writes "table, entry, printed, computed, units" for each printed number of the trial's program: units is the
/// distance in units of the last printed digit. Throws Broken, and std::invalid_argument for a P0 that a form does
/// not take.
void run_slicot_program(Trial const& trial, TrialOutput& out);

/// The names of the fast forms.
std::vector<Cell> fast_names();

}  // namespace rlslab::studies
