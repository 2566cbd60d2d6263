// What a comparison has to say of its record: the sentences of `identify`, before anything is said of variants.
#pragma once

#include "src/lab/compare/compare.hpp"

namespace rlslab::compare {

/// Where the records' rows stand in their file.
struct InFile {
    std::vector<Index> rows = {};         ///< of each row of the records: the file's row, from 0
    std::vector<long> lines = {};         ///< of each row of the file
    std::vector<double> resolution = {};  ///< of each regressor: the unit to which the file's numbers are rounded
    Index order = 0;                      ///< the longest lag, less the delay
};

/// A sentence for each of
///   (1) regressors that depend on one another but for the rounding of their numbers (doubts.hpp of the model)
///   (2) a row whose residual of least squares, with these weights and without a prior, is too large for a normal
///       distribution
///   (3) regressors whose mean is more than `much_offset` standard deviations off 0, beside a constant: they are nearly
///       parallel to it, and of their parameters about log10 of that number in digits is lost
/// None where theta is not determined. Costs as much as two solutions of the reference.
std::vector<std::string> doubts(Records const& records, CompareOptions const& options,
                                std::vector<std::string> const& regressors, InFile const& in_file);
inline constexpr double much_offset = 10;

}  // namespace rlslab::compare
