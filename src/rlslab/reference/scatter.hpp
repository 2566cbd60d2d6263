// How noise in the outputs scatters the minimiser: standard deviations, proven like the minimiser itself.
#pragma once

#include <rlslab/reference/certified.hpp>

#include <vector>

namespace rlslab {

/// For y_i = psi_i' theta + xi_i, xi white of variance sigma^2, weights w_i = lambda^(k-i), and P_k as in CertifiedSolution (M_k^-1 there):
///
///   (1) cov theta_k = sigma^2 P_k M_k P_k                    M_k = sum_i w_i^2 psi_i psi_i'
///   (2) J_k = sum_i w_i (y_i - psi_i' theta_k)^2             G_k = sum_i w_i psi_i psi_i'
///   (3) E J_k = sigma^2 freedom,     freedom = sum_i w_i - tr Q_k M_k              Q_k = 2 P_k - P_k G_k P_k
///   (4) student = freedom^2 / (sum_i w_i^2 - 2 tr Q_k C_k + tr Q_k M_k Q_k M_k)     C_k = sum_i w_i^3 psi_i psi_i'
///
/// lambda = 1 and no prior: cov theta = sigma^2 (Phi'Phi)^-1 and freedom = student = k - d. Otherwise J is not sigma^2 times a chi^2:
/// (4) are the degrees of freedom of the one that has J's mean and variance (Satterthwaite), for Student's quantiles. (3) leaves out what
/// a prior's bias adds to J.
/// Worked out in balls, then rounded to binary64. Source: Söderström & Stoica 1989, 4.2 (weighted least squares); Satterthwaite 1946.
struct Scatter {
    double J, freedom, student;
    Vector<double> sd;           ///< sqrt of the diagonal of P M P: times sigma, of theta
    Matrix<double> correlation;  ///< of theta's components, after the last step alone; NaN beside one that does not scatter
};

/// A minimiser and its scatter after step k.
struct Scattered {
    CertifiedSolution exact;
    Scatter scatter;
};

/// After each of these steps, as `certified` takes them. Every number of Scatter is within 2^-40 of its value (J, where it is below 2^-150
/// of sum w y^2, is 0; freedom to 2^-40 absolutely), or NaN: where `exact` is not certified, or 480 digits of it are not enough.
std::vector<Scattered> scattered(Problem<double> const& problem, Records const& data, std::vector<Index> const& steps);

}  // namespace rlslab
