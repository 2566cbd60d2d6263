// Householder reflections that fold a block of rows into a triangle.
#pragma once

#include <rlslab/linalg/kernels.hpp>
#include <rlslab/linalg/rotations.hpp>

namespace rlslab {

/// A block of rows, or the transpose of one: any number of rows and columns.
template <class T>
using Rows = Eigen::Matrix<T, Dynamic, Dynamic>;

/// x^n by repeated squaring, n >= 0: the weight of what is n steps old.
template <Field T>
T power(T x, Index n) {
    T out = T(1);
    for (; n > 0; n /= 2, x *= x)
        if (n % 2 == 1) out *= x;
    return out;
}

/// |(a, x)|: by the plain sum of squares, or the scaled one when that leaves the range in which its terms are normal
/// numbers; 0 where x = 0, which asks for no reflection.
template <Real T>
T norm(T const& a, T const* x, Index n) {
    T squares = T(0);
    run<T, Dynamic>(kernels::SumOfSquares<T>{n, x, &squares});
    T const sum = a * a + squares;
    Truth<T> const in_range = T(0) < squares && is_finite(sum) && least_sum_of_squares<T>() < sum;
    if (all(in_range)) return square_root(sum);
    T largest = T(0);
    for (Index k = 0; k < n; ++k) {
        Truth<T> const stays = absolute(x[k]) <= largest || !(largest == largest);    // a NaN stays
        largest = select(stays, largest, absolute(x[k]));
    }
    Truth<T> const as_it_is = largest == T(0) || !is_finite(largest);
    if constexpr (std::same_as<Truth<T>, bool>) {
        if (as_it_is) return largest;
    }
    T const most = select(largest < absolute(a), absolute(a), largest);
    T scaled = (a / most) * (a / most);
    for (Index k = 0; k < n; ++k) scaled += (x[k] / most) * (x[k] / most);
    T const size = most * square_root(scaled);
    if constexpr (std::same_as<Truth<T>, bool>)
        return size;
    else
        return select(in_range, square_root(sum), select(as_it_is, largest, size));
}

/// Folds the B x (d + 1) block A = [psi' y] into weight [R z], R = L', one reflection for each column i:
///
///   (1) r = +-|(R_ii, A_i)|, away from R_ii's sign;   v = (1, A_i / (R_ii - r)),   tau = (r - R_ii) / r
///   (2) each later column (R_ij, A_j):  t = tau (R_ij + v'A_j),   R_ij -= t,  A_j -= t v
///
/// A's last column becomes eta. Returns the product of |R_ii / r|: sqrt(gamma) when B = 1. A zero block changes nothing.
/// Source: Golub, Numer. Math. 7, 1965; Golub & Van Loan, Matrix Computations, 5.1.
template <Real T, int N>
T fold(T const& weight, Square<T, N>& L, Column<T, N>& z, Rows<T>& A) {
    Index const d = z.size(), rows = A.rows();
    for (Index i = 0; i < d; ++i) {
        for (Index j = i; j < d; ++j) L(j, i) *= weight;
        z[i] *= weight;
    }
    T ratio = T(1);
    for (Index i = 0; i < d; ++i) {
        T* const v = A.col(i).data();
        T const a = L(i, i);
        T const size = norm(a, v, rows);
        Truth<T> const nothing = size == T(0);    // below the diagonal
        if (all(nothing)) continue;
        T const r = select(nothing, a, select(a < T(0), size, T(-size)));                                // (1)
        T const tau = select(nothing, T(0), T((r - a) / r)), pivot = select(nothing, T(1), T(a - r));
        run<T, Dynamic>(kernels::Division<T>{rows, v, pivot});
        L(i, i) = r;
        ratio *= select(nothing, T(1), absolute(T(a / r)));
        run<T, Dynamic>(kernels::Reflection<T>{rows, d - i, v, tau, v + rows, L.column(i) + i + 1, &z[i]});    // (2)
    }
    return ratio;
}

}  // namespace rlslab
