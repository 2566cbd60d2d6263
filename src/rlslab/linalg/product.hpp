// A product of matrices, for what is no variant: laws, reports, studies.
#pragma once

#include <rlslab/core/misuse.hpp>
#include <rlslab/core/matrices.hpp>

namespace rlslab::detail {

/// A B, each sum from the first product to the last. Eigen cuts long sums by the sizes of the processor's caches.
template <class T>
Matrix<T> product(Matrix<T> const& A, Matrix<T> const& B) {
    expects(A.cols() == B.rows(), "as many columns of the first matrix as the second has rows");
    Matrix<T> C = Matrix<T>::Zero(A.rows(), B.cols());
    for (Index j = 0; j < B.cols(); ++j)
        for (Index k = 0; k < B.rows(); ++k) C.col(j) += A.col(k) * B(k, j);
    return C;
}

}  // namespace rlslab::detail
