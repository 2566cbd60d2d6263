// QR by Householder reflections on blocks of rows: batch least squares in the memory of one block. Filters merge.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/forms.hpp>
#include <rlslab/linalg/reflections.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates the upper triangular R, R'R = P^-1, and z = R theta. A block of B rows, the oldest first, row k weighted
/// by sqrt(lambda)^(B-1-k), is folded in by one reflection for each column i, eight of them at a time (a panel):
///
///   (1) [ sqrt(lambda)^B R   sqrt(lambda)^B z ]  ->  [ R  z   ]
///       [ psi'               y                ]      [ 0  eta ]
///   (2) I - beta_i v_i v_i',  v_i = (R_ii - r, x_i),  r = -+|(R_ii, x_i)|,  beta_i = 1 / (r (r - R_ii)): in the panel
///   (3) W = X'A,  G = X'X,  X = (x_1 ... x_8),  T by substitution with G,  A -= X T: in the columns A behind it
///   (4) theta (R theta = z) and K (R'R K = psi, the last row's) are solved for on request
///   (5) merging: (1) with [R, z] of n newer rows as the block, weighted already, and B = n
///
/// Each sum's order is that of kernels::ReflectPanel. Where squares leave the arithmetic's range, for complex numbers,
/// in fixed point and in update(), v_i = (1, x_i / (R_ii - r)), one by one. update() reports as `qr` does: sqrt(gamma)
/// = prod |c_i|, e = eta / sqrt(gamma). Storage d^2 and the block; per row d^2 + O(d) multiplications, per merging d^3.
/// Starts without a prior, and should if 1/sqrt(P0) is below u |psi|, which reflections round away.
/// Sources: Golub 1965; Puglisi 1992; Demmel, Grigori, Hoemmen & Langou 2012 (TSQR).
template <RootedScalar T, int N = Dynamic>
class QrBlock {
    RealOf<T> lambda_, root_lambda_, root_gamma_{};
    StateVector<T, N> z_, psi_, x_, rest_;
    StateVector<RealOf<T>, N> tau_;
    StateMatrix<T, N> L_; ColumnLengths<T, N> lengths_;          // R'
    bool prior_; Index rows_ = 0;                          // started with one; rows taken so far
    RowBlock<T> A_;                                          // a block, with y as its last column

    bool enough() const { return prior_ || rows_ >= z_.size(); }
    Truth<T> determined() const { return lengths_.determined(L_) && nonsingular(L_) && Truth<T>(enough()); }
    /// After a block that stands for `rows` rows, `taken` if its eta is finite.
    PerLane<T, Health> folded(Index rows, Truth<T> const& taken) {
        rows_ += rows;
        Truth<T> const finite = lengths_.finite(L_, z_, psi_, x_);
        return health_of<T>(taken && all_finite(z_), determined(), finite);
    }

public:
    using scalar = T;
    static constexpr std::string_view name = "qr_block";
    static constexpr Family family{Family::wide_qr};
    static constexpr bool starts_without_prior = true;
    static constexpr int edition = 2; static constexpr Index block = 256;

    explicit QrBlock(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), root_lambda_(square_root(lambda_)), z_(problem.size), psi_(z_),
          x_(z_), rest_(z_), tau_(problem.size), L_(problem.size), lengths_(problem.size),
          prior_(problem.prior.has_value()) {
        start_information_root(problem, L_, z_);
        lengths_.start(L_, z_);
    }

    /// Folds in B >= 1 rows, the oldest first, psi of d x B; `further`: MultiOutput's. Returns the last row's health.
    PerLane<T, Health> update_block(RowsOf<T> psi, OutputsOf<T> y, FurtherSides<T> const& further = {}) {
        Index const d = z_.size(), rows = y.size();
        expects(psi.rows() == d && psi.cols() == rows && rows >= 1, "a block of d x B regressors and B outputs");
        for (Index i = 0; i < d; ++i) psi_[i] = psi(i, rows - 1);
        return folded(rows, fold_rows<T, N>(L_, z_, A_, lengths_, psi, y, root_lambda_, further));            // (1)
    }

    /// Appends the rows of `newer`, a filter of this problem that started without prior; further.y: its z.
    PerLane<T, Health> merge(QrBlock const& newer, FurtherSides<T> const& further = {}) {
        expects(newer.z_.size() == z_.size() && all(newer.lambda_ == lambda_) && !newer.prior_,
                "a part of this problem, no prior");
        if (rows_ == 0 && !prior_) { state(*this) = state(newer); further.copy(z_.size()); return folded(0, true); }
        if (newer.rows_ > 0) psi_ = newer.psi_;
        return folded(newer.rows_, fold_triangle(L_, z_, A_, lengths_, newer.L_, newer.z_, root_lambda_, newer.rows_,
                                                 further));                                            // (5)
    }

    Step<T> update(Regressor<T> psi, T y) {
        keep_regressor(psi, psi_, x_);
        Truth<T> const before = determined();
        ++rows_;
        T eta = y;
        root_gamma_ = reflect_row_into(root_lambda_, L_, z_, x_, eta, tau_);
        Step<T> const step = report_rotated(eta, root_gamma_, before);
        return if_finite(lengths_.add_row(lambda_, psi_, y, L_, z_, rest_) || !before, step);
    }

    Vector<T, N> theta() const { return solved_lower_transposed(L_, z_); }
    Vector<T, N> gain() const { return solved_outer(L_, psi_); }
    Matrix<T, N> information() const { return outer(L_); }
    Stored<T> stored() const { return {Stored<T>::Quantity::information, Stored<T>::Form::factor, L_.view()}; }
    auto last_row() requires Field<T> {
        return LastReflections<T, N>{root_lambda_, root_gamma_, z_, x_, tau_, L_, lengths_};
    }
    static auto state(auto& f) {
        return std::tie(f.lambda_, f.root_lambda_, f.z_, f.psi_, f.L_, f.lengths_, f.rows_, f.prior_);
    }
};
static_assert(ReportsInformation<QrBlock<double>> && Merges<QrBlock<double>> && TakesBlocks<QrBlock<double>>);

}  // namespace rlslab
