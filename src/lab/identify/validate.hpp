// The fitted model against the whole record: its errors, the part of the output that it does not explain, and whether
// one theta holds for all rows: the sums of the recursive residuals and of their squares.
#pragma once

#include "src/lab/identify/estimate.hpp"
#include "src/lab/identify/record.hpp"
#include "src/lab/identify/structure.hpp"

namespace rlslab::identify {

/// rows: all of the record, in the order of the structure's terms; fitted: the first rows, which the estimate is from.
/// If theta is not finite, only `bound` is set.
Validation validate(Record const& record, IdentifyOptions const& options, Structure const& structure, Rows const& rows,
                    Index fitted, Estimation const& estimation);

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

}  // namespace rlslab::identify
