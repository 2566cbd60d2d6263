// A row that was taken, taken back: in every form that can do it in O(d^2).
#pragma once

#include <rlslab/adapt/time_update.hpp>

namespace rlslab {

/// What the removal of a row did.
///   remaining   alpha^2 = 1 - w psi'P psi, of the P before, w the row's weight: the share of the information along psi
///               that other rows gave, with the error of that P: only such a P says how much remains. At most 1; <= 0
///               or NaN: there would be none left, the removal was refused, and no bit of the state has changed. Of a
///               form of P^-1, which has no prior to fall back on, nothing remains up to rounding_of_a_pivot<T>()
///   noise       the error that the removal itself made, relative to the X after it, in units of u / alpha^2: 1 in a
///               factored form and in the normal equations; where P is stored, whose psi'P psi has an error of its own,
///               the larger of 1 / alpha^2 and w sum psi_i^2 P_ii, since that error may have made alpha^2 large
template <Field T>
struct Removal {
    T remaining, noise;
    bool refused() const { return !(T(0) < remaining); }
};

// With alpha^2 = 1 - w psi'P psi and e = y - psi'theta, Remove(psi, y, w) takes back a row of weight w:
//   P += (w / alpha^2) v v', v = P psi       theta -= (w / alpha^2) v e       X -= w psi psi'       (docs/theory.md 59)
// That is an update without forgetting by a row whose noise has the variance -1/w: s = -1/w + psi'P psi = -alpha^2 / w.
// The triangular forms sweep as in an update; all their s_j are negative, so that every D_j stays positive.

namespace detail {
/// What remains, from s = -1/w + psi'P psi, the last of the running sums of a triangular form. `along` computes psi'P
/// psi anew: where 1/w overflows, a row may be too light to be seen. That is no removal, and alpha^2 is 1.
template <class T>
struct Remainder {
    T remaining, least;
    bool too_light = false;
    template <class Along>
    Remainder(T const& w, T const& s, Along along, T const& nothing = T(0)) : remaining(-(w * s)), least(nothing) {
        if (is_finite(T(T(1) / w))) return;
        too_light = T(1) - w * along() == T(1);
        remaining = T(too_light ? 1 : 0);
    }
    bool refused() const { return !(least < remaining) || !is_finite(T(T(1) / remaining)); }
    Removal<T> reported() const { return {refused() ? T(0) : remaining, T(1)}; }
};
}  // namespace detail

/// Takes back a row of weight w > 0 that the filter holds: w = lambda^n for a row n steps old. The gain is not touched.
/// Refused where nothing would remain (see Removal). Cost 1.5 d^2 to 3 d^2 multiplications; the normal equations solve
/// anew, d^3/6.
template <class T, int N, class Storage>
Removal<T> remove(PlainCovariance<T, N, Storage> f, Regressor<T> psi, T const& y, T const& w) {
    T const e = innovation(y, psi, f.theta);
    multiply(f.P, psi.data(), f.f);
    T const remaining = T(1) - w * dot(psi, f.f), by = w / remaining;
    if (!(T(0) < remaining) || !is_finite(by)) return {T(0), T(1)};
    T summed =
        T(0);  // u times this is the rms error of psi'P psi, whose terms are at most |psi_i psi_j| sqrt(P_ii P_jj)
    for (Index i = 0; i < psi.size(); ++i) summed += psi[i] * psi[i] * f.P(i, i);
    T const seen = T(1) / remaining, hidden = w * summed;
    add_scaled(f.theta, T(-(by * e)), f.f);
    inflate(f, by, Regressor<T>(f.f.data(), psi.size()));
    return {remaining, hidden < seen ? seen : hidden};
}
template <class T, int N>
Removal<T> remove(RootCovariance<T, N, true> f, Regressor<T> psi, T const& y, T const& w) {
    T const e = innovation(y, psi, f.theta);
    multiply_upper_transposed(f.S, psi.data(), f.f);
    T const s = prefix_sums(T(T(-1) / w), f.f, f.f, f.g, f.h);
    detail::Remainder<T> const remainder(w, s, [&] { return dot(f.f, f.f); });
    if (remainder.refused() || remainder.too_light) return remainder.reported();
    divide(f.g, f.h, f.h);
    square_roots(f.h, f.h);
    divide(f.f, f.g, f.g);
    scale(f.g, f.h, f.g);
    NoPerturbation none;
    sweep_carlson(f.S, f.f, f.h, f.g, DivisorNearOne<T>(T(1)), f.v, none);
    add_scaled(f.theta, T(e / s), f.v);
    return remainder.reported();
}
template <class T, int N>
Removal<T> remove(UdCovariance<T, N> f, Regressor<T> psi, T const& y, T const& w) {
    T const e = innovation(y, psi, f.theta);
    multiply_upper_transposed(f.U, psi.data(), f.f);
    scale(f.D, f.f, f.g);
    T const s = prefix_sums(T(T(-1) / w), f.f, f.g, f.h, f.v);
    detail::Remainder<T> const remainder(w, s, [&] { return dot(f.f, f.g); });
    if (remainder.refused() || remainder.too_light) return remainder.reported();
    divide(f.f, f.h, f.f);
    divide(f.h, f.v, f.h);
    scale(f.D, f.h, f.D);
    NoPerturbation none;
    sweep_ud(f.U, f.g, f.f, f.v, none);
    add_scaled(f.theta, T(e / s), f.v);
    return remainder.reported();
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
/// R'q = sqrt(w) psi, alpha^2 = 1 - q'q; rotations from the last row up turn (alpha, q) into (1, 0) and carry sqrt(w)
/// psi' out of R. What they turn alpha into on the way is the root of a sum of squares, so that all of them are known
/// before R is touched. Source: Saunders, as LINPACK's dchdd.
template <class T, int N>
Removal<T> remove(RootInformation<T, N> f, Regressor<T> psi, T const& y, T const& w) {
    keep_regressor(psi, f.x);
    Index const d = psi.size();
    T const root = square_root(w);
    scale(f.x, root, f.x);
    solve_lower(f.L, f.x);
    T const remaining = T(1) - dot(f.x, f.x);
    if (!(T(rounding_of_a_pivot<T>()) < remaining)) return {T(0), T(1)};
    T sum = remaining;
    for (Index i = d - 1; i >= 0; --i) {
        T const square = f.x[i] * f.x[i];
        f.c[i] = sum;
        f.s[i] = sum += square;
    }
    square_roots(f.c, f.c);
    square_roots(f.s, f.s);
    divide(f.c, f.s, f.c);
    divide(f.x, f.s, f.s);
    rotate_out(f.L, f.c, f.s);
    T eta = root * y;
    for (Index i = 0; i < d; ++i) {
        T const out = f.s[i] * eta, by_c = T(1) / f.c[i];  // no division between one eta and the next
        f.z[i] = (f.z[i] - out) * by_c;
        T const in = f.s[i] * f.z[i];
        eta = f.c[i] * eta - in;
    }
    f.lengths.remove_row(w, psi, y);
    return {remaining, T(1)};
}
/// Gentleman's sweep with lambda = 1 and the weight -w: 1/w_{i+1} = 1/w_i + x_i^2 / D_i from -1/w on, all negative, and
/// D_i w_i / w_{i+1} for D_i.
template <class T, int N>
Removal<T> remove(UnitInformation<T, N> f, Regressor<T> psi, T const& y, T const& w) {
    keep_regressor(psi, f.x, f.c);
    Index const d = psi.size();
    eliminate(f.L, f.c);
    scale(f.c, f.c, f.s);
    divide(f.s, f.D, f.s);
    T const inverse = prefix_sums(T(T(-1) / w), f.s, f.f, f.g);
    detail::Remainder<T> const remainder(
        w, inverse, [&] { return f.s.view().sum(); }, T(rounding_of_a_pivot<T>()));
    if (remainder.refused() || remainder.too_light) return remainder.reported();
    divide(f.c, f.f, f.s);
    divide(f.f, f.g, f.f);
    divide(f.D, f.f, f.D);
    divide(f.s, f.D, f.s);
    sweep_gentleman(f.L, f.f, f.s, f.c, f.x);
    T eta = y;
    for (Index i = 0; i < d; ++i) {
        T const old = f.z[i], in = f.s[i] * eta, out = f.c[i] * old;
        f.z[i] = f.f[i] * old + in;
        eta -= out;
    }
    f.lengths.remove_row(w, psi, y);
    return remainder.reported();
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
    if (!(T(rounding_of_a_pivot<T>()) < remaining)) return {T(0), T(1)};
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

/// Takes rows back. Not what skips rows or forgets by a rule of its own (`departs`): which weight a row has there
/// nobody knows.
template <class F>
concept Downdates = NamesItsForm<F> && !requires { F::departs; } &&
                    requires(F f, Regressor<typename F::scalar> psi, typename F::scalar y) {
                        { remove(f.form(), psi, y, y) } -> std::same_as<Removal<typename F::scalar>>;
                    };

template <Downdates F>
Removal<typename F::scalar> remove(F& f, Regressor<typename F::scalar> psi, typename F::scalar const& y,
                                   typename F::scalar const& w) {
    return remove(f.form(), psi, y, w);
}

}  // namespace rlslab
