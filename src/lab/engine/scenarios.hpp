// The data of studies, the families of variants, and the errors of a filter.
#pragma once

#include <rlslab/studies/study.hpp>

#include <rlslab/reference/certified.hpp>

namespace rlslab::studies {

// --- families of variants --------------------------------------------------------------------------------------------
// Dense variants that take one row at a time, by what they store, in the order of the list: a new variant takes part in
// the studies of its family. Without `kalman`: its random walk aside it is `conventional`.

/// The variants that propagate P itself.
std::vector<Cell> covariance_forms();
/// The variants that propagate a factor of P or of its inverse.
std::vector<Cell> factor_forms();
/// The variants whose factor is a triangle; Potter's is full.
std::vector<Cell> triangular_forms();
/// The variants that correct theta by K e: all that propagate P or a factor of it, without `conventional`, whose
/// asymmetry has a study of its own.
std::vector<Cell> corrected_forms();
/// Covariance forms, factor forms, and `information`.
std::vector<Cell> row_forms();
/// Variants whose update of P uses a gain that a study can perturb: K in the first six, v or a running gain in others.
std::vector<Cell> gain_forms();
/// a, then b.
std::vector<Cell> joined(std::vector<Cell> a, std::vector<Cell> const& b);
/// The cells of a that are not in b.
std::vector<Cell> without(std::vector<Cell> a, std::vector<Cell> const& b);
/// The words, for Table::where.
std::vector<std::string> words(std::vector<Cell> const& cells);

/// base^first, base^(first + step), ... to base^last.
std::vector<Cell> powers(double base, double first, double last, double step = 1);
/// 1 ... n: replicates, which only change the seed.
std::vector<Cell> counted(int n);

// --- data ------------------------------------------------------------------------------------------------------------
// y = psi'theta + noise v, theta = (1, ..., 1), v nearly normal of variance 1 (Seed::bell).

/// Regressors of independent numbers of variance 1.
Records white(Index size, Index rows, Seed seed, double noise = 1e-3);
/// A tapped delay line of x_k = pole x_{k-1} + w_k past its transient, w of variance 1 - pole^2: x has variance 1.
Records delay_line(Index size, Index rows, double pole, Seed seed, double noise = 1e-3);
/// rows x size with singular values kappa^(-i/(size-1)) and random orthonormal factors: kappa_2 = kappa, but for the
/// rounding to double.
Records graded(Index size, Index rows, double kappa, Seed seed, double noise = 1e-10);

// --- answers ---------------------------------------------------------------------------------------------------------

/// Relative errors of theta in the 2-norm and of P in the Frobenius norm; infinity if the filter has one, or a NaN.
struct Errors {
    double theta, covariance;
};
Errors errors(AnyFilter const& filter, CertifiedSolution const& exact);
/// 10^-digits; infinity for NaN.
double error_of(double digits);

/// Feeds rows [first, last): in blocks if the variant takes blocks, otherwise one by one.
void process_rows(AnyFilter& filter, Records const& records, Index first, Index last);

/// P in the 257 bits of Reference: F itself, a product of factors, or an inverse.
Matrix<Reference> covariance_of(Stored<Reference> const& stored);
/// P and P^-1 in binary64 by the textbook recursion in order: a filter in a short word is compared with it.
struct InDouble {
    double lambda;
    Matrix<double> P, M;  ///< M = P^-1
    Vector<double> theta, f;

    explicit InDouble(Problem<double> const& problem);
    void take(Records const& records, Index k);
};
/// The largest eigenvalue of a symmetric A >= 0 by so many steps of the power method. Where they have not told it from
/// the next, the two differ by a few per cent, and the answer lies between them.
double largest_eigenvalue(Matrix<double> const& A, int steps);

/// ||A||_F.
double frobenius(Matrix<Reference> const& A);

}  // namespace rlslab::studies
