// Sparse rows and the state the sparse variants start with, all in memory of the order of what is not zero.
#pragma once

#include <rlslab/linalg/start.hpp>

#include <Eigen/SparseCore>

namespace rlslab {

/// A regressor of which only a few numbers are not zero, and columns of such; indices ascend.
using SparseRow = Eigen::SparseVector<double>;
using SparseRows = Eigen::SparseMatrix<double>;

/// What is not zero in a dense regressor; a NaN is not.
inline SparseRow sparse(Regressor<double> const& psi) {
    SparseRow out(psi.size());
    for (Index i = 0; i < psi.size(); ++i)
        if (psi[i] != 0) out.insertBack(i) = psi[i];
    return out;
}
inline SparseRow column(SparseRows const& psi, Index k) {
    SparseRow out(psi.rows());
    for (SparseRows::InnerIterator it(psi, k); it; ++it) out.insertBack(it.index()) = it.value();
    return out;
}

/// psi'x, over what psi holds from the first to the last.
inline double dot(SparseRow const& psi, Vector<double> const& x) {
    double sum = 0;
    for (SparseRow::InnerIterator it(psi); it; ++it) sum += it.value() * x[it.index()];
    return sum;
}

/// P0^-1 = L diag(D) L' with L unit lower triangular: of c^2 I nothing but the diagonal is ever made.
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
