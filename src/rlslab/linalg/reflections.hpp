// Householder reflections that fold a block of rows into a triangle. Sizes are not checked.
#pragma once

#include <rlslab/linalg/kernels.hpp>
#include <rlslab/linalg/reflector.hpp>

#include <cstdint>

namespace rlslab {

namespace detail {
/// x^n by repeated squaring, n >= 0: for x = lambda the weight of a row that is n steps old.
template <Field T>
T power(T x, Index n) {
    T out = T(1);
    for (; n > 0; n /= 2, x *= x)
        if (n % 2 == 1) out *= x;
    return out;
}
/// A hint: the next block, where it lies behind this one in memory, is in cache after the reflections. Any address is
/// allowed.
inline void prefetch(std::uintptr_t address) { __builtin_prefetch(reinterpret_cast<void const*>(address)); }
}  // namespace detail

/// A (B x (d + 1)) becomes the rows [psi_k' y_k] root^(B-1-k), k = 0 ... B-1, the oldest first: psi is d x B, y has B
/// numbers, and root is sqrt(lambda). Returns root^B, the weight of what was before the block. Allocates if A has
/// another shape.
template <Scalar T>
RealOf<T> weighted_rows(Eigen::Ref<Matrix<T> const> const& psi, Eigen::Ref<Vector<T> const> const& y,
                        RealOf<T> const& root, Matrix<T>& A) {
    Index const d = psi.rows();
    A.resize(y.size(), d + 1);
    RealOf<T> weight = RealOf<T>(1);
    // In hardware eight rows at once: they fill a cache line of a column, and columns lie a power of two apart.
    // Elsewhere one by one, as random bits are drawn.
    constexpr Index together = Hardware<T> ? 8 : 1;
    for (Index end = y.size(); end > 0;) {
        Index const first = std::max(end - together, Index(0));
        RealOf<T> weights[together];
        for (Index k = end - 1; k > first; --k) {
            weights[k - first] = weight;
            weight *= root;
        }
        weights[0] = weight;
        T const* from = psi.col(first).data();
        T* to = A.data() + first;
        Index const stride = psi.outerStride(), rows = A.rows();
        for (Index i = 0; i < d; ++i, ++from, to += rows) {
            if constexpr (Hardware<T>)
                if (i % 8 == 0)
                    for (Index k = 0; k < end - first; ++k)
                        detail::prefetch(std::uintptr_t(from) + size_t((k + rows) * stride) * sizeof(T));
            if (end - first == together) {
#pragma GCC unroll 8
                for (Index k = 0; k < together; ++k) to[k] = weights[k] * from[k * stride];
            } else {
                for (Index k = 0; k < end - first; ++k) to[k] = weights[k] * from[k * stride];
            }
        }
        for (Index k = first; k < end; ++k) A(k, d) = weights[k - first] * y[k];
        weight *= root;
        end = first;
    }
    return weight;
}

/// Folds the B x (d + 1) block A = [psi' y] into weight [R z], R = L', one reflection for each column i:
///
///   (1) r = +-|(R_ii, A_i)|, away from R_ii's sign;   v = (1, A_i / (R_ii - r)),   tau = (r - R_ii) / r
///   (2) each later column (R_ij, A_j):  t = tau (R_ij + v'A_j),   R_ij -= t,  A_j -= t v
///
/// A is overwritten: its first d columns by the v, its last by eta. Returns the product of |R_ii / r|, which is
/// sqrt(gamma) for B = 1. A column of zeros is skipped.
/// Source: Golub 1965; Golub & Van Loan 2013, 5.1.
template <Real T, int N>
T reflect_block_into(T const& weight, StateMatrix<T, N>& L, StateVector<T, N>& z, Matrix<T>& A) {
    Index const d = z.size(), rows = A.rows();
    for (Index i = 0; i < d; ++i) {
        for (Index j = i; j < d; ++j) L(j, i) *= weight;
        z[i] *= weight;
    }
    T ratio = T(1);
    // In hardware eight reflections go over the columns that follow in one pass: these are read and written once for
    // all of them. A panel is the columns of the eight. Elsewhere all columns are one panel, and what is last in its
    // rows is z.
    constexpr Index together = 8;
    [[maybe_unused]] std::conditional_t<Hardware<T>, T, char> tau[together];
    for (Index first = 0; first < d; first += together) {
        Index const next = Hardware<T> ? std::min(first + together, d) : d;
        for (Index i = first; i < next; ++i) {
            T* const v = A.col(i).data();
            T const a = L(i, i);
            T squares = T(0);
            run_kernel<T, Dynamic>(kernels::SumOfSquares<T>{rows, v, &squares});
            Reflector<T> const turn(a, norm(a, squares, v, rows));  // (1)
            if constexpr (Hardware<T>) tau[i - first] = turn.tau;
            if (all(turn.tau == T(0))) continue;
            run_kernel<T, Dynamic>(kernels::Division<T>{rows, v, turn.pivot});
            L(i, i) = turn.r;
            ratio *= turn.cosine(a);
            Index const columns = Hardware<T> ? next - 1 - i : d - i;
            T* const last = Hardware<T> ? &L(next - 1, i) : &z[i];
            if (columns > 0)
                run_kernel<T, Dynamic>(
                    kernels::Reflection<T>{rows, columns, v, turn.tau, v + rows, L.column(i) + i + 1, last});  // (2)
        }
        if constexpr (!Hardware<T>) break;
        else
            run_kernel<T, Dynamic>(kernels::Reflections<T>{rows, d + 1 - next, next - first, A.col(first).data(), tau,
                                                           A.col(next).data(), L.column(first) + next, L.stride(),
                                                           &z[first]});
    }
    return ratio;
}

/// The same for complex numbers. A holds psi as it came, and L is R': both are the rows conjugated. z and y are
/// conjugated for the time that this takes.
template <RootedScalar T, int N>
    requires ComplexScalar<T>
RealOf<T> reflect_block_into(RealOf<T> const& weight, StateMatrix<T, N>& L, StateVector<T, N>& z, Matrix<T>& A) {
    using R = RealOf<T>;
    Index const d = z.size(), rows = A.rows();
    auto const exchange = [&] {
        for (Index i = 0; i < d; ++i) z[i] = conjugate(z[i]);
        for (Index k = 0; k < rows; ++k) A(k, d) = conjugate(A(k, d));
    };
    for (Index i = 0; i < d; ++i) {
        for (Index j = i; j < d; ++j) L(j, i) *= weight;
        z[i] *= weight;
    }
    exchange();
    R ratio = R(1);
    for (Index i = 0; i < d; ++i) {
        T* const v = A.col(i).data();
        R const a = real_part(L(i, i)), squares = real_part(dot(v, v, rows));
        Reflector<R> const turn(a, norm(a, squares, v, rows));  // (1)
        if (all(turn.tau == R(0))) continue;
        for (Index k = 0; k < rows; ++k) v[k] /= turn.pivot;
        L(i, i) = T(turn.r);
        ratio *= turn.cosine(a);
        for (Index j = i + 1; j <= d; ++j) {  // (2)
            T& above = j < d ? L(j, i) : z[i];
            T const t = turn.tau * (above + dot(v, A.col(j).data(), rows));
            above -= t;
            for (Index k = 0; k < rows; ++k) A(k, j) -= t * v[k];
        }
    }
    exchange();
    return ratio;
}

/// The same for the one row [x' eta], going along the rows of R. x becomes the v_i, tau the tau_i, eta the reflected
/// output. Returns sqrt(gamma). x, z and tau have d numbers and differ.
template <RootedScalar T, int N>
RealOf<T> reflect_row_into(RealOf<T> const& weight, StateMatrix<T, N>& L, StateVector<T, N>& z, StateVector<T, N>& x,
                           T& eta, StateVector<RealOf<T>, N>& tau) {
    RealOf<T> ratio = RealOf<T>(1);
    run_kernel<T, N>(
        kernels::ReflectIn<T>{z.size(), L.stride(), L.column(0), x.data(), z.data(), &eta, tau.data(), &ratio, weight});
    return ratio;
}

}  // namespace rlslab
