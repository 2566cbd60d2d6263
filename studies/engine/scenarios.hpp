// The data of studies, the families of variants, and the errors of a filter.
#pragma once

#include "studies/engine/study.hpp"

#include <rlslab/reference/certified.hpp>

namespace rlslab {

// --- variants, as factors of a study ----------------------------------------------------------------------------------

/// The variants that propagate P itself.
std::vector<Cell> covariance_forms();
/// The variants that propagate a factor of P or of its inverse and take one row at a time.
std::vector<Cell> factor_forms();
/// Both of these and `information`: every dense variant that takes one row at a time.
std::vector<Cell> row_forms();
/// a, then b.
std::vector<Cell> joined(std::vector<Cell> a, std::vector<Cell> const& b);

/// base^first, base^(first + step), ... to base^last.
std::vector<Cell> powers(double base, double first, double last, double step = 1);
/// 1 ... n: replicates, which only change the seed.
std::vector<Cell> counted(int n);

// --- data -------------------------------------------------------------------------------------------------------------
// y = psi'theta + noise v, theta = (1, ..., 1), v nearly normal of variance 1 (Seed::bell).

/// Regressors of independent numbers of variance 1.
Records white(Index size, Index rows, Seed seed, double noise = 1e-3);
/// A tapped delay line of x_k = pole x_{k-1} + w_k, w of variance 1 - pole^2, so that x has variance 1; past its transient.
Records delay_line(Index size, Index rows, double pole, Seed seed, double noise = 1e-3);
/// rows x size with singular values kappa^(-i/(size-1)) and random orthonormal factors: kappa_2 = kappa, but for the rounding to double.
Records graded(Index size, Index rows, double kappa, Seed seed, double noise = 1e-10);

// --- answers ----------------------------------------------------------------------------------------------------------

/// The problem and the data as an arithmetic stores them. The reference for that arithmetic must be computed from the same numbers.
Problem<double> as_stored(Problem<double> problem, Arithmetic const& arithmetic);
Records as_stored(Records records, Arithmetic const& arithmetic);

/// Relative errors of theta in the 2-norm and of P in the Frobenius norm; infinity if the filter has an infinity or a NaN.
struct Errors {
    double theta, covariance;
};
Errors errors(AnyFilter const& filter, CertifiedSolution const& exact);

/// Feeds rows [first, last) one by one, or in blocks to a filter that likes them better.
void feed_rows(AnyFilter& filter, Records const& records, Index first, Index last);

/// P in the 257 bits of Reference, from F itself, by multiplying factors out, or by inversion.
Matrix<Reference> covariance_of(Stored<Reference> const& stored);
/// ||A||_F.
double frobenius(Matrix<Reference> const& A);

}  // namespace rlslab
