// From a prior to the state that each family of variants starts with. All functions expect a checked problem and
// outputs that are zero, as StateVector and StateMatrix are when they are made.
#pragma once

#include <rlslab/linalg/forms.hpp>
#include <rlslab/linalg/triangle_of_stored.hpp>

namespace rlslab {

/// theta0 (d); zero without a prior or without a theta in it.
template <Scalar T, int N>
StateVector<T, N> start_theta(Problem<T> const& problem) {
    StateVector<T, N> theta(problem.size);
    if (problem.prior && problem.prior->theta)
        for (Index i = 0; i < theta.size(); ++i) theta[i] = (*problem.prior->theta)[i];
    return theta;
}

/// P0 (d x d), the upper triangle of a full one bit for bit as given, and its mirror image. Throws
/// std::invalid_argument without a prior, or when a full P0 is not positive definite.
template <Scalar T, int N>
StateMatrix<T, N> start_covariance(Problem<T> const& problem) {
    expects(problem.prior.has_value(), "a prior: this variant propagates P and cannot start from no information");
    StateMatrix<T, N> P(problem.size);
    if (auto const& stored = problem.prior->stored) {
        Triangle<T, N> const factor = start_triangle<N>(*problem.prior, true, true);
        outer(factor.F, factor.D, P);
        for (Index j = 0; j < P.size(); ++j)
            for (Index i = 0; i <= j; ++i) {
                P(i, j) = stored->form == Stored<T>::Form::plain && stored->quantity == Stored<T>::Quantity::covariance
                              ? stored->F(i, j)
                              : P(i, j);
                P(j, i) = i == j ? T(real_part(P(i, j))) : conjugate(P(i, j));
            }
        return P;
    }
    if (problem.prior->covariance) {
        StateVector<RealOf<T>, N> D(problem.size);
        expects(all(factor_udu(*problem.prior->covariance, P, D)), "a positive definite prior covariance");
    }
    for (Index j = 0; j < P.size(); ++j)
        if (problem.prior->covariance)
            for (Index i = 0; i <= j; ++i) {
                P(i, j) = (*problem.prior->covariance)(i, j);
                P(j, i) = i == j ? P(i, j) : conjugate(P(i, j));
            }
        else P(j, j) = T(problem.prior->variance);
    return P;
}

/// The same P0 where a symmetric matrix is stored. Of variance I no square is made.
template <Scalar T, int N>
SymmetricStorage<T, N> start_symmetric(Problem<T> const& problem) {
    if (!problem.prior || problem.prior->stored || problem.prior->covariance)
        return SymmetricStorage<T, N>(start_covariance<T, N>(problem));
    SymmetricStorage<T, N> P(problem.size);
    for (Index j = 0; j < P.size(); ++j) P(j, j) = T(problem.prior->variance);
    return P;
}

/// Sets U (unit upper triangular) and D > 0 of P0 = U diag(D) U'. Throws as start_covariance.
template <Scalar T, int N>
void start_ud(Problem<T> const& problem, StateMatrix<T, N>& U, StateVector<RealOf<T>, N>& D) {
    expects(problem.prior.has_value(), "a prior: this variant propagates P and cannot start from no information");
    if (problem.prior->stored) {
        Triangle<T, N> const factor = start_triangle<N>(*problem.prior, true, true);
        U = factor.F;
        D = factor.D;
        return;
    }
    if (problem.prior->covariance) {
        expects(all(factor_udu(*problem.prior->covariance, U, D)), "a positive definite prior covariance");
        return;
    }
    for (Index j = 0; j < D.size(); ++j) {
        U(j, j) = T(1);
        D[j] = problem.prior->variance;
    }
}

/// S of P0 = S S', upper triangular. Throws as start_covariance.
template <RootedScalar T, int N>
StateMatrix<T, N> start_root(Problem<T> const& problem) {
    using std::sqrt;
    if (problem.prior && problem.prior->stored) return start_triangle<N>(*problem.prior, true, false).F;
    StateMatrix<T, N> S(problem.size);
    StateVector<RealOf<T>, N> D(problem.size);
    start_ud(problem, S, D);
    for (Index j = 0; j < D.size(); ++j) {
        RealOf<T> const root = sqrt(D[j]);
        for (Index i = 0; i <= j; ++i) S(i, j) *= root;
    }
    return S;
}

/// Sets L (unit lower triangular) and D of P0^-1 = L diag(D) L': with P0 = U diag(C) U', L = U^-T and D = 1 / C.
/// Without a prior L = I and D = 0. Throws std::invalid_argument when a full P0 is not positive definite.
template <Scalar T, int N>
void start_information(Problem<T> const& problem, StateMatrix<T, N>& L, StateVector<RealOf<T>, N>& D) {
    Index const d = D.size();
    if (!problem.prior) {
        for (Index j = 0; j < d; ++j) L(j, j) = T(1);
        return;
    }
    if (problem.prior->stored) {
        Triangle<T, N> const factor = start_triangle<N>(*problem.prior, false, true);
        L = factor.F;
        D = factor.D;
        return;
    }
    if constexpr (Hardware<T>) {
        if (!problem.prior->covariance) {  // what follows makes of U = I, without d^2 numbers and d^3 / 6 products
            for (Index j = 0; j < d; ++j) {
                D[j] = T(1) / problem.prior->variance;
                L(j, j) = T(1);
                std::fill_n(L.column(j) + j + 1, d - j - 1, -T(0));
            }
            return;
        }
    }
    StateMatrix<T, N> U(d);
    start_ud(problem, U, D);
    for (Index j = 0; j < d; ++j) D[j] = RealOf<T>(1) / D[j];
    // U^-1 U = I gives row j of U^-1, which is column j of L, conjugated.
    for (Index j = 0; j < d; ++j) {
        L(j, j) = T(1);
        for (Index i = j + 1; i < d; ++i) L(i, j) = -conjugate(dot(L.column(j) + j, U.column(i) + j, i - j));
    }
}

/// Sets L (lower triangular) of P0^-1 = L L', and z = L'theta0. Without a prior L = 0 and z = 0. Throws as
/// start_information.
template <RootedScalar T, int N>
void start_information_root(Problem<T> const& problem, StateMatrix<T, N>& L, StateVector<T, N>& z) {
    using std::sqrt;
    StateVector<RealOf<T>, N> D(problem.size);
    if (problem.prior && problem.prior->stored) {
        L = start_triangle<N>(*problem.prior, false, false).F;
    } else {
        start_information(problem, L, D);
        for (Index j = 0; j < D.size(); ++j) {
            RealOf<T> const root = sqrt(D[j]);
            for (Index i = j; i < D.size(); ++i) L(i, j) *= root;
        }
    }
    multiply_lower_transposed(L, start_theta<T, N>(problem), z);
}

// In rlslab::kernels for float and double, so that a file that is compiled with it compiles none of these. That library
// throws: a program without exceptions has texts of its own.
#if defined(RLSLAB_COMPILED_KERNELS) && defined(__cpp_exceptions)
#define RLSLAB_COMPILED_START(T)                                                                 \
    extern template Problem<T> const& checked(Problem<T> const&, int);                           \
    extern template StateVector<T> start_theta(Problem<T> const&);                               \
    extern template StateMatrix<T> start_covariance(Problem<T> const&);                          \
    extern template StateMatrix<T> start_root(Problem<T> const&);                                \
    extern template void start_ud(Problem<T> const&, StateMatrix<T>&, StateVector<T>&);          \
    extern template void start_information(Problem<T> const&, StateMatrix<T>&, StateVector<T>&); \
    extern template void start_information_root(Problem<T> const&, StateMatrix<T>&, StateVector<T>&);
RLSLAB_COMPILED_START(float)
RLSLAB_COMPILED_START(double)
#undef RLSLAB_COMPILED_START
#endif

}  // namespace rlslab
