// Sparse rows folded into a sparse triangle by SuiteSparseQR. GPL-2+ by that library.
#pragma once

#include <rlslab/linalg/sparse.hpp>

#include <Eigen/SPQRSupport>

#include <vector>

namespace rlslab {

/// An upper triangular R, d x d, in SuiteSparseQR's type.
using SparseTriangle = Eigen::SparseMatrix<double, Eigen::ColMajor, SuiteSparse_long>;

template <>
struct IrregularState<SparseTriangle> {
    static void put(SparseTriangle const& R, auto number) {
        for (Index j = 0; j < R.cols(); ++j) detail::put_column(SparseTriangle::InnerIterator(R, j), number);
    }
    static bool get(SparseTriangle& R, auto number, bool keep) {
        SparseTriangle read(R.rows(), R.cols());
        for (Index j = 0; j < R.cols(); ++j) {
            read.startVec(j);
            if (!detail::get_column(0, j + 1, number, [&](Index i, double value) { read.insertBack(i, j) = value; }))
                return false;
        }
        read.finalize();
        if (keep) R = read;
        return true;
    }
};

/// Whether R has its d pivots. SuiteSparseQR leaves out a pivot that underflowed to zero; Eigen's solver would then
/// divide by another entry.
inline bool has_pivots(SparseTriangle const& R) {
    for (Index j = 0; j < R.cols(); ++j) {
        SparseTriangle::ReverseInnerIterator const last(R, j);
        if (!last || last.index() != j || last.value() == 0) return false;
    }
    return true;
}

/// Folds B rows psi' (psi is d x B) with right-hand sides y (B) into [R z] (z has d numbers): R is stacked on the rows
/// and factored. Columns keep their order and none is dropped. Memory and time follow the fill of R and of the
/// reflections. All numbers must be finite.
inline void append_rows(SparseTriangle& R, Vector<double>& z, SparseRows const& psi, Vector<double> const& y) {
    Index const d = R.cols();
    std::vector<Eigen::Triplet<double, SuiteSparse_long>> entries;
    entries.reserve(size_t(R.nonZeros() + psi.nonZeros()));
    for (Index j = 0; j < d; ++j)
        for (SparseTriangle::InnerIterator it(R, j); it; ++it) entries.emplace_back(it.row(), it.col(), it.value());
    for (Index k = 0; k < psi.cols(); ++k)
        for (SparseRows::InnerIterator it(psi, k); it; ++it) entries.emplace_back(d + k, it.index(), it.value());
    SparseTriangle A(d + psi.cols(), d);
    A.setFromTriplets(entries.begin(), entries.end());
    Vector<double> right(A.rows());
    right << z, y;

    Eigen::SPQR<SparseTriangle> qr;
    qr.setSPQROrdering(SPQR_ORDERING_FIXED);
    qr.setPivotThreshold(0);
    qr.compute(A);
    Vector<double> const rotated = qr.matrixQ().adjoint() * right;
    R = qr.matrixR();
    z = rotated.head(d);
}

}  // namespace rlslab
