// Correlations, and the order of persistent excitation: how many parameters an input can identify.
#pragma once

#include <rlslab/model/signals.hpp>

#include <functional>

namespace rlslab {

/// R_xy(tau) = (1/N) sum over k = tau ... N-1 of x_k y_{k-tau}, for tau = 0 ... most, summed in order of k. Throws
/// std::invalid_argument unless x and y are equally long and 0 <= most < N.
Signal correlation(Signal const& x, Signal const& y, Index most);

/// The n x n matrix (1/(N-n+1)) sum of v_k v_k', v_k = [x_k ... x_{k-n+1}]: R_x, positive definite if and only if x is
/// exciting of order n over the record.
Matrix<double> correlation_matrix(Signal const& x, Index n);

/// Root mean square of the units to which the numbers were rounded: powers of ten. A last digit of 0 is not written
/// everywhere, so the decimals of a number are those of half of the values in its decade (of half of all values, where
/// it has few), or its own if they are more. Numbers that are no decimals are a converter's, with its step for all. A
/// signal of a few levels (PRBS, steps) was made with these levels, not rounded to them. No unit is below `least` of
/// the largest number: computed data carry about a thousand rounding errors of binary64, and measured data are coarser.
double resolution_of(Signal const& x, double least = 0x1p-42);

/// The results for one order n.
struct ExcitationOrder {
    Index order;
    bool definite;     ///< the sign of the least eigenvalue of sum v_k v_k', decided exactly for the stored numbers
    double condition;  ///< kappa_2 of the matrix of the v_k, to about 12 digits; infinity when singular
    double least;      ///< the least eigenvalue of R_x
    bool resolved;     ///< least is above the eigenvalue that rounding to the record's resolution causes by itself
    double carried;    ///< how many rows carry it: (sum w_k^2)^2 / sum w_k^4, w_k = z'v_k, z its eigenvector; 0 when
                       ///< singular
};

struct Excitation {
    Index order = 0;        ///< the largest n up to which all are definite and resolved
    Index exact_order = 0;  ///< the largest n up to which all are definite
    Index persistent =
        0;  ///< the largest n up to order up to which 2 n rows, or an eighth of all, carry the least eigenvalue
    double resolution = 0;  ///< root mean square of the units in the numbers' last digits, as far as binary64 can tell
    Index constant_at_start = 0;          ///< samples at the start over which the input does not change
    Index changes = 0;                    ///< samples that differ from the one before
    std::vector<ExcitationOrder> orders;  ///< n = 1 ... most, or up to the first that is singular
};

struct ExcitationOptions {
    bool constant = false;  ///< the model has a constant regressor: the mean of the v_k is subtracted
    std::function<void(double)> progress = nullptr;  ///< called with the fraction that is done
};

/// Tests the orders 1 ... most. u is exciting of order n if R_u (n x n) is positive definite; a model of order m with
/// input terms u_k ... u_{k-m} needs n = m + 1. With a constant regressor besides, [v_k; 1] must have full rank: the
/// R_u of v_k less their mean. Number k of a record is rounded to a unit q_k, which by itself adds about the mean of
/// q_k^2/12 to every eigenvalue: a least eigenvalue below 4 times that may be rounding alone. An input that changes
/// once is exciting of every order, by the n - 1 rows at its change: one noise sample there decides. It is not
/// persistent beyond order 1. Throws std::invalid_argument for an empty record. Time grows as most^2 N + most^4.
/// Source: Söderström & Stoica 1989, 5.4; docs/theory.md 4.
Excitation excitation(Signal const& u, Index most, ExcitationOptions const& options = {});

}  // namespace rlslab
