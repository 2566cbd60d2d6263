// Triangular factors: the factorisations a filter starts from, and the solves of the information forms.
//
// An upper triangular R is stored as L = R', so that row i of R is column i of L and contiguous. Sizes are d and d x d
// throughout and are not checked; nothing throws. A zero pivot gives infinities or NaN by IEEE division.
#pragma once

#include <rlslab/linalg/kernels.hpp>

#include <algorithm>

namespace rlslab {

/// Sets U (unit upper triangular) and D of X = U diag(D) U', columns from the last to the first. Reads X's upper
/// triangle; leaves what is below U's diagonal. Returns false when a pivot D_j is not positive: the factors then have
/// no meaning. Cost d^3/6 multiplications.
template <Scalar T, int N>
Truth<T> factor_udu(std::type_identity_t<Matrix<T, N>> X, StateMatrix<T, N>& U, StateVector<RealOf<T>, N>& D) {
    Truth<T> positive = true;
    for (Index j = D.size() - 1; j >= 0; --j) {
        D[j] = real_part(X(j, j));
        positive = positive && RealOf<T>(0) < D[j];
        U(j, j) = T(1);
        for (Index i = 0; i < j; ++i) U(i, j) = X(i, j) / D[j];
        for (Index k = 0; k < j; ++k)
            for (Index i = 0; i <= k; ++i) X(i, k) -= U(i, j) * conjugate(X(k, j));
    }
    return positive;
}

/// Sets L (unit lower triangular) and D of X = L diag(D) L' (Cholesky without roots). Reads X's lower triangle; leaves
/// what is above L's diagonal. L may be X. Returns false when a pivot D_j is not positive: the factors then have no
/// meaning. Cost d^3/6 multiplications.
template <Scalar T, int N, class Storage>
Truth<T> factor_ldl(Storage const& X, StateMatrix<T, N>& L, StateVector<RealOf<T>, N>& D) {
    Index const d = D.size();
    Truth<T> positive = true;
    for (Index j = 0; j < d; ++j)
        for (Index i = j; i < d; ++i) L(i, j) = X(i, j);
    for (Index j = 0; j < d; ++j) {
        D[j] = real_part(L(j, j));
        positive = positive && RealOf<T>(0) < D[j];
        L(j, j) = T(1);
        for (Index k = j + 1; k < d; ++k) {
            T const m = L(k, j) / D[j];
            add_scaled(L.column(k) + k, T(-conjugate(m)), L.column(j) + k, d - k);
            L(k, j) = m;
        }
    }
    return positive;
}

namespace detail {
/// |x|; of a complex number the larger of its parts.
template <Scalar T>
RealOf<T> magnitude(T const& x) {
    if constexpr (ComplexScalar<T>) {
        RealOf<T> const re = absolute(x.re), im = absolute(x.im);
        return select(re < im, im, re);
    } else return absolute(x);
}
}  // namespace detail

/// Whether the triangular L, or a diagonal, has no zero on its diagonal; a NaN there counts as nonzero.
template <Scalar T, int N>
Truth<T> nonsingular(StateMatrix<T, N> const& L) {
    Truth<T> out = true;
    for (Index i = 0; i < L.size(); ++i) out = out && !(L(i, i) == T(0));
    return out;
}
template <Field T, int N>
Truth<T> nonsingular(StateVector<T, N> const& D) {
    Truth<T> out = true;
    for (Index i = 0; i < D.size(); ++i) out = out && !(D[i] == T(0));
    return out;
}

/// What a pivot of R has to exceed to stand above its own rounding, in units of the largest number of its column:
///
///   |R_jj| > 2^min(p/4, 10) u max_i |R_ij|,   u = 2^-p
///
/// A column that depends on those before it leaves no zero: each row adds a rounding of u |psi_j| or so, n rows one of
/// sqrt(n/6) u of the column's length, n u / 15 where they repeat. The factor holds these down for 10 000 rows in
/// double and 500 in float (tests/linalg/pivots.cpp). It costs a quarter of the digits at most: below the bound theta_j
/// has no more than these. No unit of a parameter or of y changes the answer. Zero where no error is relative, in the
/// rationals and in fixed point: there exact zeros decide.
template <Scalar T>
double rounding_of_a_pivot() {
    using Traits = ArithmeticTraits<RealOf<T>>;
    if constexpr (!RootedScalar<T>) return 0;
    else if constexpr (Traits::min_exp + Traits::digits >= 0) return 0;
    else {
        int const p = significand_bits<RealOf<T>>();
        return std::ldexp(1.0, std::min(p / 4, 10) - p);
    }
}
/// Whether every pivot does: R = L', or R = diag(sqrt(D)) L' with L unit lower triangular. A NaN, or an infinity above
/// a pivot, counts as if it did: the step then says nonfinite. d^2/2 comparisons, which are no part of the algorithm.
template <Scalar T, int N>
[[gnu::noinline]] Truth<T> pivots_above_rounding(StateMatrix<T, N> const& L) {
    UncountedScope<T> const uncounted;
    RealOf<T> const share = RealOf<T>(rounding_of_a_pivot<T>());
    Truth<T> out = true;
    for (Index j = 0; j < L.size(); ++j) {
        RealOf<T> largest(0);
        for (Index i = 0; i < j; ++i) {
            RealOf<T> const size = detail::magnitude(L(j, i));
            largest = select(largest < size, size, largest);
        }
        out = out && (!(detail::magnitude(L(j, j)) <= share * largest) || !is_finite(largest));
    }
    return out;
}
template <Scalar T, int N>
[[gnu::noinline]] Truth<T> pivots_above_rounding(StateMatrix<T, N> const& L, StateVector<RealOf<T>, N> const& D) {
    UncountedScope<T> const uncounted;
    RealOf<T> const share = RealOf<T>(rounding_of_a_pivot<T>());
    Truth<T> out = true;
    for (Index j = 0; j < L.size(); ++j) {
        RealOf<T> largest(0);
        for (Index i = 0; i < j; ++i) {
            RealOf<T> const of_root = share * detail::magnitude(L(j, i)), size = of_root * D[i] * of_root;
            largest = select(largest < size, size, largest);
        }
        out = out && (!(D[j] <= largest) || !is_finite(largest));
    }
    return out;
}

/// The same of X = L diag(D) L', whose diagonal is the squares of R's columns: D_j > 2^min(p/4, 10) u X_jj.
template <Scalar T, int N>
Truth<T> pivots_above_rounding_of(StateMatrix<T, N> const& X, StateVector<RealOf<T>, N> const& D) {
    UncountedScope<T> const uncounted;
    RealOf<T> const share = RealOf<T>(rounding_of_a_pivot<T>());
    Truth<T> out = true;
    for (Index j = 0; j < D.size(); ++j) out = out && !(D[j] <= share * real_part(X(j, j)));
    return out;
}

/// x = L^-1 x in place, L lower triangular with a real diagonal, d^2/2 multiplications.
template <Scalar T, int N, class X>
void solve_lower(StateMatrix<T, N> const& L, X& x) {
    Index const d = x.size();
    for (Index i = 0; i < d; ++i) {
        x[i] /= real_part(L(i, i));
        add_scaled(x.data() + i + 1, -x[i], L.column(i) + i + 1, d - i - 1);
    }
}

template <Field T, int N>
void solve_lower(StateMatrix<T, N> const& L, StateVector<T, N>& x) {
    run_kernel<T, N>(kernels::SolveLower<T>{{L.size(), L.stride(), L.column(0), x.data()}});
}

/// x = L^-T x in place, L lower triangular with a real diagonal, d^2/2 multiplications. Complex numbers: the inverse of
/// L', conjugated.
template <Scalar T, int N, class X>
void solve_lower_transposed(StateMatrix<T, N> const& L, X& x) {
    Index const d = x.size();
    for (Index i = d - 1; i >= 0; --i) {
        if (i + 1 < d) x[i] -= dot(L.column(i) + i + 1, x.data() + i + 1, d - i - 1);
        x[i] /= real_part(L(i, i));
    }
}

/// x = (L diag(D) L')^-1 x in place. In the lanes where `positive` is false the result is NaN.
template <Scalar T, int N>
void solve_ldl(StateMatrix<T, N> const& L, StateVector<RealOf<T>, N> const& D, Truth<T> const& positive,
               StateVector<T, N>& x) {
    solve_lower(L, x);
    for (Index i = 0; i < x.size(); ++i)
        x[i] = select(positive, T(x[i] / select(positive, D[i], RealOf<T>(1))), undefined<T>());
    solve_lower_transposed(L, x);
}

/// out = L'x, L lower triangular. out must not be x.
template <Scalar T, int N>
void multiply_lower_transposed(StateMatrix<T, N> const& L, StateVector<T, N> const& x, StateVector<T, N>& out) {
    Index const d = x.size();
    for (Index i = 0; i < d; ++i) out[i] = dot(L.column(i) + i, x.data() + i, d - i);
}

/// L^-T b, L lower triangular.
template <Scalar T, int N>
Vector<T, N> solved_lower_transposed(StateMatrix<T, N> const& L, StateVector<T, N> const& b) {
    Vector<T, N> x = b.view();
    solve_lower_transposed(L, x);
    return x;
}

/// x = (L L')^-1 x, and x = (L diag(D) L')^-1 x, in place; d^2 multiplications.
template <Scalar T, int N, class X>
void solve_outer(StateMatrix<T, N> const& L, X& x) {
    solve_lower(L, x);
    solve_lower_transposed(L, x);
}
template <Scalar T, int N, class X>
void solve_outer(StateMatrix<T, N> const& L, StateVector<RealOf<T>, N> const& D, X& x) {
    solve_lower(L, x);
    for (Index i = 0; i < x.size(); ++i) x[i] /= D[i];
    solve_lower_transposed(L, x);
}
/// (L L')^-1 b, and (L diag(D) L')^-1 b.
template <Scalar T, int N>
Vector<T, N> solved_outer(StateMatrix<T, N> const& L, StateVector<T, N> const& b) {
    Vector<T, N> x = b.view();
    solve_outer(L, x);
    return x;
}
template <Scalar T, int N>
Vector<T, N> solved_outer(StateMatrix<T, N> const& L, StateVector<RealOf<T>, N> const& D, StateVector<T, N> const& b) {
    Vector<T, N> x = b.view();
    solve_outer(L, D, x);
    return x;
}

/// A A' and A diag(D) A', for any square A; d^3 multiplications. They allocate if N is Dynamic.
template <Scalar T, int N>
Matrix<T, N> outer(StateMatrix<T, N> const& A) {
    StateMatrix<T, N> out(A.size());
    multiply_by_transposed(A, A, out);
    return out.view();
}
template <Scalar T, int N>
void outer(StateMatrix<T, N> const& A, StateVector<RealOf<T>, N> const& D, StateMatrix<T, N>& out) {
    StateMatrix<T, N> AD = A;
    for (Index j = 0; j < D.size(); ++j)
        for (Index i = 0; i < D.size(); ++i) AD(i, j) *= D[j];
    multiply_by_transposed(AD, A, out);
}
template <Scalar T, int N>
Matrix<T, N> outer(StateMatrix<T, N> const& A, StateVector<RealOf<T>, N> const& D) {
    StateMatrix<T, N> out(A.size());
    outer(A, D, out);
    return out.view();
}

}  // namespace rlslab
