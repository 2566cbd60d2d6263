// Sweeps over the columns of a square matrix. The outer loop goes over a few blocks of rows, the inner one over
// columns, so that the vector w, which runs along the rows (a partial product, a gain), stays in registers. Included by
// dispatch.hpp once for each instruction set: no #pragma once.
//
// Each sweep is one or two lines of formula for t, a block of column j of A, and w, the running block. at(j) reads the
// scalars of step j once.

// w = A x
template <class B, class T>
[[gnu::always_inline]] inline void step(Multiply<T> const&, T const& x, B& t, B& w) {
    w.add_product(t, x);
}

// A = (A - w f') / lambda; at(j) conjugates f_j
template <class B, class T>
[[gnu::always_inline]] inline void step(SubtractRankOne<T> const& k, T const& f, B& t, B& w) {
    t.subtract_product(w, f);
    t.add_product(t, k.correction);
}

// A += w w'
template <class B, class T>
[[gnu::always_inline]] inline void step(AddSquare<T> const&, T const& wj, B& t, B& w) {
    t.add_product(w, wj);
}

// A_ij = t - w_i mu_j,  w_i += t g_j
template <class B, class T>
[[gnu::always_inline]] inline void step(SweepUd<T> const&, typename SweepUd<T>::At const& at, B& t, B& w) {
    B const old = t;
    t.subtract_product(w, at.mu);
    w.add_product(old, at.g);
}

// A_ij = (t keep_j - w_i mix_j) / sqrt(lambda),  w_i += t f_j
template <class B, class T>
[[gnu::always_inline]] inline void step(SweepCarlson<T> const& k, typename SweepCarlson<T>::At const& at, B& t, B& w) {
    B const old = t;
    t.scale(at.keep);
    t.subtract_product(w, at.mix);
    t.add_product(t, k.correction);
    w.add_product(old, at.f);
}

// [w t/sqrt(lambda)] times the rotation j
template <class B, class T>
[[gnu::always_inline]] inline void step(SweepRotations<T> const& k, typename SweepRotations<T>::At const& at, B& t,
                                        B& w) {
    t.add_product(t, k.correction);
    B turned = t;
    turned.scale(at.s);
    turned.add_product(w, at.c);
    t.scale(at.c);
    t.subtract_product(w, conjugate(at.s));
    w.set(turned);
}

// A_ij = t keep_j - (t less_j + w_i mix_j)
template <class At, class B>
[[gnu::always_inline]] inline void subtract_delta(At const& at, B& t, B const& w) {
    B delta = t;
    delta.scale(at.less);
    delta.add_product(w, at.mix);
    t.scale(at.keep);
    t.subtract(delta);
}

// and w_i += t f_j
template <class B, class T>
[[gnu::always_inline]] inline void step(SweepCarlsonDelta<T> const&, typename SweepCarlsonDelta<T>::At const& at, B& t,
                                        B& w) {
    B const old = t;
    subtract_delta(at, t, w);
    w.add_product(old, at.f);
}

// and w_i = c_j w_i + s_j t
template <class B, class T>
[[gnu::always_inline]] inline void step(SweepRotationsDelta<T> const&, typename SweepRotationsDelta<T>::At const& at,
                                        B& t, B& w) {
    B turned = t;
    turned.scale(at.s);
    turned.add_product(w, at.c);
    subtract_delta(at, t, w);
    w.set(turned);
}

/// Columns [j0, j1) of the first P of K blocks.
template <int P, class B, int K, class S>
[[gnu::always_inline]] inline void columns(S const& s, B (&w)[K], Index i0, Index j0, Index j1) {
    for (Index j = j0; j < j1; ++j) {
        auto* const column = s.A + j * s.ld + i0;
        auto const at = s.at(j);
#pragma GCC unroll 16
        for (int m = 0; m < P; ++m) {
            B t;
            t.load(column + m * B::rows);
            step(s, at, t, w[m]);
            if constexpr (S::writes) t.store(column + m * B::rows);
        }
    }
}
/// For an upper triangle: the columns that end in the P-th block, then those of the next block, up to the K-th.
template <int P, class B, int K, class S>
[[gnu::always_inline]] inline void staircase(S const& s, B (&w)[K], Index i0) {
    Index const j0 = i0 + (P - 1) * B::rows, j1 = j0 + B::rows;
    columns<P>(s, w, i0, j0, std::min(j1, s.d));
    if constexpr (P < K) staircase<P + 1>(s, w, i0);
    else columns<P>(s, w, i0, j1, s.d);
}

template <class B, int K, Sweep S>
[[gnu::always_inline]] inline void rows(S const& s, Index i0) {
    B w[K];
    Index j0 = 0;
#pragma GCC unroll 16
    for (int m = 0; m < K; ++m) {
        Index const i = i0 + m * B::rows;
        if constexpr (S::starts == Start::column) {
            w[m].load(s.w + i);
        } else if constexpr (S::starts == Start::zero) {
            w[m].zero();
        } else {
            w[m].load(s.A + i);
            w[m].scale(s.at(0));
            j0 = 1;
        }
    }
    if constexpr (S::upper) staircase<1>(s, w, i0);
    else columns<K>(s, w, i0, j0, s.d);
    if constexpr (S::starts != Start::column)
#pragma GCC unroll 16
        for (int m = 0; m < K; ++m) w[m].store(s.w + i0 + m * B::rows);
}

// What a pass does besides with the blocks that it leaves (columns.hpp).
struct NothingElse {
    void begin(Index) {}
    template <class B>
    [[gnu::always_inline]] void add(int, B const&) {}
    void end(Index) {}
};

/// The product's sums start from -0, to which the first term is added without a change.
template <class B, int K, Sweep S>
[[gnu::always_inline]] inline void rows(ThenMultiply<S> const& s, Index i0) {
    B w[K], product[K];
    for (B& sum : product) sum.empty_sum();
#pragma GCC unroll 16
    for (int m = 0; m < K; ++m) w[m].load(s.w + i0 + m * B::rows);
    for (Index j = 0; j < s.d; ++j) {
        auto* const column = s.A + j * s.ld + i0;
#pragma GCC unroll 16
        for (int m = 0; m < K; ++m) {
            B t;
            t.load(column + m * B::rows);
            step(s, s.at(j), t, w[m]);
            t.store(column + m * B::rows);
            product[m].add_product(t, s.x[j]);
        }
    }
#pragma GCC unroll 16
    for (int m = 0; m < K; ++m) product[m].store(s.out + i0 + m * B::rows);
}

// P = (P - (K g' + g K')) / lambda, with two running vectors.
template <class B, int K, class T>
[[gnu::always_inline]] inline void rows(SubtractRankTwo<T> const& s, Index i0) {
    B x[K], g[K];
#pragma GCC unroll 16
    for (int m = 0; m < K; ++m) {
        Index const i = i0 + m * B::rows;
        x[m].load(s.x + i);
        g[m].load(s.g + i);
    }
    for (Index j = 0; j < s.d; ++j) {
        T const xj = conjugate(s.x[j]), gj = conjugate(s.g[j]);
#pragma GCC unroll 16
        for (int m = 0; m < K; ++m) {
            T* const here = s.A + j * s.ld + i0 + m * B::rows;
            B t, both = x[m];
            t.load(here);
            both.scale(gj);
            both.add_product(g[m], xj);
            t.subtract(both);
            t.add_product(t, s.correction);
            t.store(here);
        }
    }
}

/// K blocks of rows together while there are so many before i1, then K/2, ..., then 1.
template <class B, int K, class S>
[[gnu::always_inline]] inline void groups(S const& s, Index i0, Index i1) {
    for (; i1 - i0 > (K - 1) * B::rows; i0 += K * B::rows) rows<B, K>(s, i0);
    if constexpr (K > 1) groups<B, K / 2>(s, i0, i1);
}
/// Computes one triangle and copies it: stochastic rounding would give the mirror image other bits.
template <class B, class T>
    requires(B::rows == 1)
[[gnu::always_inline]] inline void evaluate(SubtractMirrored<T> const& s) {
    for (Index j = 0; j < s.d; ++j)
        for (Index i = 0; i <= j; ++i) {
            T const t = s.A[j * s.ld + i] - s.w[i] * conjugate(s.f[j]);
            s.A[i * s.ld + j] = s.A[j * s.ld + i] = t + t * s.correction;
            if constexpr (ComplexScalar<T>)
                s.A[i * s.ld + j] = i == j ? T(t.re + t.re * s.correction) : conjugate(s.A[j * s.ld + i]);
        }
}

/// One product for both triangles, and where their numbers are the same, one sum: stochastic rounding keeps A
/// symmetric. (A sum with a zero is exact, and the zeros of the two triangles may differ in sign.)
template <class B, class T>
    requires(B::rows == 1)
[[gnu::always_inline]] inline void evaluate(AddSquare<T> const& s) {
    for (Index j = 0; j < s.d; ++j)
        for (Index i = 0; i <= j; ++i) {
            T const product = s.w[i] * s.w[j], above = s.A[j * s.ld + i], below = s.A[i * s.ld + j],
                    sum = above + product;
            s.A[i * s.ld + j] = select(below == above && !(below == T(0)), sum, T(below + product));
            s.A[j * s.ld + i] = sum;
        }
}
