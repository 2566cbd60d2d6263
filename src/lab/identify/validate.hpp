// The fitted model against the whole record: its errors, the part of the output that it does not explain, and whether
// one theta holds for all rows. What it does, with intervals: poles, zeros, gains, modes and responses.
#pragma once

#include "src/lab/identify/estimate.hpp"

namespace rlslab::identify {

/// rows: all of the record, in the order of the structure's terms; fitted: the first rows, which the estimate is from.
/// If theta is not finite, only `bound` is set.
Validation validate(Record const& record, IdentifyOptions const& options, Structure const& structure, Rows const& rows,
                    Index fitted, Estimation const& estimation);

/// Where a number is largest in size, from the first one on.
Index largest_at(Signal const& r, Index first = 0);
/// Percent of y that is predicted, over the samples begin ... end - 1 whose y is no NaN; NaN if none is.
double fit_of(Signal const& y, Signal const& predicted, Index begin, Index end);

/// Recursive least squares without forgetting and without a prior (variant qr) over the rows. The m rows that count are
/// those from the first on before which theta is determined, as the variant's health says it; a row that adds a
/// direction to rows that depend on one another but for rounding has w = 0 but for rounding. With e_k and gamma_k of
/// its Steps:
///
///   (1) w_k = e_k sqrt(gamma_k) = e_k / sqrt(f_k),   f_k = 1 + psi_k' P_{k-1} psi_k       sum w^2 = J = S_m
///   (2) W_r = (w_1 + ... + w_r) / sigma,   sigma^2 = S_m / m       lines +- a sqrt(m) (1 + 2 r/m),  a = 0.948 at 5 %
///   (3) s_r = (w_1^2 + ... + w_r^2) / S_m                          lines r/m +- c0
///
/// With one theta throughout and normal noise w is white, W stays between its lines with probability 0.95 or so, and s
/// likewise. (2) sees a change of theta, (3) one of theta or of the noise, and an outlier. With past outputs among the
/// regressors this holds for many rows. `rounding`: the largest J that is rounding alone, at which there is no verdict.
/// Empty for less than 4 residuals, or if they are not finite. Cost N d^2.
/// Source: Brown, Durbin & Evans 1975; Krämer, Ploberger & Alt 1988 (past outputs among the regressors).
Constancy constancy(Records const& rows, std::vector<Index> const& samples, double rounding);

/// c0 of (3) for m residuals: s_r exceeds r/m by c0 somewhere with this probability, about; below r/m - c0 likewise. At
/// every second r the s_r are the order statistics of n = m/2 - 1 uniform numbers (m even), so that c0 is the point of
/// Durbin's C+ = max_j (j/(n+1) - U_(j)). Its tail, for alpha = (n+1) c, t_j = (j - alpha)/(n+1):
///
///   (1) P(C+ > c) = sum_{j >= alpha} n over j  t_j^j (1 - t_j)^(n-j) (1 + alpha) / (1 + alpha + n - j)
///
/// For n < 60 c0 solves (1); for odd m it is between those of its neighbours. Beyond it is Edgerton and Wells' a_1
/// n^(-1/2) + a_2 n^-1 + a_3 n^(-3/2), which differs from (1) by less than 1e-4. tail: 0.025 or 0.005; otherwise, and
/// for m < 4, std::invalid_argument.
/// Source: (1) derived, from the ballot theorem at the last crossing; Durbin 1969; Edgerton & Wells 1994.
double squares_line(Index m, double tail);
/// (1) of squares_line.
double tail_of_largest_excess(Index n, double c);

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

/// The mode of each pole with imag >= 0.
std::vector<Mode> modes_of(std::vector<RootSpread> const& poles);

/// Where responses are drawn: samples until the slowest pole has fallen to 1 %, or grown a hundredfold, 20 to 1000;
/// frequencies in cycles per sample from a twentieth of the slowest pole's corner to 1/2, evenly in their logarithm,
/// and the angles of poles and zeros.
Index response_length(std::vector<std::complex<double>> const& poles, std::vector<Term> const& terms);
std::vector<double> response_frequencies(std::vector<std::complex<double>> const& poles,
                                         std::vector<std::vector<std::complex<double>>> const& zeros);

/// Intervals by the delta method: with x's gradient g by theta (response.hpp) and C = cov theta, t the quantile,
///
///   (1) step        var g_k = g' C g                     g_k +- t sd
///   (2) magnitude   d|G| = Re(conj(G) dG) / |G|          20 log10(|G| +- t sd)
///   (3) phase       d arg G = Im(conj(G) dG) / |G|^2     arg G +- t sd
///
/// Where 0 is within t standard deviations of G, the phase has no interval, and the magnitude no lower end. Each
/// interval is for itself, not for the whole curve. Cost n d^2.
InputResponse response_of(DifferenceEquation const& model, std::vector<Term> const& terms, Vector<double> const& theta,
                          Uncertainty const& uncertainty, size_t input, double quantile, Index length,
                          std::vector<double> const& frequencies);

/// The ellipse about a complex root that covers it with this probability, as (re, im) of points; of a real root the two
/// ends of its interval. q = (x - p)' S^-1 (x - p) is 2 F with (2, nu) degrees of freedom: nu ((1 - confidence)^(-2/nu)
/// - 1) at its quantile. Empty where the first order does not hold. Source: derived (F's tail with 2 degrees of freedom
/// is a power).
std::vector<std::complex<double>> region_of(RootSpread const& root, double confidence, double quantile, double freedom);

}  // namespace rlslab::identify
