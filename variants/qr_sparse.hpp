// Sparse QR on blocks of rows by SuiteSparseQR. Binary64 only; GPL-2+ by its library.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/spqr.hpp>

namespace rlslab {

/// Propagates the sparse upper triangular R, R'R = P^-1, and z = R theta. A block of B rows, the oldest first, row k
/// weighted by sqrt(lambda)^(B-1-k), is appended and factored again; columns keep their order, none is dropped:
///
///   (1) [ sqrt(lambda)^B R   sqrt(lambda)^B z ]  =  Q [ R  z ]
///       [ psi'               y                ]       [ 0  * ]
///   (2) e = y - psi'theta,   gamma = lambda / (lambda + |R^-T psi|^2)    with the R of the step before
///
/// Storage and time follow the fill of R, not d^2. Each block costs a pass over all of R, so that a block should have
/// about as many rows as there are parameters. Needs a prior. Source: Davis 2011.
class QrSparse {
    double lambda_;
    Vector<double> z_, theta_;
    SparseRow psi_;
    SparseTriangle R_;

    /// x = R^-1 x and R^-T x; NaN where R has lost a pivot.
    void solve(Vector<double>& x) const {
        if (has_pivots(R_)) R_.triangularView<Eigen::Upper>().solveInPlace(x);
        else x.setConstant(undefined<double>());
    }
    void solve_transposed(Vector<double>& x) const {
        if (has_pivots(R_)) R_.transpose().triangularView<Eigen::Lower>().solveInPlace(x);
        else x.setConstant(undefined<double>());
    }

public:
    using scalar = double;
    static constexpr std::string_view name = "qr_sparse";
    static constexpr Family family{Family::other, 1};
    static constexpr Index block = 256;

    explicit QrSparse(Problem<double> const& problem)
        : lambda_(checked(problem).forgetting), theta_(start_theta<double, Dynamic>(problem).view()),
          psi_(problem.size) {
        Vector<double> D;
        SparseRows const L = start_information(problem, D), R = D.cwiseSqrt().asDiagonal() * SparseRows(L.transpose());
        R_ = R.cast<double>();
        z_ = R * theta_;
    }

    /// Folds in B >= 1 rows at once, the oldest first: psi is d x B, y has B entries. Returns the health after the
    /// last.
    Health update_block(Matrix<double> const& psi, Vector<double> const& y) {
        return update_block(SparseRows(psi.sparseView()), y);
    }
    Health update_block(SparseRows const& psi, Vector<double> const& y) {
        Index const rows = y.size();
        expects(psi.rows() == z_.size() && psi.cols() == rows && rows >= 1,
                "a block of d x B regressors and B outputs");
        psi_ = column(psi, rows - 1);
        SparseRows weighted = psi;
        Vector<double> right = y;
        double weight = 1;
        bool finite = true;    // SuiteSparseQR takes nothing else
        for (Index k = rows - 1; k >= 0; --k, weight *= std::sqrt(lambda_)) {                            // (1)
            for (SparseRows::InnerIterator it(weighted, k); it; ++it) {
                it.valueRef() *= weight;
                finite = finite && std::isfinite(it.value());
            }
            right[k] *= weight;
        }
        R_ *= weight;
        z_ *= weight;
        if (finite && right.allFinite() && z_.allFinite()) {
            append_rows(R_, z_, weighted, right);
            theta_ = z_;
            solve(theta_);
        } else {
            z_.setConstant(undefined<double>());
            theta_ = z_;
        }
        bool const sound = finite && theta_.allFinite() && gain().allFinite() &&
                           Eigen::Map<Vector<double> const>(R_.valuePtr(), R_.nonZeros()).allFinite();
        return sound ? Health::sound : Health::nonfinite;
    }

    Step<double> update(Regressor<double> psi, double y) { return update(sparse(psi), y); }
    Step<double> update(SparseRow const& psi, double y) {
        expects(psi.size() == z_.size(), "a regressor of the problem's size");
        Vector<double> f = psi;                                                                          // (2)
        double const e = y - dot(psi, theta_);
        solve_transposed(f);
        double const s = lambda_ + dot(f.data(), f.data(), f.size());
        SparseRows row(psi.size(), 1);
        row.col(0) = psi;
        bool const finite = update_block(row, Vector<double>::Constant(1, y)) == Health::sound;
        return if_finite(finite, step_of(e, lambda_, s));
    }

    Vector<double> const& theta() const { return theta_; }
    Vector<double> gain() const {
        Vector<double> K = psi_;
        solve_transposed(K);
        solve(K);
        return K;
    }
    Matrix<double> information() const { return Matrix<double>(R_.transpose() * R_); }
    Stored<double> stored() const {
        return {Stored<double>::Quantity::information, Stored<double>::Form::factor, Matrix<double>(R_.transpose())};
    }
    static auto state(auto& f) { return std::tie(f.lambda_, f.z_, f.theta_, f.psi_, f.R_); }
};
static_assert(ReportsInformation<QrSparse> && TakesBlocks<QrSparse>);

}  // namespace rlslab
