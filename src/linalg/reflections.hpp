// Householder reflections that fold a block of rows into a triangle.
#pragma once

#include <rlslab/linalg/kernels.hpp>

namespace rlslab {

/// A block of rows, or the transpose of one: any number of rows and columns.
template <class T>
using Rows = Eigen::Matrix<T, Dynamic, Dynamic>;

/// |(a, x)|, where largest > 0 is its largest entry: by the plain sum of squares, or the scaled one when that leaves the
/// range in which its terms are normal numbers.
template <Real T>
T norm(T const& a, T const* x, Index n, T const& largest) {
    T const sum = a * a + dot(x, x, n);
    if (is_finite(sum) && least_sum_of_squares<T>() < sum) return square_root(sum);
    T scaled = (a / largest) * (a / largest);
    for (Index k = 0; k < n; ++k) scaled += (x[k] / largest) * (x[k] / largest);
    return largest * square_root(scaled);
}

/// Folds the B x (d + 1) block A = [psi' y] into [R z], R = L', one reflection for each column i:
///
///   (1) r = +-|(R_ii, A_i)|, away from R_ii's sign;   v = (1, A_i / (R_ii - r)),   tau = (r - R_ii) / r
///   (2) each later column (R_ij, A_j):  t = tau (R_ij + v'A_j),   R_ij -= t,  A_j -= t v
///
/// A's last column becomes eta. Returns the product of |R_ii / r|: sqrt(gamma) when B = 1. A zero block changes nothing.
/// Source: Golub, Numer. Math. 7, 1965; Golub & Van Loan, Matrix Computations, 5.1.
template <Real T, int N>
T fold(Square<T, N>& L, Column<T, N>& z, Rows<T>& A) {
    Index const d = z.size(), rows = A.rows();
    T ratio = T(1);
    for (Index i = 0; i < d; ++i) {
        T* const v = A.col(i).data();
        T const a = L(i, i);
        T largest = T(0);
        for (Index k = 0; k < rows; ++k)
            if (!(absolute(v[k]) <= largest)) largest = absolute(v[k]);
        if (largest == T(0)) continue;    // nothing below the diagonal
        if (largest < absolute(a)) largest = absolute(a);
        T const size = norm(a, v, rows, largest);
        T const r = a < T(0) ? size : -size;                                                             // (1)
        T const tau = (r - a) / r, pivot = a - r;
        for (Index k = 0; k < rows; ++k) v[k] /= pivot;
        L(i, i) = r;
        ratio *= absolute(a / r);
        for (Index j = i + 1; j <= d; ++j) {                                                             // (2)
            T& above = j < d ? L(j, i) : z[i];
            T const t = tau * (above + dot(v, A.col(j).data(), rows));
            above -= t;
            add_scaled(A.col(j).data(), -t, v, rows);
        }
    }
    return ratio;
}

}  // namespace rlslab
