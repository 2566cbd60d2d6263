// The variant's estimate and its uncertainty.
#pragma once

#include "src/lab/identify/identify.hpp"

namespace rlslab::identify {

/// The variant's entry in double. Throws InputError.
CatalogueEntry const& entry_of(std::string const& variant);

/// Statistics of an estimate that the variant does not report.
struct Uncertainty {
    Vector<double> sd;           ///< of the certified minimiser
    Matrix<double> correlation;  ///< of its components
};

struct Estimation {
    Estimate estimate;
    Uncertainty uncertainty;
    std::vector<Remark> remarks;  ///< about dependence, breakdown and rounding
};
/// The variant's estimate from the fitted rows. The standard deviations are those of the certified minimiser
/// (scatter.hpp). resolution (d): the unit to which each regressor's numbers are rounded. Throws InputError for
/// linearly dependent regressors, naming `file` and the structure, and for a lambda that remembers too few rows.
Estimation estimate(std::string const& file, IdentifyOptions const& options, Structure const& structure,
                    Records const& records, Vector<double> const& resolution);

}  // namespace rlslab::identify
