// Sparse QR on blocks of rows by SuiteSparseQR. Binary64 only; GPL-2+ by its library.
#pragma once

#include <rlslab/concept.hpp>
#include <rlslab/linalg/start.hpp>

#include <Eigen/SPQRSupport>

namespace rlslab {

/// Propagates the sparse upper triangular R, R'R = P^-1, and z = R theta. A block of B rows, the oldest first, row k
/// weighted by sqrt(lambda)^(B-1-k), is appended and factored again; columns keep their order, none is dropped:
///
///   (1) [ sqrt(lambda)^B R   sqrt(lambda)^B z ]  =  Q [ R  z ]
///       [ psi'               y                ]       [ 0  * ]
///   (2) e = y - psi'theta,   gamma = lambda / (lambda + |R^-T psi|^2)    with the R of the step before
///
/// The cost follows the fill of R, not d^2. Needs a prior. Source: Davis, SuiteSparseQR, ACM TOMS 38(1), 2011.
class QrSparse {
    using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, SuiteSparse_long>;
    double lambda_;
    Vector<double> z_, theta_, psi_;
    Sparse R_;

    static Sparse stacked(Sparse const& R, Eigen::MatrixXd const& rows) {
        std::vector<Eigen::Triplet<double, SuiteSparse_long>> entries;
        for (Index j = 0; j < R.outerSize(); ++j)
            for (Sparse::InnerIterator it(R, j); it; ++it) entries.emplace_back(it.row(), it.col(), it.value());
        for (Index k = 0; k < rows.cols(); ++k)
            for (Index i = 0; i < rows.rows(); ++i)
                if (rows(i, k) != 0) entries.emplace_back(R.rows() + k, i, rows(i, k));
        Sparse A(R.rows() + rows.cols(), R.cols());
        A.setFromTriplets(entries.begin(), entries.end());
        return A;
    }

public:
    using scalar = double;
    static constexpr std::string_view name = "qr_sparse";
    static constexpr Index block = 256;

    explicit QrSparse(Problem<double> const& problem)
        : lambda_(checked(problem).forgetting), z_(problem.size), theta_(start_theta<double, Dynamic>(problem).view()),
          psi_(Vector<double>::Zero(problem.size)) {
        expects(problem.prior.has_value(), "a prior: sparse R is kept square and nonsingular");
        Square<double> L(problem.size);
        Column<double> z(problem.size);
        start_information_root(problem, L, z);
        z_ = z.view();
        R_ = L.view().transpose().sparseView().cast<double>();
    }

    /// Folds in B >= 1 rows at once, the oldest first: psi is d x B, y has B entries.
    void absorb(Eigen::MatrixXd const& psi, Vector<double> const& y) {
        Index const d = z_.size(), rows = y.size();
        expects(psi.rows() == d && psi.cols() == rows && rows >= 1, "a block of d x B regressors and B outputs");
        psi_ = psi.col(rows - 1);
        Eigen::MatrixXd weighted = psi;
        Vector<double> right(d + rows);
        double weight = 1;
        for (Index k = rows - 1; k >= 0; --k, weight *= std::sqrt(lambda_)) {                            // (1)
            weighted.col(k) *= weight;
            right[d + k] = weight * y[k];
        }
        right.head(d) = weight * z_;
        if (!weighted.allFinite() || !right.allFinite()) {    // SuiteSparseQR does not take these
            z_.setConstant(undefined<double>());
            theta_ = z_;
            return;
        }
        Eigen::SPQR<Sparse> qr;
        qr.setSPQROrdering(SPQR_ORDERING_FIXED);
        qr.setPivotThreshold(0);
        qr.compute(stacked(weight * R_, weighted));
        Vector<double> const rotated = qr.matrixQ().adjoint() * right;
        R_ = qr.matrixR();
        z_ = rotated.head(d);
        theta_ = z_;
        R_.triangularView<Eigen::Upper>().solveInPlace(theta_);
    }

    Step<double> update(Regressor<double> psi, double y) {
        expects(psi.size() == z_.size(), "a regressor of the problem's size");
        Vector<double> f = Eigen::Map<Vector<double> const>(psi.data(), psi.size());                     // (2)
        Eigen::MatrixXd const row = f;
        double const e = y - dot(psi.data(), theta_.data(), psi.size());
        R_.transpose().triangularView<Eigen::Lower>().solveInPlace(f);
        double const gamma = lambda_ / (lambda_ + dot(f.data(), f.data(), f.size()));
        absorb(row, Vector<double>::Constant(1, y));
        return report(e, gamma);
    }

    Vector<double> const& theta() const { return theta_; }
    Vector<double> gain() const {
        Vector<double> K = psi_;
        R_.transpose().triangularView<Eigen::Lower>().solveInPlace(K);
        R_.triangularView<Eigen::Upper>().solveInPlace(K);
        return K;
    }
    Matrix<double> information() const { return Matrix<double>(R_.transpose() * R_); }
    Stored<double> stored() const {
        return {Stored<double>::Of::information, Stored<double>::Kind::factor, Matrix<double>(R_.transpose())};
    }
};
static_assert(ReportsInformation<QrSparse> && TakesBlocks<QrSparse>);

}  // namespace rlslab
