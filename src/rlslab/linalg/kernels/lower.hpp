// Kernels on a lower triangle L = R', a row of R in each column. Eight rows of R are finished one after another within
// their corner on the diagonal, then applied to the columns behind it. Included by dispatch.hpp once for each
// instruction set: no #pragma once.

/// Applies the columns of L from i0 on to the rows of block j0 below them: t is a block of column i, x the block of the
/// row that is folded in.
template <class B, class S>
[[gnu::always_inline]] inline void panel(S const& s, Index i0, Index j0) {
    B x;
    x.load(s.x + j0);
    for (Index i = i0; i < i0 + B::rows; ++i) {
        auto* const column = s.L + i * s.ld + j0;
        B t;
        t.load(column);
        step(s, i, t, x);
        if constexpr (S::writes) t.store(column);
    }
    x.store(s.x + j0);
}

/// The same in the m columns of the corner on the diagonal at i0: what is above the diagonal stays, and with `behind` 1
/// the diagonal, too.
template <class B, class S>
[[gnu::always_inline]] inline void corner_in_place(S const& s, Index i0, Index m, Index behind, B& x) {
#pragma GCC unroll 8
    for (Index i = 0; i < m; ++i) {
        auto* const column = s.L + (i0 + i) * s.ld + i0;
        B t;
        t.load(column);
        step(s, i0 + i, t, x);
        t.store_present(column, {i + behind, m});
    }
}

// x_j -= x_i L_ji
template <class B, class T>
[[gnu::always_inline]] inline void step(Eliminate<T> const& s, Index i, B& t, B& x) {
    x.subtract_product(t, s.x[i]);
}

/// (t, x) = (c t + s x, x - u t)
template <class B, class C, class S, class U>
[[gnu::always_inline]] inline void mix(B& t, B& x, C const& c, S const& s, U const& u) {
    B const old = t;
    t.scale(c);
    t.add_product(x, s);
    x.subtract_product(old, u);
}
// L_ji = c_i t + s_i' x_j,  x_j -= e_i t
template <class B, class T>
[[gnu::always_inline]] inline void step(SweepGentleman<T> const& s, Index i, B& t, B& x) {
    mix(t, x, s.c[i], conjugate(s.s[i]), s.e[i]);
}

// (root_lambda t, x) times the rotation (c, s)
template <class B, class R, class C, class S>
[[gnu::always_inline]] inline void rotate(B& t, B& x, R const& root_lambda, C const& c, S const& s) {
    t.scale(root_lambda);
    B const old = t;
    t.scale(c);
    t.add_product(x, conjugate(s));
    x.scale(c);
    x.subtract_product(old, s);
}
// (sqrt(lambda) L_ji, x_j) times the rotation i
template <class B, class T>
[[gnu::always_inline]] inline void step(RotateIn<T> const& s, Index i, B& t, B& x) {
    rotate(t, x, s.root_lambda, s.c[i], s.s[i]);
}

// L_ji = weight L_ji - a,  x_j -= a v_i,  where a = tau_i (weight L_ji + v_i' x_j). Without a reflection (tau_i = 0) a
// is set to 0: the product of 0 and an infinity would be NaN.
template <class B, class T>
[[gnu::always_inline]] inline void step(ReflectIn<T> const& s, Index i, B& t, B& x) {
    t.scale(s.weight);
    Truth<T> const nothing = s.tau[i] == RealOf<T>(0);
    if (all(nothing)) return;
    B along = x;
    along.scale(conjugate(s.x[i]));
    along.add(t);
    along.scale(s.tau[i]);
    if constexpr (!std::same_as<Truth<T>, bool>) along.clear(nothing);
    t.subtract(along);
    x.subtract_product(along, s.x[i]);
}

/// Row i of the m x m corner of L on the diagonal, applied to the rows behind it within the corner, in scalars.
template <class T>
[[gnu::always_inline]] inline void finish_corner_row(Eliminate<T> const& s, Index i0, Index i, Index m, T* x) {
    T const* const row = s.L + (i0 + i) * s.ld + i0;
#pragma GCC unroll 8
    for (Index j = i + 1; j < m; ++j) x[j] -= x[i] * row[j];
}
template <class T>
[[gnu::always_inline]] inline void finish_corner_row(SolveLower<T> const& s, Index i0, Index i, Index m, T* x) {
    x[i] /= s.L[(i0 + i) * (s.ld + 1)];
    finish_corner_row(static_cast<Eliminate<T> const&>(s), i0, i, m, x);
}
/// (a, b) = (c a + s' b, c b - s a).
template <class T>
[[gnu::always_inline]] inline void rotate(Rotation<T> const& turn, T& a, T& b) {
    T const up = conjugate(turn.s) * b, turned = turn.c * a + up, down = turn.s * a;
    b = turn.c * b - down;
    a = turned;
}
template <class T>
[[gnu::always_inline]] inline void finish_corner_row(RotateIn<T> const& s, Index i0, Index i, Index m, T* x) {
    T* const row = s.L + (i0 + i) * s.ld + i0;
    Rotation<T> const turn = givens<T>(RealOf<T>(s.root_lambda * real_part(row[i])), x[i]);
    row[i] = T(turn.r);
    s.c[i0 + i] = turn.c;
    s.s[i0 + i] = turn.s;
#pragma GCC unroll 8
    for (Index j = i + 1; j < m; ++j) {
        T t = s.root_lambda * row[j];
        rotate(turn, t, x[j]);
        row[j] = t;
    }
    T t = s.root_lambda * s.z[i0 + i];
    rotate(of_rows(turn), t, *s.eta);
    s.z[i0 + i] = t;
}
/// The step of ReflectIn for one pair: above = weight L_ji or z_i, below = x_j or eta.
template <class T>
[[gnu::always_inline]] inline void reflect(RealOf<T> const& tau, T const& v, RealOf<T> const& weight, T& above,
                                           T& below) {
    above *= weight;
    T t = tau * (above + conjugate(v) * below);
    if constexpr (!std::same_as<Truth<T>, bool>) t = select(tau == RealOf<T>(0), T(0), t);
    above -= t;
    below -= t * v;
}
template <class T>
[[gnu::always_inline]] inline void finish_corner_row(ReflectIn<T> const& s, Index i0, Index i, Index m, T* x) {
    T* const row = s.L + (i0 + i) * s.ld + i0;
    RealOf<T> const a = s.weight * real_part(row[i]);
    T const here = x[i];
    Reflector<RealOf<T>> const turn(a, norm(a, RealOf<T>(absolute_square(here)), &here, 1));
    row[i] = T(turn.r);
    *s.ratio *= turn.cosine(a);
    T const v = x[i] = here / turn.pivot;
    s.tau[i0 + i] = turn.tau;
    if (all(turn.tau == RealOf<T>(0))) {
#pragma GCC unroll 8
        for (Index j = i + 1; j < m; ++j) row[j] *= s.weight;
        s.z[i0 + i] *= s.weight;
        return;
    }
#pragma GCC unroll 8
    for (Index j = i + 1; j < m; ++j) reflect(turn.tau, v, s.weight, row[j], x[j]);
    reflect<T>(turn.tau, conjugate(v), s.weight, s.z[i0 + i], *s.eta);
}
/// All rows of a full corner, unrolled so that a copy of x stays in registers.
template <int i, int m, class S, class T>
[[gnu::always_inline]] inline void finish_corner_rows(S const& s, Index i0, T* x) {
    finish_corner_row(s, i0, i, m, x);
    if constexpr (i + 1 < m) finish_corner_rows<i + 1, m>(s, i0, x);
}
template <int m, class S, class T>
[[gnu::always_inline]] inline void whole_corner(S const& s, Index i0, T* x) {
    T copy[m];
#pragma GCC unroll 8
    for (Index i = 0; i < m; ++i) copy[i] = x[i];
    finish_corner_rows<0, m>(s, i0, copy);
#pragma GCC unroll 8
    for (Index i = 0; i < m; ++i) x[i] = copy[i];
}

template <class B, ByPanels S>
[[gnu::always_inline]] inline void evaluate(S const& s) {
    for (Index i0 = 0; i0 < s.d; i0 += B::rows) {
        Index const m = rows_of<B>(i0, s.d).last;
        if (B::padded && m == B::rows) whole_corner<B::padded ? B::rows : 1>(s, i0, s.x + i0);
        else
            for (Index i = 0; i < m; ++i) finish_corner_row(s, i0, i, m, s.x + i0);
        for (Index j0 = i0 + B::rows; j0 < s.d; j0 += B::rows) panel<B>(s, i0, j0);
    }
}

/// Gentleman's rows: all coefficients are known, so the corner needs no separate pass. Its part above the diagonal
/// stays unchanged.
template <class B, class T>
[[gnu::always_inline]] inline void evaluate(SweepGentleman<T> const& s) {
    for (Index i0 = 0; i0 < s.d; i0 += B::rows) {
        if constexpr (B::rows > 1) {
            B x = block_of<B>(s.x, i0);
            corner_in_place(s, i0, rows_of<B>(i0, s.d).last, 1, x);
        }
        for (Index j0 = i0 + B::rows; j0 < s.d; j0 += B::rows) panel<B>(s, i0, j0);
    }
}

template <class B, class T>
[[gnu::always_inline]] inline void step(FoldGentleman<T> const& s, Index i, B& t, B& x) {
    mix(t, x, s.c[i], s.s[i], s.x[i]);
}
/// Finishes x in the m rows of the corner at i0: the first m of `x` hold it.
template <int i, class B, class T>
[[gnu::always_inline]] inline void eliminate_in_corner(FoldGentleman<T> const& s, Index i0, Index m, T (&x)[B::rows]) {
    T const* const row = s.L + (i0 + i) * s.ld + i0;
#pragma GCC unroll 8
    for (Index j = i + 1; j < B::rows; ++j) x[j] -= x[i] * row[j];
    if constexpr (i + 2 < B::rows)
        if (i + 2 < m) eliminate_in_corner<i + 1, B>(s, i0, m, x);
}
/// The next corner needs only x of this one: its elimination runs while this one's quotients and its panels' L are
/// computed.
template <class B, class T>
    requires(B::rows > 1)
[[gnu::always_inline]] inline void evaluate(FoldGentleman<T> const& s) {
    T inverse = *s.inverse, eta = *s.eta;
    for (Index i0 = 0; i0 < s.d; i0 += B::rows) {
        RowRange const present = rows_of<B>(i0, s.d);
        B row = block_of<B>(s.x, i0), x, before, after;
        T corner[B::rows];
        row.store(corner);
        if (present.last > 1) eliminate_in_corner<0, B>(s, i0, present.last, corner);
        x.put_together(corner);
        x.store(s.x + i0);
        B b = block_of<B>(s.D, i0), share = x;
        b.scale(s.lambda);
        share.scale(x);
        share.divide(b);
        share.accumulate(inverse, before, after, present);
        B turn = x, D = x, c = b;
        turn.divide(before);
        D.scale(turn);
        D.add(b);
        c.divide(D);
        turn.divide(D);
        D.store(s.D + i0), c.store(s.c + i0), turn.store(s.s + i0);
        corner_in_place(s, i0, present.last, 1, row);
        for (Index j0 = i0 + B::rows; j0 < s.d; j0 += B::rows) panel<B>(s, i0, j0);
        for (Index i = i0; i < i0 + present.last; ++i) {
            T const t = s.z[i], turned = s.s[i] * eta;
            s.z[i] = s.c[i] * t + turned;
            eta -= s.x[i] * t;
        }
    }
    *s.inverse = inverse, *s.eta = eta;
}

template <class B, class T>
[[gnu::always_inline]] inline void step(SolveRotations<T> const& s, Index i, B& t, B& x) {
    x.subtract_product(t, s.u[i]);
}
template <class B, class T>
[[gnu::always_inline]] inline void step(FoldQr<T> const& s, Index i, B& t, B& x) {
    mix(t, x, s.c[i], s.s[i], s.u[i]);
}
/// u in the m rows of the corner at i0, from x, to which the rows before it are applied.
template <int i, class B, class T>
[[gnu::always_inline]] inline void substitute_in_corner(SolveRotations<T> const& s, Index i0, Index m,
                                                        T const (&inverse)[B::rows], T (&x)[B::rows], T (&u)[B::rows]) {
    u[i] = x[i] * inverse[i];
    if constexpr (i + 1 < B::rows) {
        if (i + 1 >= m) return;
        T const* const row = s.L + (i0 + i) * s.ld + i0;
#pragma GCC unroll 8
        for (Index j = i + 1; j < B::rows; ++j) x[j] -= u[i] * row[j];
        substitute_in_corner<i + 1, B>(s, i0, m, inverse, x, u);
    }
}
template <class B, class S>
[[gnu::always_inline]] inline B substituted(S const& s, Index i0, Index m, B const& row) {
    using T = typename B::scalar;
    T x[B::rows], numbers[B::rows], inverse[B::rows];
    row.store(x);
#pragma GCC unroll 8
    for (Index i = 0; i < B::rows; ++i) {
        numbers[i] = i < m ? s.L[(i0 + i) * (s.ld + 1)] : T(1);
        inverse[i] = T(1);
    }
    B pivots, quotients, u;
    pivots.put_together(numbers);
    quotients.put_together(inverse);
    quotients.divide(pivots);
    quotients.store(inverse);
    substitute_in_corner<0, B>(s, i0, m, inverse, x, numbers);
    u.put_together(numbers);
    u.store(s.u + i0);
    if constexpr (!S::writes) {
        B left;
        left.put_together(x);
        left.store(s.x + i0);
    }
    return u;
}
/// c and s of the corner at i0; `sum` and its root go from one corner to the next.
template <class B, class T>
[[gnu::always_inline]] inline void turn_corner(SolveRotations<T> const& s, Index i0, RowRange present, B const& u,
                                               T& sum, T& root) {
    B before, after, share = u, turn = u;
    share.scale(u);
    share.accumulate(sum, before, after, present);
    after.square_root_each();
    T roots[B::rows + 1];  // before_i is the after of the row above it
    roots[0] = root;
#pragma GCC unroll 8
    for (int i = 0; i < B::rows; ++i) roots[i + 1] = after.v[i / B::W][i % B::W];
    before.put_together(roots);
    root = roots[B::rows];
    B c = before;
    c.divide(after);
    c.scale(s.root_lambda);
    c.store(s.c + i0);
    before.scale(after);
    turn.scale(s.root_lambda);
    turn.divide(before);
    turn.store(s.s + i0);
}
/// A corner's substitution is a chain, and so are its roots and quotients after it; the panels are neither. So the next
/// corner goes ahead of this one's panels: it needs only what u makes of its part of x, which is computed twice.
template <class B, class S>
    requires(B::rows > 1 && std::derived_from<S, SolveRotations<typename B::scalar>>)
[[gnu::always_inline]] inline void evaluate(S const& s) {
    using T = typename B::scalar;
    T sum = *s.sum, eta = *s.eta, root = s.root_lambda;
    B row = block_of<B>(s.x, 0), u = substituted(s, 0, rows_of<B>(0, s.d).last, row);
    for (Index i0 = 0; i0 < s.d; i0 += B::rows) {
        RowRange const present = rows_of<B>(i0, s.d);
        Index const next = i0 + B::rows;
        B ahead = row;
        turn_corner(s, i0, present, u, sum, root);
        if (B::rows == 8 && next < s.d) {  // a block of four is alone
            ahead.load(s.x + next);
            for (Index i = i0; i < next; ++i) ahead.subtract_product(block_of<B>(s.L + i * s.ld, next), s.u[i]);
            u = substituted(s, next, rows_of<B>(next, s.d).last, ahead);
        }
        if constexpr (S::writes) corner_in_place(s, i0, present.last, 0, row);
        for (Index j0 = S::writes ? next : next + B::rows; j0 < s.d; j0 += B::rows) panel<B>(s, i0, j0);
        for (Index i = i0; i < i0 + present.last; ++i) {
            T const t = s.z[i], turned = s.s[i] * eta;
            if constexpr (S::writes) s.z[i] = s.c[i] * t + turned;
            eta -= s.u[i] * t;
        }
        row = ahead;
    }
    *s.sum = sum, *s.eta = eta;
}

/// Rows that go out: the columns from the last to the first, a block of x in registers. Above the diagonal zeros are
/// turned into zeros.
template <class B, class T>
[[gnu::always_inline]] inline void evaluate(RotateOut<T> const& s) {
    for (Index j0 = 0; j0 < s.d; j0 += B::rows) {
        B x;
        x.zero();
        for (Index i = std::min(j0 + B::rows, s.d) - 1; i >= 0; --i) {
            T* const column = s.L + i * s.ld + j0;
            B t, turned;
            t.load(column);
            turned = t;
            turned.scale(s.s[i]);
            t.scale(s.c[i]);
            t.subtract_product(x, s.s[i]);
            x.scale(s.c[i]);
            x.add(turned);
            t.store(column);
        }
    }
}
