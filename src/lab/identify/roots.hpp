// Poles, zeros and gains with their uncertainty.
#pragma once

#include "src/lab/identify/estimate.hpp"

namespace rlslab::identify {

/// Of g'theta for a complex gradient g.
Spread spread(Eigen::VectorXcd const& gradient, Uncertainty const& uncertainty);

/// Poles p and zeros z that the record cannot distinguish. To first order p and z move with theta,
///
///   (1) dp/da_i = -p^(na-i) / A'(p)        dz/db_i = -z^(nb-i) / B'(z)        A(z) = z^na + a_1 z^(na-1) + ...,
///       B likewise
///   (2) S = cov of (re, im) of p - z = g C g',   g its gradient,  C = cov theta
///   (3) q = (p - z)' S^-1 (p - z)  <=  chi^2's quantile at the confidence, 2 degrees of freedom for a complex pair, 1
///     for real ones
///
/// (3) is Wald's test of a common root. If it is not rejected, a model without the pair describes the record as well.
/// It is applied only where the first order holds: the errors of p and z are below half the distance to the next pole,
/// or zero. Each pole is paired with the zero of least q. With several inputs a pole cancels if it does for each.
/// Source: Söderström & Stoica 1989, 11.4 (pole-zero cancellation).
std::vector<Cancellation> cancellations(DifferenceEquation const& model, std::vector<Term> const& terms,
                                        Uncertainty const& uncertainty, double confidence);

/// The poles, and the zeros of an input, with the covariance of their parts to first order, (1) of cancellations.
/// first_order is false where that is not known to hold: the error is as large as half the distance to the next root,
/// or the leading coefficient may be 0.
std::vector<RootSpread> spreads_of_poles(DifferenceEquation const& model, std::vector<Term> const& terms,
                                         Uncertainty const& uncertainty);
std::vector<RootSpread> spreads_of_zeros(DifferenceEquation const& model, std::vector<Term> const& terms,
                                         Uncertainty const& uncertainty, size_t input);

/// Steady-state gain g = B(1)/A(1) of an input and its standard deviation, dg/db_i = 1/A(1), dg/da_i = -g/A(1). NaN
/// where A(1) lies within t standard deviations of 0: an integrator.
std::pair<double, double> gain_of(DifferenceEquation const& model, std::vector<Term> const& terms,
                                  Uncertainty const& uncertainty, size_t input, double t);

/// Of the normal distribution: Student's with very many degrees of freedom.
double normal_quantile(double p);

}  // namespace rlslab::identify
