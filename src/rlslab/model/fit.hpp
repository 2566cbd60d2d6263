// Batch least squares by three methods, and the statistics of the estimate.
#pragma once

#include <rlslab/core/records.hpp>

#include <string_view>

namespace rlslab {

/// theta_LS = argmin |Y - Phi theta|^2 and, for white xi, its statistics (N rows, d parameters, rank r):
///
///   residuals  eps = Y - Phi theta          J = eps'eps              sigma^2 = J / (N - r)
///   covariance sigma^2 (Phi'Phi)^-1         sd_i = sqrt of its diagonal
///   interval   theta_i +- t sd_i, t Student's quantile of N - r degrees of freedom
///   fit        100 (1 - |Y - Y^| / |Y - mean Y|) percent
struct Fit {
    Vector<double> theta, sd, residuals;
    Matrix<double> covariance;
    double J = 0, sigma2 = 0, percent = 0;
    Index rank = 0;
    Vector<double> singular = {};           ///< singular values of Phi, largest first (svd alone)
    Vector<double> lower = {}, upper = {};  ///< ends of the confidence intervals
    bool converged = true;  ///< false: svd's rotations were stopped before the columns were orthogonal to rounding
};

enum class FitBy { normal_equations, qr, svd };
constexpr std::string_view name_of(FitBy by) {
    constexpr std::string_view names[] = {"normal_equations", "qr", "svd"};
    return names[static_cast<int>(by)];
}

/// The fit of all rows.
///   normal_equations   Cholesky of the Gram matrix: squares the condition number; theta is NaN if it does not factor
///                      in binary64
///   qr                 Householder on blocks of rows; theta is NaN if R has a zero on its diagonal
///   svd                one-sided Jacobi on R. Directions with singular values below tolerance times the largest are
///                      dropped, and theta is the shortest of the minimisers. A negative tolerance stands for max(N, d)
///                      u, but at least 2^-440
/// `confidence` is that of the intervals. If Phi or Y, or (not for svd) a column of Phi, is multiplied by a power of
/// two, the results change by powers of two exactly; a result beyond binary64's exponents is infinite or 0. Throws
/// std::invalid_argument for fewer rows than parameters, and for a confidence outside (0, 1). Cost N d^2.
Fit fit(Records const& records, FitBy by = FitBy::qr, double confidence = 0.95, double tolerance = -1);

/// 100 (1 - |y - predicted| / |y - mean y|) percent; -infinity if y is constant and the prediction differs from it.
double fit_percent(Vector<double> const& y, Vector<double> const& predicted);

}  // namespace rlslab
