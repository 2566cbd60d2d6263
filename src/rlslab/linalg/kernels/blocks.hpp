// Passes over a symmetric matrix of which the blocks of 8 x 8 on and above the diagonal are stored (SymmetricMatrix),
// in the order of memory: block columns from left to right, each from the top. Included by dispatch.hpp once for each
// instruction set: no #pragma once.
//
// A block above the diagonal is read once and takes part in two products: as it is in those of its rows, and
// transposed, in registers, in those of its columns. The sum of a row j thus takes the columns before j, which come
// from the blocks above j's own on the diagonal, and then those behind it: the columns in their order, as in sweep.hpp.

/// What the lanes of b without the bit s of their number hold, and what those of a with it do, change places.
template <int s, class V, int... l>
[[gnu::always_inline]] inline void exchange(V& a, V& b, std::integer_sequence<int, l...>) {
    constexpr int W = sizeof...(l);
    V const rest = __builtin_shufflevector(a, b, ((l & s) == 0 ? l + s : W + l)...);
    a = __builtin_shufflevector(a, b, ((l & s) == 0 ? l : W + l - s)...);
    b = rest;
}
/// W columns of W numbers become their rows: squares of s x s change places with their mirror images, s = 1, 2, 4 ...
template <int s, int W, class V>
[[gnu::always_inline]] inline void transpose(V (&a)[W]) {
#pragma GCC unroll 8
    for (int c = 0; c < W; ++c)
        if ((c & s) == 0) exchange<s>(a[c], a[c + s], std::make_integer_sequence<int, W>());
    if constexpr (2 * s < W) transpose<2 * s>(a);
}

/// A block above the diagonal: rows from i0, columns from j0 on; `whole`: all of these exist. along: the sums of its
/// rows, down: those of its columns. W columns at a time, so that they stay in registers.
template <bool whole, class B, class S, class T>
[[gnu::always_inline]] inline void block_above(S const& s, T* block, Index i0, Index j0, B& along, B& down) {
    constexpr int W = B::W;
    B w;
    if constexpr (S::writes) w.load(s.w + i0);
#pragma GCC unroll 8
    for (int h = 0; h < B::registers; ++h) {
        typename B::V part[B::registers][W];
#pragma GCC unroll 8
        for (int c = 0; c < W; ++c) {
            Index const j = j0 + h * W + c;
            T* const column = block + (h * W + c) * B::rows;
            B t = block_of<B>(column, 0);
            if constexpr (S::writes) {
                step(s, s.at(j), t, w);
                t.store(column);
            } else {
                if (whole || j < s.d) along.add_product(t, s.x[j]);
#pragma GCC unroll 8
                for (int m = 0; m < B::registers; ++m) part[m][c] = t.v[m];
            }
        }
        if constexpr (!S::writes)
#pragma GCC unroll 8
            for (int m = 0; m < B::registers; ++m) {
                transpose<1>(part[m]);
#pragma GCC unroll 8
                for (int r = 0; r < W; ++r) down.v[h] = down.v[h] + part[m][r] * s.x[i0 + m * W + r];
            }
    }
}

/// Column c of a block on the diagonal, whose columns are whole: what is left above the diagonal is left below it, too.
template <int c, class B, class S>
[[gnu::always_inline]] inline void step_on_diagonal(S const& s, Index j0, B& t, B& w) {
    if constexpr (requires { s.f; }) {
        t.template subtract_either<c + 1>(w, s.f[j0 + c], block_of<B>(s.f, j0), s.w[j0 + c]);
        t.add_product(t, s.correction);
    } else {
        step(s, s.at(j0 + c), t, w);
    }
}
/// The columns from c on of the block on the diagonal at j0.
template <int c, class B, class S, class T>
[[gnu::always_inline]] inline void diagonal_block(S const& s, T* block, Index j0, B& w, B& sum) {
    T* const column = block + c * s.ld;
    B t = block_of<B>(column, 0);
    if constexpr (S::writes) {
        step_on_diagonal<c>(s, j0, t, w);
        t.store(column);
    } else {
        sum.add_product(t, s.x[j0 + c]);
    }
    if constexpr (c + 1 < B::rows)
        if (j0 + c + 1 < s.d) diagonal_block<c + 1>(s, block, j0, w, sum);
}

/// G block columns side by side, the first at A, columns from j0 on. Returns where the next one begins.
template <class B, int G, bool whole, class S, class T>
[[gnu::always_inline]] inline T* block_columns(S const& s, T* A, Index j0) {
    constexpr int R = B::rows;
    T* block[G];
    B w, along, down[G];
#pragma GCC unroll 8
    for (int g = 0; g < G; ++g) {
        block[g] = A;
        A += (j0 / R + g + 1) * R * R;
        if constexpr (!S::writes) down[g].load(s.w + j0 + g * R);
    }
    for (Index i0 = 0; i0 < j0; i0 += R) {
        if constexpr (!S::writes) along.load(s.w + i0);
#pragma GCC unroll 8
        for (int g = 0; g < G; ++g) block_above<whole>(s, block[g] + i0 * R, i0, j0 + g * R, along, down[g]);
        if constexpr (!S::writes) along.store(s.w + i0);
    }
#pragma GCC unroll 8
    for (int p = 0; p < G; ++p) {
        Index const i0 = j0 + p * R;
        if constexpr (S::writes) w.load(s.w + i0);
        diagonal_block<0>(s, block[p] + i0 * R, i0, w, down[p]);
#pragma GCC unroll 8
        for (int g = p + 1; g < G; ++g) block_above<whole>(s, block[g] + i0 * R, i0, j0 + g * R, down[p], down[g]);
        if constexpr (!S::writes) down[p].store(s.w + i0);
    }
    return A;
}
/// A product alone takes two block columns side by side on registers of 32 bytes: a sum down a column waits for itself.
template <class B, class S>
[[gnu::always_inline]] inline void by_blocks(S const& s) {
    constexpr int R = B::rows, G = sizeof(typename B::V) == 32 && !S::writes ? 2 : 1;
    auto* A = s.A;
    Index j0 = 0;
    if constexpr (!S::writes) {
        B start;
        start.empty_sum();
        fill(s.w, 0, s.d, start);
    }
    if constexpr (R == 8) {
        for (; j0 + G * R <= s.d; j0 += G * R) A = block_columns<B, G, true>(s, A, j0);
        if constexpr (G > 1)
            if (j0 + R <= s.d) A = block_columns<B, 1, true>(s, A, j0), j0 += R;
    }
    if (j0 < s.d) block_columns<B, 1, false>(s, A, j0);
}
template <class B, class S>
[[gnu::always_inline]] inline void evaluate(OnBlocks<S> const& s) {
    by_blocks<B>(s);
}
