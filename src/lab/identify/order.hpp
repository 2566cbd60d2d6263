// The choice of an order: fits of all orders in one pass over the columns, and the usual criteria.
#pragma once

#include <rlslab/model/fit.hpp>
#include <rlslab/model/regression.hpp>
#include <rlslab/model/signals.hpp>

namespace rlslab::identify {

/// Residuals pass for white at this tail probability or above; an order improves on the one before below it.
inline constexpr double white_level = 0.01, improvement_level = 0.01;

/// J = sum of squared residuals of d parameters over N rows:
///   AIC = N ln(J/N) + 2 d      BIC = N ln(J/N) + d ln N      FPE = (J/N) (N + d)/(N - d)
struct Criteria {
    double aic, bic, fpe;
};
Criteria criteria(double J, Index N, Index d);

/// One order's fit, on the N rows that all orders share.
struct OrderFit {
    int order;
    Index parameters;      ///< d
    double J;              ///< sum of squared residuals
    double aic, bic, fpe;  ///< Criteria
    double p;              ///< F-test against the order before: the tail probability of its improvement
    double ljung_box;      ///< tail probability of Ljung and Box's Q of the residuals
    double held_out;       ///< percent of one-step fit on the held-out rows; NaN without such rows
};

/// The order that each criterion suggests, order 0 included, and the choice. Candidates are the orders from that of the
/// least BIC on, at least 1, whose residuals pass for white: the one of least BIC is chosen. Without a candidate it is
/// the least BIC from order 1 on. `why` names the case. Below the order of the least BIC residuals may pass only
/// because missing terms make them large.
struct OrderChoice {
    Index rows = 0;
    std::vector<OrderFit> fits = {};
    int aic = 0, bic = 0, fpe = 0, f_test = 0;  ///< f_test: the last order that improves on the one before
    double static_p = 1;                        ///< F-test of order 0 against the constant alone: the tail probability
    int order = 0;
    std::string why = {};
};

/// The columns of an ARX model in the order of its recursion, for all orders at once on the same rows (the presample of
/// the largest): X = u_k (each input), 1 if there is an intercept, then -y_{k-1}, u_{k-1} (each input), ...,
/// -y_{k-most}, u_{k-most}; each input later by its delay. Rows in which a value is missing (NaN) are left out.
struct OrderColumns {
    Matrix<double> X;
    Vector<double> y;
    int inputs;
    bool intercept;
    std::vector<Index> samples = {};  ///< k of each row
    /// Columns of order n.
    Index columns(int order) const { return inputs + intercept + Index(order) * (1 + inputs); }
};
OrderColumns order_columns(std::vector<Signal> const& inputs, Signal const& y, int most, std::vector<int> const& delay,
                           bool intercept);

/// Orders 0 ... most by appended columns of a QR factorisation, up to the first whose columns depend on one another;
/// the last held_out rows are not fitted.
/// Source: Söderström & Stoica 1989, 11.5; Ljung & Box 1978.
OrderChoice choose_order(OrderColumns const& columns, int most, Index held_out);

/// Number of lags of the whiteness test for an order.
Index ljung_box_lags(Index rows, int order);
/// Largest J that rounding alone causes, for this number of rows with outputs up to y.
double rounding_alone(Index rows, double y);

/// Ljung and Box: Q = N (N + 2) sum over tau = 1 ... lags of r_tau^2 / (N - tau), of N residuals after so many
/// parameters of past outputs were fitted; p is its tail probability, chi-squared with `freedom` = lags - fitted, 1 at
/// least. If residuals are missing (NaN), N - tau is the number of complete pairs, and lags without a pair do not
/// count.
struct LjungBox {
    double Q, p;
    Index lags, freedom;
    bool zeros = false;  ///< nothing but zeros: Q is 0 also where no residual meets another
    bool white() const { return p >= white_level; }
};
/// Nothing but zeros: Q = 0, p = 1. Infinite residuals, or none: NaN. Throws std::invalid_argument unless 1 <= lags <
/// N.
LjungBox ljung_box(Vector<double> const& residuals, Index lags, Index fitted);

}  // namespace rlslab::identify
