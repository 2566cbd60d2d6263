// The recursion itself: the variant processes the fitted rows, and its numbers are compared with the certified ones.
#pragma once

#include "identify/identify.hpp"

namespace rlslab::identify {

/// The variant's entry in double. Throws InputError.
CatalogueEntry const& entry_of(std::string const& variant);

/// Statistics of an estimate that the variant does not report.
struct Estimation {
    Vector<double> sd;           ///< of the certified minimiser
    Matrix<double> correlation;  ///< of its components
};

/// Fills in c, scales, trajectory, failure, sigma2, freedom, quantile, condition, digits, and warnings of arithmetic. The standard
/// deviations are those of the certified minimiser (scatter.hpp); the estimates are the variant's.
/// resolution (d): the numbers of each regressor are rounded to about this. Throws InputError where lambda remembers too few rows.
Estimation estimate(Identified& out, Records const& records, Vector<double> const& resolution);

}  // namespace rlslab::identify
