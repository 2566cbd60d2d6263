// The map of winners. One run: the cell's rows, every form on them, the digits kept. The table read: runs, their
// losses, the boundary, and the statistics of claims.
#pragma once

#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>
#include "studies/maps/winner_laws.hpp"

#include <array>
#include <optional>

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
/// at one of the looks, at rows 1, 2, 4 ... and those. Then `within` and `foretold`, letters of families whose best
/// form loses at most half a digit to the best plain form: S, P stored, and F, a plain factor, or both; J, joseph, and
/// I, information, where neither does.
std::vector<std::string> map_measures();
void measure_map(Trial const& trial, TrialOutput& out);

/// Of theta, its worst component, P. NaN: broken down.
using MapDigits = std::array<double, 3>;

/// One run, or the median of the runs of a cell: digits of each form.
struct MapRun {
    MapCell at;
    std::string line = {};  ///< the cell's name without its condition
    double exponent = 0;    ///< of the condition
    std::vector<MapDigits> kept = {};

    MapDigits const& of(std::string_view form) const;
    MapDigits law(std::string_view form, Laws laws = Laws::registered) const;
    /// The same with the digits of the laws.
    MapRun foretold() const;
    /// The largest loss of the form to the best of these; infinity if it broke down.
    double loss(std::string_view form, std::vector<std::string> const& forms) const;
    /// The least loss of a family's forms.
    double loss_of_family(std::string_view family, std::vector<std::string> const& forms) const;
    /// The family of the form that loses least.
    std::string_view winner(std::vector<std::string> const& forms) const;
    std::string letters() const;
};
bool is_broken(MapDigits const& digits);

/// In the order of the table.
std::vector<MapRun> runs_of(Table const& t);
/// For each cell the medians over its replicates. A form is broken that broke down in more than half of them.
std::vector<MapRun> medians_of(Table const& t);

// Each statistic is computed from the runs of one seed; those of cells from all.

/// The share of the runs for which it holds, of those for which it says anything.
Statistic of_runs(std::function<std::optional<bool>(MapRun const&)> holds);
/// The share of runs where the best form of the foretold family loses at most half a digit.
Statistic family_foretold(std::vector<std::string> const& forms);
Statistic family_within(std::string family, std::vector<std::string> const& forms, double most);
/// The share of runs where the loss, both finite, is foretold so well.
Statistic loss_foretold(std::string form, double most);
/// log10 of the condition from which on P stored loses half a digit to the plain factors, for each line of cells. Of
/// those lines where measurement or law have it inside the grid the share where both agree so well.
Statistic boundaries_foretold(double most);
/// The share of cells, each with the medians of its runs, for which it holds.
Statistic of_cells(std::function<std::optional<bool>(MapRun const&)> holds);
/// The share of cells that lost so many digits.
Statistic cells_lost(std::string form, std::vector<std::string> const& forms, double least_loss);
Statistic largest_loss(std::string form, std::vector<std::string> const& forms);

}  // namespace rlslab::studies
