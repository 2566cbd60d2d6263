// Time apart from rows: what a controller of forgetting does to a filter between updates, in every form that can do it
// in O(d^2).
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/forms.hpp>
#include <rlslab/linalg/rotations.hpp>

namespace rlslab {

// With P^-1 = X: Discount(lambda)   X -> lambda X                theta as it is
//                Inflate(c, a)      P -> P + c a a'               theta as it is
//                Reset(k, theta)    P -> k I                      theta as given
// and an update is Discount(lambda), then one row. Formulas: docs/theory.md 55 and 56.

// --- lambda of the updates to come -----------------------------------------------------------------------------------

/// lambda of the updates to come, as if the filter had been made with it: the same lambda leaves the same bits. 0 <
/// lambda <= 1, not checked. Cost O(1), one square root where the form has one.
template <class Form>
    requires requires(Form f) { f.lambda; }
void set_forgetting(Form f, typename Form::scalar const& lambda) {
    f.lambda = lambda;
    if constexpr (requires { f.by_lambda; }) f.by_lambda = DivisorNearOne<typename Form::scalar>(lambda);
    else if constexpr (requires { f.by_root_lambda; })
        f.by_root_lambda = DivisorNearOne<typename Form::scalar>(square_root(lambda));
    else if constexpr (requires { f.root_lambda; }) f.root_lambda = square_root(lambda);
}

// --- discount --------------------------------------------------------------------------------------------------------

namespace detail {
/// Rows from first(j) to d of every column j.
template <class T, int N, class Change>
void each_entry(StateMatrix<T, N>& A, bool upper, Change change) {
    for (Index j = 0; j < A.size(); ++j)
        for (Index i = 0; i < (upper ? j + 1 : A.size()); ++i) A(i, j) = change(A(i, j));
}
template <class T, int N, class Change>
void each_entry(SymmetricMatrix<T, N>& A, bool, Change change) {
    for (T& x : A.stored()) x = change(x);
}
}  // namespace detail

/// P / lambda without a row; a theta that is stored keeps its bits, one that is solved for moves by rounding alone (not
/// at all where sqrt(lambda) is a power of two). Any lambda in (0, 1]: n ticks without data are discount(lambda^n). Not
/// checked. Cost d^2 multiplications at most; d where the form has a diagonal of its own (ud; gentleman: and d^2/2 for
/// its bounds).
template <class T, int N, class Storage>
void discount(PlainCovariance<T, N, Storage> f, T const& lambda) {
    DivisorNearOne<T> const by(lambda);
    detail::each_entry(f.P, false, [&](T const& x) { return by(x); });
}
template <class T, int N, bool upper>
void discount(RootCovariance<T, N, upper> f, T const& lambda) {
    DivisorNearOne<T> const by(square_root(lambda));
    detail::each_entry(f.S, upper, [&](T const& x) { return by(x); });
}
template <class T, int N>
void discount(UdCovariance<T, N> f, T const& lambda) {
    divide(f.D, DivisorNearOne<T>(lambda), f.D);
}
template <class T, int N>
void discount(RootInformation<T, N> f, T const& lambda) {
    T const root = square_root(lambda);
    for (Index i = 0; i < f.z.size(); ++i)
        for (Index j = i; j < f.z.size(); ++j) f.L(j, i) *= root;
    scale(f.z, root, f.z);
    f.lengths.restart(f.L, f.z);
}
template <class T, int N>
void discount(UnitInformation<T, N> f, T const& lambda) {
    scale(f.D, lambda, f.D);
    f.lengths.restart(f.L, f.D, f.z);
}
template <class T, int N>
void discount(NormalEquations<T, N> f, T const& lambda) {
    detail::each_entry(f.X, false, [&](T const& x) { return T(x * lambda); });
    scale(f.b, lambda, f.b);
    scale(f.D, lambda, f.D);
}

// --- inflate ---------------------------------------------------------------------------------------------------------

/// P += c a a', c >= 0, theta as it is; c = 0 changes no bit. `a` may be the filter's gain. c < 0 or not finite is not
/// checked: it may leave an indefinite P. Cost d^2/2 to 2.5 d^2 multiplications. ud: Agee & Turner 1972; the
/// information forms: the dual, derived.
template <class T, int N, class Storage>
void inflate(PlainCovariance<T, N, Storage> f, T const& c, Regressor<T> a) {
    keep_regressor(a, f.f);
    if constexpr (Real<T>) {  // one product for both triangles: symmetric stays symmetric
        scale(f.f, square_root(c), f.f);
        add_square(f.P, f.f);
    } else {
        for (Index j = 0; j < a.size(); ++j)
            for (Index i = 0; i < a.size(); ++i) f.P(i, j) += c * f.f[i] * f.f[j];
    }
}
template <class T, int N>
void inflate(RootCovariance<T, N, true> f, T const& c, Regressor<T> a) {
    keep_regressor(a, f.f);
    scale(f.f, square_root(c), f.f);
    for (Index j = a.size() - 1; j >= 0; --j) {
        Rotation<T> const turn = givens(f.S(j, j), f.f[j]);
        f.S(j, j) = turn.r;
        for (Index i = 0; i < j; ++i) {
            T const old = f.S(i, j), turned = turn.s * f.f[i], back = turn.s * old;
            f.S(i, j) = turn.c * old + turned;
            f.f[i] = turn.c * f.f[i] - back;
        }
    }
}
template <class T, int N>
void inflate(UdCovariance<T, N> f, T const& c, Regressor<T> a) {
    keep_regressor(a, f.f);
    T left = c;
    for (Index j = a.size() - 1; j >= 0; --j) {
        T const weighted = left * f.f[j], product = weighted * f.f[j], D = f.D[j] + product;
        Truth<T> const nothing = product == T(0);  // D may be zero, too
        T const by = select(nothing, T(1), D), gain = select(nothing, T(0), T(weighted / by));
        for (Index i = 0; i < j; ++i) {
            T const out = f.f[j] * f.U(i, j);
            f.f[i] -= out;
            T const in = gain * f.f[i];
            f.U(i, j) += in;
        }
        left = select(nothing, left, T(left * (f.D[j] / by)));
        f.D[j] = D;
    }
}
/// (1/sqrt(c) | 0' | 0) above [R z], and rotations from the last row up that carry -R a into its lead.
template <class T, int N>
void inflate(RootInformation<T, N> f, T const& c, Regressor<T> a) {
    keep_regressor(a, f.x);
    if (all(c == T(0))) return;
    Index const d = a.size();
    multiply_lower_transposed(f.L, f.x, f.c);
    for (Index i = 0; i < d; ++i) f.x[i] = T(0);
    T lead = T(1) / square_root(c), eta = T(0);
    for (Index i = d - 1; i >= 0; --i) {
        Rotation<T> const turn = givens(lead, T(-f.c[i]));
        lead = turn.r;
        for (Index j = i; j < d; ++j) {
            T const old = f.L(j, i), out = turn.s * f.x[j], in = turn.s * old;
            f.L(j, i) = turn.c * old - out;
            f.x[j] = turn.c * f.x[j] + in;
        }
        T const old = f.z[i], out = turn.s * eta, in = turn.s * old;
        f.z[i] = turn.c * old - out;
        eta = turn.c * eta + in;
    }
    f.lengths.restart(f.L, f.z);
}
template <class T, int N>
void inflate(UnitInformation<T, N> f, T const& c, Regressor<T> a) {
    keep_regressor(a, f.x);
    if (all(c == T(0))) return;
    Index const d = a.size();
    multiply_lower_transposed(f.L, f.x, f.c);
    for (Index i = 0; i < d; ++i) f.x[i] = T(0);
    T w = T(1) / c, eta = T(0);
    for (Index i = d - 1; i >= 0; --i) {
        T const g = -f.c[i], weighted = f.D[i] * g, sum = w + weighted * g, keep = w / sum, mix = weighted / sum;
        for (Index j = i; j < d; ++j) {
            T const old = f.L(j, i), out = g * f.x[j], in = mix * old;
            if (j != i) f.L(j, i) = old - out;  // the unit diagonal: x_i is 0 here
            f.x[j] = keep * f.x[j] + in;
        }
        T const old = f.z[i], out = g * eta, in = mix * old;
        f.z[i] = old - out;
        eta = keep * eta + in;
        f.D[i] *= keep;
        w = sum;
    }
    f.lengths.restart(f.L, f.D, f.z);
}
template <class T, int N>
void inflate(NormalEquations<T, N> f, T const& c, Regressor<T> a) {
    keep_regressor(a, f.f);
    if (all(c == T(0))) return;
    StateVector<T, N>& x = f.D;  // solved for anew
    multiply(f.X, f.f.data(), x);
    T const t = T(1) / c + dot(f.f, x), moved = dot(f.f, f.b) / t;
    for (Index j = 0; j < x.size(); ++j) {
        for (Index i = 0; i <= j; ++i) {
            T const less = x[i] * x[j] / t;
            f.X(i, j) -= less;
            if (i != j) f.X(j, i) -= less;
        }
        T const less = x[j] * moved;
        f.b[j] -= less;
    }
    f.solve();
}

// --- reset -----------------------------------------------------------------------------------------------------------

namespace detail {
template <class T, class Storage>
void set_identity(Storage& A, T const& scale) {
    for (Index j = 0; j < A.size(); ++j)
        for (Index i = 0; i < A.size(); ++i) A(i, j) = i == j ? scale : T(0);
}
template <class T, int N>
void fill(StateVector<T, N>& x, T const& value) {
    for (Index i = 0; i < x.size(); ++i) x[i] = value;
}
/// 1/by, what a prior of this variance tells; 0 for variance 0.
template <class T>
T told_by(T const& variance, T const& by) {
    return select(variance == T(0), T(0), T(T(1) / by));
}
}  // namespace detail

/// P = variance I and theta as given, which may be the filter's own: kept bit for bit where it is stored. variance 0,
/// in a form of P^-1: no prior, as where the filter was made without one. Cost d^2 assignments. Source: Goodwin,
/// Elliott & Teoh 1983.
template <class T, int N, class Storage>
void reset(PlainCovariance<T, N, Storage> f, T const& variance, Regressor<T> theta) {
    keep_regressor(theta, f.theta);
    detail::set_identity(f.P, variance);
}
template <class T, int N, bool upper>
void reset(RootCovariance<T, N, upper> f, T const& variance, Regressor<T> theta) {
    keep_regressor(theta, f.theta);
    detail::set_identity(f.S, square_root(variance));
}
template <class T, int N>
void reset(UdCovariance<T, N> f, T const& variance, Regressor<T> theta) {
    keep_regressor(theta, f.theta);
    detail::set_identity(f.U, T(1));
    detail::fill(f.D, variance);
}
template <class T, int N>
void reset(RootInformation<T, N> f, T const& variance, Regressor<T> theta) {
    keep_regressor(theta, f.z);
    T const root = detail::told_by(variance, square_root(variance));
    detail::set_identity(f.L, root);
    scale(f.z, root, f.z);
    f.lengths.start(f.L, f.z);
}
template <class T, int N>
void reset(UnitInformation<T, N> f, T const& variance, Regressor<T> theta) {
    keep_regressor(theta, f.z);
    detail::set_identity(f.L, T(1));
    detail::fill(f.D, detail::told_by(variance, variance));
    f.lengths.start(f.L, f.D, f.z);
}
template <class T, int N>
void reset(NormalEquations<T, N> f, T const& variance, Regressor<T> theta) {
    keep_regressor(theta, f.theta, f.b);
    T const told = detail::told_by(variance, variance);
    detail::set_identity(f.X, told);
    detail::set_identity(f.L, T(1));
    detail::fill(f.D, told);
    scale(f.b, told, f.b);
    f.positive = f.started = !(variance == T(0));
    f.solved = true;
    f.rows = select(f.started, PerLane<T, Index>(f.theta.size()), PerLane<T, Index>(0));
}

namespace detail {
/// A row that tells nothing: time passes, P -> P / lambda. `scratch` has d numbers.
template <class F, class T, int N>
Step<T> pass_time(F& f, StateVector<T, N>& scratch) {
    if constexpr (requires { f.pass_time(); }) {
        return f.pass_time();
    } else {
        fill(scratch, T(0));
        return f.update(Regressor<T>(scratch.data(), scratch.size()), T(0));
    }
}
}  // namespace detail

// --- the abilities ---------------------------------------------------------------------------------------------------

/// Names its state by form. A type around a filter hands on the form of what it is around.
template <class F>
concept NamesItsForm = RecursiveLeastSquares<F> && requires(F f) { f.form(); };

/// Discounts, resets, and takes another lambda at each row.
template <class F>
concept TimeUpdates = NamesItsForm<F> && requires(F f, typename F::scalar x, Regressor<typename F::scalar> a) {
    set_forgetting(f.form(), x);
    discount(f.form(), x);
    reset(f.form(), x, a);
};
/// Adds c a a' to P.
template <class F>
concept Inflates = NamesItsForm<F> &&
                   requires(F f, typename F::scalar c, Regressor<typename F::scalar> a) { inflate(f.form(), c, a); };

template <TimeUpdates F>
void set_forgetting(F& f, typename F::scalar const& lambda) {
    set_forgetting(f.form(), lambda);
}
template <TimeUpdates F>
void discount(F& f, typename F::scalar const& lambda) {
    discount(f.form(), lambda);
}
template <Inflates F>
void inflate(F& f, typename F::scalar const& c, Regressor<typename F::scalar> a) {
    inflate(f.form(), c, a);
}
template <TimeUpdates F>
void reset(F& f, typename F::scalar const& variance, Regressor<typename F::scalar> theta) {
    reset(f.form(), variance, theta);
}

// --- what a guard asks for -------------------------------------------------------------------------------------------

/// P = variance I, theta as given, and `lambda` for the updates to come. What is around a filter and keeps rows forgets
/// them.
template <TimeUpdates F>
void restart(F& f, typename F::scalar const& variance, Regressor<typename F::scalar> theta,
             typename F::scalar const& lambda) {
    reset(f, variance, theta);
    set_forgetting(f, lambda);
}

/// One row under a lambda of its own; `after` is the lambda of the updates to come. lambda = 1: a measurement without a
/// time update.
template <TimeUpdates F>
Step<typename F::scalar> measure(F& f, Regressor<typename F::scalar> psi, typename F::scalar const& y,
                                 typename F::scalar const& lambda, typename F::scalar const& after) {
    set_forgetting(f, lambda);
    Step<typename F::scalar> const step = f.update(psi, y);
    set_forgetting(f, after);
    return step;
}

/// A row that is none of the data, without time: what holds P down. `lambda` is that of the updates to come.
template <TimeUpdates F>
Step<typename F::scalar> cap_row(F& f, Regressor<typename F::scalar> psi, typename F::scalar const& y,
                                 typename F::scalar const& lambda) {
    return measure(f, psi, y, typename F::scalar(1), lambda);
}

}  // namespace rlslab
