// The data of studies, the families of variants, and what a filter has got wrong.
#pragma once

#include "studies/engine/study.hpp"

#include <rlslab/reference/certified.hpp>

namespace rlslab {

// --- variants, as factors of a study ----------------------------------------------------------------------------------

/// Propagate P itself.
std::vector<Cell> covariance_forms();
/// Propagate a factor of P or of its inverse; one row at a time.
std::vector<Cell> factor_forms();
/// Both, and `information`: every dense variant that takes one row at a time.
std::vector<Cell> row_forms();
/// Whose update of P uses a vector as the gain, and lets it be changed: K in the first six, v or a running gain in the others.
std::vector<Cell> gain_forms();
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

/// The problem and the data as an arithmetic stores them: what its reference must be given too.
Problem<double> as_stored(Problem<double> problem, Arithmetic const& arithmetic);
Records as_stored(Records records, Arithmetic const& arithmetic);

/// Relative errors in the 2-norm and the Frobenius norm: 10^-digits. Infinity where the filter has an infinity or a NaN.
struct Errors {
    double theta, covariance;
};
Errors errors(AnyFilter const& filter, CertifiedSolution const& exact);

/// Feeds rows [first, last) one by one, or in blocks to a filter that likes them better.
void feed_rows(AnyFilter& filter, Records const& records, Index first, Index last);

/// P in the 257 bits of Reference: F itself, multiplied out, or inverted.
Matrix<Reference> covariance_of(Stored<Reference> const& stored);
/// ||A||_F.
double frobenius(Matrix<Reference> const& A);

}  // namespace rlslab
