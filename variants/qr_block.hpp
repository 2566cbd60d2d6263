// QR by Householder reflections on blocks of rows: batch least squares that never holds more than one block.
#pragma once

#include <rlslab/concept.hpp>
#include <rlslab/linalg/reflections.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates the upper triangular R, R'R = P^-1, and z = R theta. A block of B rows, the oldest first, row k weighted by
/// sqrt(lambda)^(B-1-k), is folded in by one reflection for each column i:
///
///   (1) [ sqrt(lambda)^B R   sqrt(lambda)^B z ]  ->  [ R  z   ]
///       [ psi'               y                ]      [ 0  eta ]
///   (2) theta (R theta = z) and K (R'R K = psi, the last row's) are solved for when asked
///
/// One row at a time (update) this reports as `qr` does: sqrt(gamma) = prod |c_i|, e = eta / sqrt(gamma).
/// Storage d^2 and the block; per row 1 d^2 + O(d) multiplications. Starts without a prior.
/// Sources: Golub, Numer. Math. 7, 1965; Demmel, Grigori, Hoemmen & Langou (TSQR).
template <Real T, int N = Dynamic>
class QrBlock {
    T root_lambda_;
    Column<T, N> z_, psi_;
    Square<T, N> L_;                                  // R'
    Rows<T> A_, row_;    // a block and one row, each with y as its last column

public:
    using scalar = T;
    static constexpr std::string_view name = "qr_block";
    static constexpr bool starts_without_prior = true;
    static constexpr Index block = 64;

    explicit QrBlock(Problem<T> const& problem)
        : root_lambda_(square_root(checked(problem, N).forgetting)), z_(problem.size), psi_(problem.size), L_(problem.size),
          row_(1, problem.size + 1) {
        start_information_root(problem, L_, z_);
    }

    /// Folds in B >= 1 rows at once, the oldest first: psi is d x B, y has B entries.
    void absorb(Eigen::Ref<Rows<T> const> const& psi, Eigen::Ref<Vector<T> const> const& y) {
        Index const d = z_.size(), rows = y.size();
        expects(psi.rows() == d && psi.cols() == rows && rows >= 1, "a block of d x B regressors and B outputs");
        A_.resize(rows, d + 1);
        T weight = T(1);
        for (Index k = rows - 1; k >= 0; --k) {                                                          // (1)
            for (Index i = 0; i < d; ++i) A_(k, i) = weight * psi(i, k);
            A_(k, d) = weight * y[k];
            weight *= root_lambda_;
        }
        scale(weight);
        for (Index i = 0; i < d; ++i) psi_[i] = psi(i, rows - 1);
        fold(L_, z_, A_);
    }

    Step<T> update(Regressor<T> psi, T y) {
        keep_regressor(psi, psi_);
        for (Index i = 0; i < z_.size(); ++i) row_(0, i) = psi_[i];
        row_(0, z_.size()) = y;
        scale(root_lambda_);
        bool determined = true;
        for (Index i = 0; i < z_.size(); ++i) determined = determined && L_(i, i) != T(0);
        T const root_gamma = fold(L_, z_, row_);
        return report_rotated(T(row_(0, z_.size())), root_gamma, determined);
    }

    Vector<T, N> theta() const { return solved_lower_transposed(L_, z_); }
    Vector<T, N> gain() const { return solve_outer(L_, psi_); }
    Matrix<T, N> information() const { return outer(L_); }
    Stored<T> stored() const { return {Stored<T>::Of::information, Stored<T>::Kind::factor, L_.view()}; }

private:
    void scale(T const& weight) {
        for (Index i = 0; i < z_.size(); ++i) {
            for (Index j = i; j < z_.size(); ++j) L_(j, i) *= weight;
            z_[i] *= weight;
        }
    }
};
static_assert(ReportsInformation<QrBlock<double>> && StartsWithoutPrior<QrBlock<double>> && TakesBlocks<QrBlock<double>>);

}  // namespace rlslab
