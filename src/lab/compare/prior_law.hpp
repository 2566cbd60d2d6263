// The prior variance c^2 at which a form keeps most digits of least squares, predicted from the records; what a given
// one costs the forms that store P; and what a start costs those that correct theta row by row.
#pragma once

#include "src/lab/compare/score.hpp"

#include <rlslab/arithmetic/elementary.hpp>

#include <map>

namespace rlslab::compare {

/// Forms by where their rounding grows with the prior.
enum class PriorForm {
    stored,    ///< P itself, updated by a difference: u c^2 while directions are unknown
    products,  ///< P itself, by Joseph's products: the same times the size of I - K psi'
    corrected  ///< whatever they propagate: theta is corrected row by row, and rounded while it is far from its end
};

/// Errors of theta after the last row at P0 = c^2 I, |.| / |theta_LS|; in other units at P0 = diag((c / s_i)^2), in the
/// norm |x|^2 = sum (s_i x_i)^2.
struct PriorPoint {
    double c2;
    double bias;               ///< of the minimiser with the prior against least squares: (1), exact
    double stored, products;   ///< root mean square of rounding, in units of u: (3) and (4)
    double corrected, steady;  ///< likewise (5), and (5) with theta_N in place of theta_j
    double of(PriorForm form) const {
        return form == PriorForm::stored ? stored : form == PriorForm::products ? products : corrected;
    }
    double total(PriorForm form, double u) const { return correctly::hypot(bias, u * of(form)); }
};

/// With M = A'A of all rows, P_N = (M + c^-2 I)^-1, r_j the residuals at theta_N, and of the first j rows M_j, P_j,
/// K = P_j psi_j, f = P_(j-1) psi_j, e = y_j - psi_j'theta_(j-1):
///
///   (1)  theta_N - theta_LS = -c^-2 P_N theta_LS
///   (2)  s_j = sum_{i<=j} psi_i r_i - c^-2 theta_N,   W_j = P_N M_j,   w_a = |W_j e_a|,   p_j = |P_N psi_j|
///   (3)  E|delta theta|^2 = (0.425 u)^2 sum_j { sum_a (w_a^2 r_j^2 + p_j^2 s_a^2) q_a^2
///          + sum_ab w_a^2 s_b^2 (P_j,ab^2 + K_a^2 f_b^2) + sum_a w_a^2 (theta_a^2 + K_a^2 e^2)
///          + p_j^2 sum_a psi_a^2 theta_a^2 },   q_a^2 = 2 sum_b P_(j-1),ab^2 psi_b^2
///   (4)  with B = I - K psi': in place of the first two sums sum_a w_a^2 q_a^2 e^2 / s^2 + 2 sum_ab w_a^2 { (sum_i
///          B_ai^2 P_ib^2) (B's)_b^2 + (sum_i P_j,ai^2 B_bi^2) s_b^2 }
///   (5)  of (3) alone (0.425 u)^2 sum_j sum_a w_a^2 theta_a^2: what each rounding of theta_j leaves in theta_N
///
/// First order in u, each rounding independent (docs/theory.md 105).
struct PriorLaw {
    std::vector<PriorPoint> points;  ///< c^2 = powers of 16, ascending, from 1 / tr M to 2^53 / tr M; empty: none
    double trace = 0;                ///< tr M

    bool empty() const { return points.empty(); }
    /// By lines between the points, in logarithms; beyond them by the first and the last line.
    PriorPoint at(double c2) const;
    /// The point of the least total error of a form with unit roundoff u, for c^2 with u c^2 tr M <= 1: where (3) ends,
    /// for P is rounding beyond it.
    PriorPoint best(PriorForm form, double u) const;
};

/// For lambda = 1 and theta0 = 0, regressor i in units of s_i (powers of two; empty: 1). `least_squares` is the
/// certified solution without a prior after the last row. Row by row at 257 bits, for at most max(4 d, 4e4 / d^2) rows;
/// those behind them count as roundings of theta. Empty where there is no answer: theta_LS = 0, not certified, more
/// than 32 parameters, or squares that leave double's range.
PriorLaw prior_law(Records const& records, CertifiedSolution const& least_squares, Vector<double> const& s = {});
/// The same at this c^2 alone, without lines between points; nothing where there is no law.
std::optional<PriorPoint> prior_point(Records const& records, CertifiedSolution const& least_squares, double c2,
                                      Vector<double> const& s = {});

/// A loss below this is no reason for a warning.
inline constexpr double least_prior_loss = 0.5;

/// For each arithmetic of the comparison that rounds to nearest, has at most 53 bits and holds data and prior:
/// `symmetric` (for all that update P by a difference), then `joseph`; predicted by prior_law.hpp. Empty with a
/// composition, with lambda < 1, and where there is no law. Costs O(d^2) operations in 257 bits for each of at most
/// max(4 d, 4e4 / d^2) rows and 14 priors: up to a second.
/// `comparison` is what compare returned for these records.
std::vector<PriorCost> prior_costs(Records const& records, Comparison const& comparison);

/// For the same arithmetics and records, with the prior of the comparison: (5) of prior_law.hpp, and its loss to a
/// start that has theta at once. One pass over those rows; fourteen where the loss is half a digit or more.
std::vector<StartCost> start_costs(Records const& records, Comparison const& comparison);

/// The sentence on what the start costs; "" where it is less than half a digit everywhere.
std::string start_cost_text(Comparison const& comparison);

/// The sentence on --p0; "" where it is scaled to the data, or costs less than half a digit everywhere.
std::string prior_cost_text(Comparison const& comparison);

// --- digits of P that forms are predicted to keep, from the rows alone: the half-power law in the norm of a comparison

/// The law (docs/theory.md 131). P_k M_j, M_j = P_j^-1, turns an error of P_j into one of P_k. Roundings u |F_il| g of
/// a root F of P_j, g independent and of variance 1, leave in the Frobenius norm
///
///   (1) n_jk = lambda^(k-j) (sum_il F_il^2 |P_k M_j e_i|^2 |P_k M_j F e_l|^2)^(1/2)
///   (2) a factor    c u (sum_j n_jk^2)^(1/2) / ||P_k||. Where the root of lambda is rounded, P is divided by
///                   lambda (1 + eps) (item 117): eps ||sum_j lambda^(k-j) P_k M_j P_k|| / ||P_k|| besides, in squares
///   (3) P stored    at most 5 u (sum_j m_jk^2)^(1/2) / ||P_k||: as (1) with what is rounded in place of F, P_(j-1) /
///                   lambda or Joseph's |I - K psi'| |P_(j-1)| |I - K psi'|' / lambda, and P_k M_j e_l behind it
///
/// F is upper triangular; of `qr` and `gentleman` R, R'R = M_j, is rounded, and of `potter` its own root. c is in
/// predicted.cpp, fitted to about 380 other problems than docs/compare.md names. A prediction is the median over a
/// quarter of the checkpoints from row 2 d on, for the problem as stored; of the rows long ago some stand for all.
struct PowerLaw {
    struct Sizes {
        double triangle, information, root, difference, joseph, bias;  ///< over u and ||P_k||; the last over eps
    };
    std::vector<Sizes> at;
};
PowerLaw power_law(RoundedProblem const& rounded);

/// Of a form in an arithmetic; absent where there is no law for it.
std::optional<Predicted> predicted(PowerLaw const& law, CatalogueEntry const& entry, double forgetting);

/// Result::predicted of each form. `rounded`: by the name of the rounding, "double" for all words of 53 bits and more.
void predict(std::vector<Result>& results, std::map<std::string_view, RoundedProblem> const& rounded);

}  // namespace rlslab::compare
