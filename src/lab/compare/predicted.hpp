// Digits of P that forms are predicted to keep, from the rows alone: the half-power law in the norm of a comparison.
#pragma once

#include "src/lab/compare/compare.hpp"
#include "src/lab/compare/rounded_problem.hpp"

#include <map>

namespace rlslab::compare {

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
