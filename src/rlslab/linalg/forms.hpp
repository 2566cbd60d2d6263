// The parts of a filter's state by the form it has, for what changes the state apart from an update (adapt/).
#pragma once

#include <rlslab/linalg/finite.hpp>

namespace rlslab {

/// A variant's form() names the members that hold its state, so that a time update, the removal of a row or a reset is
/// written once a form and not once a variant. References: they live as long as the filter, and writing through them
/// writes its state. P in full storage, or the blocks of one triangle.
template <Field T, int N, class Storage = StateMatrix<T, N>>
struct PlainCovariance {
    using scalar = T;
    T& lambda;
    DivisorNearOne<T>& by_lambda;
    StateVector<T, N>&theta, &K, &f;  // f: workspace
    Storage& P;
};
/// P = S S'; `upper`: S is an upper triangle.
template <Real T, int N, bool upper>
struct RootCovariance {
    using scalar = T;
    T& lambda;
    DivisorNearOne<T>& by_root_lambda;
    StateVector<T, N>&theta, &K, &f, &g;  // f, g: workspace
    StateMatrix<T, N>& S;
};
template <Real T, int N>
struct RootCovariance<T, N, true> {
    using scalar = T;
    T& lambda;
    DivisorNearOne<T>& by_root_lambda;
    StateVector<T, N>&theta, &K, &f, &g, &h, &v;  // f, g, h, v: workspace
    StateMatrix<T, N>& S;
};
/// P = U diag(D) U'.
template <Field T, int N>
struct UdCovariance {
    using scalar = T;
    T& lambda;
    DivisorNearOne<T>& by_lambda;
    StateVector<T, N>&theta, &K, &f, &g, &h, &v;  // f, g, h, v: workspace
    StateVector<T, N>& D;
    StateMatrix<T, N>& U;
};
/// P^-1 = L L', z = L'theta.
template <Real T, int N>
struct RootInformation {
    using scalar = T;
    T &lambda, &root_lambda;
    StateVector<T, N>&z, &x, &c, &s, &u;  // x, c, s, u: workspace; u_1 is not finite where c and s are of `rotate_in`
    StateMatrix<T, N>& L;
    ColumnLengths<T, N>& lengths;
};
/// P^-1 = L diag(D) L', L unit lower triangular, z = L'theta.
template <Field T, int N>
struct UnitInformation {
    using scalar = T;
    T& lambda;
    StateVector<T, N>&z, &x, &c, &s, &f, &g;  // x, c, s, f, g: workspace
    StateVector<T, N>& D;
    StateMatrix<T, N>& L;
    ColumnLengths<T, N>& lengths;
};
/// P^-1 = L L', z = L'theta, and the reflections (1, v_i), tau_i of the last row: `qr_block` after update().
template <Field T, int N>
struct LastReflections {
    using scalar = T;
    T &root_lambda, &root_gamma;
    StateVector<T, N>&z, &v, &tau;
    StateMatrix<T, N>& L;
    ColumnLengths<T, N>& lengths;
};
/// P^-1 = X, b = X theta; where `solved`, L, D and theta are those of X and b.
template <Scalar T, int N>
struct NormalEquations {
    using scalar = T;
    RealOf<T>& lambda;
    StateVector<T, N>&theta, &b;
    StateVector<RealOf<T>, N>& D;
    StateVector<T, N>& f;  // workspace
    StateMatrix<T, N>&X, &L;
    Truth<T>&positive, &started;  // X factors; has been seen to factor with pivots above their rounding
    PerLane<T, Index>& rows;      // so far; a prior counts as d
    bool& solved;

    /// Rounding can make a singular X factor; fewer rows than parameters prove that it is.
    void solve() {
        positive = factor_ldl(X, L, D) && Truth<T>(rows >= theta.size());
        if (!all(started)) started = started || (positive && pivots_above_rounding_of(X, D));
        theta = b;
        solve_ldl(L, D, positive, theta);
        solved = true;
    }
};

}  // namespace rlslab
