// What makes a record's least squares doubtful, as places and as sentences: the same from every command.
#pragma once

#include <rlslab/core/records.hpp>
#include <rlslab/reference/scatter.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rlslab {

/// A residual that is too large for a normal distribution.
struct Outlier {
    Index row;  ///< of the record, from 1
    long line;  ///< of the file
    bool held_out;
    double deviations, share;  ///< in root mean squares of its part's residuals; of their sum of squares
    bool dominates() const { return share > 0.1; }  ///< the other rows hardly count
};
/// "row 4 (line 5)"; "row 4" where both numbers are the same.
std::string row_text(Outlier const& outlier);
/// What to think of it. guarded: a guard runs, which leaves such rows out as they come.
std::string sentence_on(Outlier const& outlier, bool guarded);

/// The regressors that depend on one another but for the rounding of their numbers. G = (Phi'Phi)^-1. The part of
/// regressor i that the others do not explain, x_i + sum_j w_j x_j with w_j = G_ij / G_ii, has the mean square 1 / (N
/// G_ii). Numbers rounded to q_j cause sum_j w_j^2 q_j^2 / 12 by themselves. If the mean square is below four times
/// that, the regressors depend on one another but for rounding. Tests the regressor with the smallest such part,
/// relative to its scale; none: empty. free: of the minimiser without prior; resolution: q (resolution_of).
std::vector<Index> dependent_but_for_rounding(Records const& records, Scatter const& free,
                                              Vector<double> const& resolution);
/// "u[k], v[k]"; "9 of the 12 regressors".
std::string names_of(std::vector<Index> const& places, std::vector<std::string> const& regressors);
/// instead: what to do.
std::string sentence_on_dependence(std::string const& names, std::string const& instead);

}  // namespace rlslab
