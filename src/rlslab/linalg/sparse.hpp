// Sparse rows, and the state with which the sparse variants start. Memory is of the order of the number of nonzeros.
#pragma once

#include <rlslab/linalg/start.hpp>

#include <Eigen/SparseCore>

namespace rlslab {

/// A regressor of d numbers, most of them zero, and a d x B matrix whose columns are such regressors. Indices ascend.
using SparseRow = Eigen::SparseVector<double>;
using SparseRows = Eigen::SparseMatrix<double>;

/// The numbers of a dense regressor that are not zero. A NaN is not zero.
inline SparseRow sparse(Regressor<double> const& psi) {
    SparseRow out(psi.size());
    for (Index i = 0; i < psi.size(); ++i)
        if (psi[i] != 0) out.insertBack(i) = psi[i];
    return out;
}
/// Column k of psi.
inline SparseRow column(SparseRows const& psi, Index k) {
    SparseRow out(psi.rows());
    for (SparseRows::InnerIterator it(psi, k); it; ++it) out.insertBack(it.index()) = it.value();
    return out;
}

/// psi'x: the products of psi's stored numbers, summed from the first to the last.
inline double dot(SparseRow const& psi, Vector<double> const& x) {
    double sum = 0;
    for (SparseRow::InnerIterator it(psi); it; ++it) sum += it.value() * x[it.index()];
    return sum;
}

/// Returns L (unit lower triangular, sparse) and sets D of P0^-1 = L diag(D) L'. P0 = c^2 I needs O(d) memory, a full P0 O(d^2). Throws
/// std::invalid_argument without a prior, or when a full P0 is not positive definite.
inline SparseRows start_information(Problem<double> const& problem, Vector<double>& D) {
    expects(problem.prior.has_value(), "a prior: the sparse factor is kept nonsingular");
    SparseRows L(problem.size, problem.size);
    if (!problem.prior->covariance) {
        D = Vector<double>::Constant(problem.size, 1 / problem.prior->variance);
        L.setIdentity();
        return L;
    }
    StateMatrix<double> dense(problem.size);
    StateVector<double> pivots(problem.size);
    start_information(problem, dense, pivots);
    D = pivots.view();
    return dense.view().sparseView();
}

}  // namespace rlslab
