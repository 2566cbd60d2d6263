// Correlations, and the order of persistent excitation: how many parameters an input can identify.
#pragma once

#include <rlslab/model/signals.hpp>

#include <functional>

namespace rlslab {

/// R_xy(tau) = (1/N) sum over k = tau ... N-1 of x_k y_{k-tau}, for tau = 0 ... most, summed in order of k. Throws std::invalid_argument
/// unless x and y are equally long and 0 <= most < N.
Signal correlation(Signal const& x, Signal const& y, Index most);

/// The n x n matrix (1/(N-n+1)) sum of v_k v_k', v_k = [x_k ... x_{k-n+1}]: R_x, positive definite if and only if x is
/// exciting of order n over the record.
Matrix<double> correlation_matrix(Signal const& x, Index n);

/// Whether the sum of |R_ij|, j != i, is below R_ii in every row i: sufficient for positive definiteness, not necessary.
bool diagonally_dominant(Matrix<double> const& R);

/// The results for one order n.
struct ExcitationOrder {
    Index order;
    bool definite;     ///< the sign of the least eigenvalue of sum v_k v_k', decided exactly for the stored numbers
    double condition;  ///< kappa_2 of the matrix of the v_k, to about 12 digits; infinity when singular
    double least;      ///< the least eigenvalue of R_x, (largest eigenvalue) / condition^2
    bool resolved;     ///< least is above the eigenvalue that rounding to the record's resolution causes by itself
};

struct Excitation {
    Index order = 0;                      ///< the largest n up to which all are definite and resolved
    Index exact_order = 0;                ///< the largest n up to which all are definite
    double resolution = 0;                ///< q: all numbers of the record are multiples of it, as far as binary64 can tell
    Index constant_at_start = 0;          ///< samples at the start over which the input does not change
    std::vector<ExcitationOrder> orders;  ///< n = 1 ... most, or up to the first that is singular
};

/// Tests the orders 1 ... most. u is exciting of order n if R_u (n x n) is positive definite; a model of order m with input terms
/// u_k ... u_{k-m} needs n = m + 1. The numbers of a record are rounded to a resolution q, which by itself adds about q^2/12 to every
/// eigenvalue: a least eigenvalue below 4 q^2/12 says nothing about the input. Throws std::invalid_argument for an empty record. Time grows
/// as most^4 + most^3 N; `progress`, if given, is called with the fraction that is done.
/// Source: Söderström & Stoica 1989, 5.4; docs/theory.md 4.
Excitation excitation(Signal const& u, Index most, std::function<void(double)> const& progress = {});

}  // namespace rlslab
