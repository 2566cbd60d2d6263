// The table of the map of winners, read: runs, their losses, the boundary, and the statistics of claims.
#pragma once

#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>
#include "studies/maps/winner_run.hpp"

#include <optional>

namespace rlslab::studies {

/// In the order of the table.
std::vector<MapRun> runs_of(Table const& t);
/// For each cell the medians over its replicates. A form is broken that broke down in more than half of them.
std::vector<MapRun> medians_of(Table const& t);

// Each statistic is computed from the runs of one seed; those of cells from all.

/// The share of the runs for which it holds, of those for which it says anything.
Statistic of_runs(std::function<std::optional<bool>(MapRun const&)> holds);
/// The share of runs where the best form of the foretold family loses at most half a digit.
Statistic family_foretold(std::vector<std::string> const& forms, Laws laws = Laws::registered);
Statistic family_within(std::string family, std::vector<std::string> const& forms, double most);
/// The share of runs where the loss, both finite, is foretold so well.
Statistic loss_foretold(std::string form, double most, Laws laws = Laws::registered);
/// log10 of the condition from which on P stored loses half a digit to the plain factors, for each line of cells. Of
/// those lines where measurement or law have it inside the grid the share where both agree so well.
Statistic boundaries_foretold(double most, Laws laws = Laws::registered);
/// The share of cells, each with the medians of its runs, for which it holds.
Statistic of_cells(std::function<std::optional<bool>(MapRun const&)> holds);
/// The share of cells that lost so many digits.
Statistic cells_lost(std::string form, std::vector<std::string> const& forms, double least_loss);
Statistic largest_loss(std::string form, std::vector<std::string> const& forms);

}  // namespace rlslab::studies
