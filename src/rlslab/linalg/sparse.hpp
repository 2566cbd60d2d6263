// Sparse rows, and the state with which the sparse variants start. Memory is of the order of the number of nonzeros.
#pragma once

#include <rlslab/core/encoding.hpp>
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

namespace detail {
/// Entries of a column, indices ascending within [first, end): shown to number, or read by it and given to
/// insert(index, value).
void put_column(auto entries, auto number) {
    std::int64_t count = 0;
    for (auto it = entries; it; ++it) ++count;
    number(count);
    for (auto it = entries; it; ++it) {
        number(std::int64_t(it.index()));
        number(double(it.value()));
    }
}
bool get_column(Index first, Index end, auto number, auto insert) {
    std::int64_t count = 0, index = 0;
    double value = 0;
    if (!number(count) || count < 0 || count > end - first) return false;
    for (; count > 0; --count) {
        if (!number(index) || !number(value) || index < first || index >= end) return false;
        insert(Index(index), value);
        first = Index(index) + 1;
    }
    return true;
}
}  // namespace detail

template <>
struct IrregularState<SparseRow> {
    static void put(SparseRow const& x, auto number) { detail::put_column(SparseRow::InnerIterator(x), number); }
    static bool get(SparseRow& x, auto number, bool keep) {
        SparseRow read(x.size());
        bool const possible =
            detail::get_column(0, x.size(), number, [&](Index i, double value) { read.insertBack(i) = value; });
        if (possible && keep) x = read;
        return possible;
    }
};

/// psi'x: the products of psi's stored numbers, summed from the first to the last.
inline double dot(SparseRow const& psi, Vector<double> const& x) {
    double sum = 0;
    for (SparseRow::InnerIterator it(psi); it; ++it) sum += it.value() * x[it.index()];
    return sum;
}

/// Returns L (unit lower triangular, sparse) and sets D of P0^-1 = L diag(D) L'. P0 = c^2 I needs O(d) memory, a full
/// P0 O(d^2). Throws std::invalid_argument without a prior, or when a full P0 is not positive definite.
inline SparseRows start_information(Problem<double> const& problem, Vector<double>& D) {
    expects(problem.prior.has_value(), "a prior: the sparse factor is kept nonsingular");
    SparseRows L(problem.size, problem.size);
    if (!problem.prior->covariance && !problem.prior->stored) {
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
