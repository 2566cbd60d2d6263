// One run of the map of winners: the cell's rows, every form on them, the digits kept.
#pragma once

#include <rlslab/studies/study.hpp>
#include "studies/maps/winner_laws.hpp"

namespace rlslab::studies {

/// A word and a memory. lambda = 1: nothing is forgotten.
struct MapRegime {
    std::string_view name;
    int bits;
    double lambda;
    Index rows;
};
MapRegime const& map_regime(std::string_view name);
/// Their names: three and the longest memory, or all.
std::vector<Cell> map_regimes(bool all);

/// Those that take single rows, without `kalman`: 13, and with the delta forms 16.
std::vector<std::string> const& plain_forms();
std::vector<std::string> const& all_forms();

/// The cell that the factors' values name. Values in a table are found by their columns.
MapCell map_cell(std::function<Cell const&(std::string_view)> const& value);

/// theta_FORM, worst_FORM and P_FORM, digits kept: medians at 85, 90, 95 and 100 % of the rows. NaN: P was not definite
/// at one of the looks, at rows 1, 2, 4 ... and those.
std::vector<std::string> map_measures();
void measure_map(Trial const& trial, TrialOutput& out);

}  // namespace rlslab::studies
