// A row that was taken, taken back: in every form that can do it in O(d^2).
#pragma once

#include <rlslab/adapt/time_update.hpp>

namespace rlslab {

/// What the removal of a row did.
///   remaining   alpha^2 = 1 - w psi'P psi, of the P before, w the row's weight: the share of the information along psi that other rows
///               gave. At most 1; <= 0 or NaN: there would be none left, the removal was refused, and no bit of the state has changed
///   noise       the error that the removal itself made, relative to the X after it, in units of u / alpha^2: 1 in a factored form and
///               in the normal equations; 1 / alpha^2 where P is stored, whose psi'P psi has an error of its own
template <Field T>
struct Removal {
    T remaining, noise;
    bool refused() const { return !(T(0) < remaining); }
};

// With alpha^2 = 1 - w psi'P psi and e = y - psi'theta, Remove(psi, y, w) takes back a row of weight w:
//   P += (w / alpha^2) v v', v = P psi       theta -= (w / alpha^2) v e       X -= w psi psi'       (docs/theory.md 59)
// In the covariance forms that is Inflate: definiteness cannot be lost, accuracy can, through alpha^2.

namespace detail {
/// The covariance forms: v and psi'v are at hand, theta and P follow. v may be the form's workspace.
template <class Form, class T, int N>
Removal<T> take_back(Form f, StateVector<T, N> const& v, T const& xi, T const& e, T const& w, bool plain) {
    T const remaining = T(1) - w * xi, by = w / remaining;
    if (!(T(0) < remaining) || !is_finite(by)) return {T(0), T(1)};
    add_scaled(f.theta, T(-(by * e)), v);
    inflate(f, by, Regressor<T>(v.data(), v.size()));
    return {remaining, plain ? T(T(1) / remaining) : T(1)};
}
}  // namespace detail

/// Takes back a row of weight w > 0 that the filter holds: w = lambda^n for a row n steps old. The gain is not touched. Refused where
/// nothing would remain (see Removal). Cost 1.5 d^2 to 3.5 d^2 multiplications; the normal equations solve anew, d^3/6.
template <class T, int N>
Removal<T> remove(PlainCovariance<T, N> f, Regressor<T> psi, T const& y, T const& w) {
    T const e = innovation(y, psi, f.theta);
    multiply(f.P, psi.data(), f.f);
    return detail::take_back(f, f.f, T(dot(psi, f.f)), e, w, true);
}
template <class T, int N>
Removal<T> remove(RootCovariance<T, N, true> f, Regressor<T> psi, T const& y, T const& w) {
    T const e = innovation(y, psi, f.theta);
    multiply_transposed(f.S, psi.data(), f.f);
    T const xi = dot(f.f, f.f);
    for (Index k = 0; k < psi.size(); ++k) {  // f = S f: column k changes what is above f_k alone
        T const x = f.f[k];
        add_scaled(f.f.data(), x, f.S.column(k), k);
        f.f[k] = f.S(k, k) * x;
    }
    return detail::take_back(f, f.f, xi, e, w, false);
}
template <class T, int N>
Removal<T> remove(UdCovariance<T, N> f, Regressor<T> psi, T const& y, T const& w) {
    T const e = innovation(y, psi, f.theta);
    multiply_transposed(f.U, psi.data(), f.f);
    scale(f.D, f.f, f.g);
    T const xi = dot(f.f, f.g);
    for (Index k = 1; k < psi.size(); ++k) add_scaled(f.g.data(), T(f.g[k]), f.U.column(k), k);  // g = U g
    return detail::take_back(f, f.g, xi, e, w, false);
}
/// Potter's update with s_0 = -1/w: S -= v f' / (s - sqrt(r s)), r = -1/w, s = r + f'f < 0.
template <class T, int N>
Removal<T> remove(RootCovariance<T, N, false> f, Regressor<T> psi, T const& y, T const& w) {
    T const e = innovation(y, psi, f.theta);
    multiply_transposed(f.S, psi.data(), f.f);
    T const remaining = T(1) - w * dot(f.f, f.f), by = w / remaining;
    if (!(T(0) < remaining) || !is_finite(by)) return {T(0), T(1)};
    multiply(f.S, f.f.data(), f.g);
    add_scaled(f.theta, T(-(by * e)), f.g);
    divide(f.f, T(-(remaining + square_root(remaining)) / w), f.f);
    subtract_rank_one(f.S, f.g, f.f, DivisorNearOne<T>(T(1)));
    return {remaining, T(1)};
}
/// R'q = sqrt(w) psi, alpha^2 = 1 - q'q; rotations from the last row up turn (alpha, q) into (1, 0) and carry sqrt(w) psi' out of R.
/// Source: Saunders, as LINPACK's dchdd.
template <class T, int N>
Removal<T> remove(RootInformation<T, N> f, Regressor<T> psi, T const& y, T const& w) {
    keep_regressor(psi, f.x);
    Index const d = psi.size();
    T const root = square_root(w);
    scale(f.x, root, f.x);
    solve_lower(f.L, f.x);
    T const remaining = T(1) - dot(f.x, f.x);
    if (!(T(0) < remaining)) return {T(0), T(1)};
    T alpha = square_root(remaining), eta = root * y;
    for (Index i = d - 1; i >= 0; --i) {
        Rotation<T> const turn = givens(alpha, T(f.x[i]));
        alpha = turn.r;
        f.c[i] = turn.c;
        f.s[i] = turn.s;
        f.x[i] = T(0);
        for (Index j = i; j < d; ++j) {
            T const old = f.L(j, i), out = turn.s * f.x[j], in = turn.s * old;
            f.L(j, i) = turn.c * old - out;
            f.x[j] = turn.c * f.x[j] + in;
        }
    }
    for (Index i = 0; i < d; ++i) {
        T const out = f.s[i] * eta;
        f.z[i] = (f.z[i] - out) / f.c[i];
        T const in = f.s[i] * f.z[i];
        eta = f.c[i] * eta - in;
    }
    f.lengths.restart(f.L, f.z);
    return {remaining, T(1)};
}
/// Gentleman's sweep with lambda = 1 and the weight -w.
template <class T, int N>
Removal<T> remove(UnitInformation<T, N> f, Regressor<T> psi, T const& y, T const& w) {
    keep_regressor(psi, f.x, f.c);
    Index const d = psi.size();
    eliminate(f.L, f.c);
    T xi = T(0);
    for (Index i = 0; i < d; ++i) {
        T const square = f.c[i] * f.c[i];
        xi += square / f.D[i];
    }
    T const remaining = T(1) - w * xi;
    if (!(T(0) < remaining)) return {T(0), T(1)};
    T weight = -w, eta = y;
    for (Index i = 0; i < d; ++i) {
        T const x = f.x[i], weighted = weight * x, D = f.D[i] + weighted * x, keep = f.D[i] / D, mix = weighted / D;
        for (Index j = i + 1; j < d; ++j) {
            T const old = f.L(j, i), in = mix * f.x[j], out = x * old;
            f.L(j, i) = keep * old + in;
            f.x[j] -= out;
        }
        T const old = f.z[i], in = mix * eta, out = x * old;
        f.z[i] = keep * old + in;
        eta -= out;
        weight *= keep;
        f.D[i] = D;
    }
    f.lengths.restart(f.L, f.D, f.z);
    return {remaining, T(1)};
}
template <class T, int N>
Removal<T> remove(NormalEquations<T, N> f, Regressor<T> psi, T const& y, T const& w) {
    if (!f.solved) f.solve();
    keep_regressor(psi, f.f);
    solve_lower(f.L, f.f);
    T xi = T(0);
    for (Index i = 0; i < psi.size(); ++i) {
        T const square = f.f[i] * f.f[i];
        xi += square / f.D[i];
    }
    T const remaining = T(1) - w * xi;
    if (!(T(0) < remaining)) return {T(0), T(1)};
    keep_regressor(psi, f.f);
    for (Index j = 0; j < psi.size(); ++j) {
        T const weighted = w * f.f[j];
        for (Index i = 0; i <= j; ++i) {
            T const less = weighted * f.f[i];
            f.X(i, j) -= less;
            if (i != j) f.X(j, i) -= less;
        }
        T const less = weighted * y;
        f.b[j] -= less;
    }
    f.solve();
    return {remaining, T(1)};
}

/// Takes rows back. Not what skips rows or forgets by a rule of its own (`departs`): which weight a row has there nobody knows.
template <class F>
concept Downdates = NamesItsForm<F> && !requires { F::departs; } && requires(F f, Regressor<typename F::scalar> psi, typename F::scalar y) {
    { remove(f.form(), psi, y, y) } -> std::same_as<Removal<typename F::scalar>>;
};

template <Downdates F>
Removal<typename F::scalar> remove(F& f, Regressor<typename F::scalar> psi, typename F::scalar const& y, typename F::scalar const& w) {
    return remove(f.form(), psi, y, w);
}

}  // namespace rlslab
