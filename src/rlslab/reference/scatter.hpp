// The standard deviations of the minimiser under noise in the outputs, proven as the minimiser itself is.
#pragma once

#include <rlslab/reference/certified.hpp>

#include <vector>

namespace rlslab {

/// For y_i = psi_i' theta + xi_i, xi white of variance sigma^2, weights w_i = lambda^(k-i), and P_k as in
/// CertifiedSolution (M_k^-1 there):
///
///   (1) cov theta_k = sigma^2 P_k M_k P_k                    M_k = sum_i w_i^2 psi_i psi_i'
///   (2) J_k = sum_i w_i (y_i - psi_i' theta_k)^2             G_k = sum_i w_i psi_i psi_i'
///   (3) E J_k = sigma^2 freedom,     freedom = sum_i w_i - tr Q_k M_k              Q_k = 2 P_k - P_k G_k P_k
///   (4) student = freedom^2 / (sum_i w_i^2 - 2 tr Q_k C_k + tr Q_k M_k Q_k M_k)     C_k = sum_i w_i^3 psi_i psi_i'
///
/// For lambda = 1 without a prior, cov theta = sigma^2 (Phi'Phi)^-1 and freedom = student = k - d. Otherwise J /
/// sigma^2 does not have a chi-squared distribution: (4) is the number of degrees of freedom of the multiple of
/// chi-squared with J's mean and variance (Satterthwaite), for Student's quantiles. (3) does not contain the part of J
/// that comes from a prior's bias. Computed in balls, then rounded to binary64. Source: Söderström & Stoica 1989, 4.2
/// (weighted least squares); Satterthwaite 1946.
struct Scatter {
    double J, freedom, student;
    Vector<double> sd;  ///< d: sqrt of the diagonal of P M P; times sigma, the standard deviations of theta
    Matrix<double>
        correlation;  ///< d x d: of theta's components, for the last step only; NaN for a component with sd 0
};

/// A minimiser and its scatter after step k.
struct Scattered {
    CertifiedSolution exact;
    Scatter scatter;
};

/// The minimisers and their scatter after each of these steps; arguments and exceptions are those of `certified`. Every
/// number of Scatter has a relative error below 2^-40, with two exceptions: J is 0 if it is below 2^-150 of sum w y^2,
/// and freedom has that error absolutely. A number is NaN if `exact` is not certified, or if 480 digits of it are not
/// enough.
std::vector<Scattered> scattered(Problem<double> const& problem, Records const& data, std::vector<Index> const& steps);

}  // namespace rlslab
