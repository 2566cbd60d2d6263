// The recursion itself: the variant over the fitted rows, and what its numbers are worth.
#pragma once

#include "identify/identify.hpp"

namespace rlslab {

/// The variant's entry in double. Throws InputError.
Entry const& entry_of(std::string const& variant);

/// What an estimate needs beyond what it says of itself.
struct Estimation {
    Vector<double> sd;           ///< of the certified minimiser
    Matrix<double> correlation;  ///< of its components
};

/// Fills in c, scales, trajectory, failure, sigma2, freedom, quantile, condition, digits, and warnings of arithmetic. The standard
/// deviations are those of the certified minimiser (scatter.hpp); the estimates are the variant's.
/// Throws InputError where lambda remembers too few rows.
Estimation estimate(Identified& out, Records const& records);

}  // namespace rlslab
