// The sweeps of sweep.hpp with their loops exchanged: a few columns side by side, from the first block of rows to the
// last. Included by dispatch.hpp once for each instruction set: no #pragma once.
//
// Memory is read in its order, which pays where A is larger than the caches. Vectors along the rows (w, and the product
// with A) pass through registers once for each group of columns; the dot product of a column stays in them, so that a
// triangle is changed and multiplied in one pass. Each number takes part in the operations of sweep.hpp in their order.
// Sums start from -0 here, too.

// What is done besides with the block that is left in column c of a group, at rows i0: NothingElse, or one of these.
// Between begin and end c goes from 0 to C - 1.
/// out_i += A_ij x_j over the columns of the group.
template <class B, int C>
struct SumAcross {
    using T = typename B::scalar;
    T x[C];
    T* out;
    B sum;
    [[gnu::always_inline]] SumAcross(T const* from, T* to) : out(to) {
#pragma GCC unroll 16
        for (int c = 0; c < C; ++c) x[c] = from[c];
    }
    [[gnu::always_inline]] void begin(Index i0) { sum.load(out + i0); }
    [[gnu::always_inline]] void add(int c, B const& t) { sum.add_product(t, x[c]); }
    [[gnu::always_inline]] void end(Index i0) { sum.store(out + i0); }
};
/// The lanes of sum_i A_ij x_i of each column of the group.
template <class B>
struct SumsDown {
    typename B::scalar const* x;
    B (&sum)[4];
    B here;
    [[gnu::always_inline]] void begin(Index i0) { here.load(x + i0); }
    [[gnu::always_inline]] void add(int c, B const& t) { sum[c].sum_all(t, here); }
    void end(Index) {}
};
/// The same in the block with the diagonals: row `diagonal` has that of the first column. Below its diagonal a column
/// has no rows.
template <class B>
struct SumsToDiagonal {
    B (&sum)[4];
    B here;
    Index diagonal;
    void begin(Index) {}
    [[gnu::always_inline]] void add(int c, B const& t) { sum[c].sum(t, here, {0, diagonal + c + 1}); }
    void end(Index) {}
};

/// C columns of A from j0 on, and the scalars of their steps.
template <int C, class S>
struct Columns {
    using T = std::remove_const_t<std::remove_pointer_t<decltype(S::A)>>;
    T* column[C];
    std::remove_cvref_t<decltype(std::declval<S>().at(0))> at[C];
    [[gnu::always_inline]] Columns(S const& s, Index j0) {
#pragma GCC unroll 16
        for (int c = 0; c < C; ++c) {
            column[c] = const_cast<T*>(s.A) + (j0 + c) * s.ld;  // written where S::writes
            at[c] = s.at(j0 + c);
        }
    }
};

/// The blocks of rows from i0 to i1 of a group.
template <class B, class S, int C, class Also>
[[gnu::always_inline]] inline void side_by_side(S const& s, Columns<C, S> const& group, Index i0, Index i1,
                                                Also& also) {
    for (; i0 < i1; i0 += B::rows) {
        B w = block_of<B>(s.w, i0);
        also.begin(i0);
#pragma GCC unroll 16
        for (int c = 0; c < C; ++c) {
            B t;
            t.load(group.column[c] + i0);
            step(s, group.at[c], t, w);
            if constexpr (S::writes) t.store(group.column[c] + i0);
            also.add(c, t);
        }
        if constexpr (S::starts != Start::column) w.store(s.w + i0);
        also.end(i0);
    }
}

// --- groups of C columns from j0 on ----------------------------------------------------------------------------------

// The rows [i0, i1) of a square.
template <class B, int C, class S, class Also>
[[gnu::always_inline]] inline void change(S const& s, Index j0, Index i0, Index i1, Also& also) {
    side_by_side<B>(s, Columns<C, S>(s, j0), i0, i1, also);
}
template <class B, int C, class S>
[[gnu::always_inline]] inline void group(S const& s, Index j0) {
    NothingElse none;
    change<B, C>(s, j0, 0, s.d, none);
}
template <class B, int C, class S>
    requires UpperSweep<S>
[[gnu::always_inline]] inline void group(S const& s, Index j0) {
    NothingElse none;
    change<B, C>(s, j0, 0, (j0 / B::rows + 1) * B::rows, none);
}
template <class B, int C, class S>
[[gnu::always_inline]] inline void group(ThenMultiply<S> const& s, Index j0) {
    SumAcross<B, C> product(s.x + j0, s.out);
    change<B, C>(static_cast<S const&>(s), j0, 0, s.d, product);
}
template <class B, int C, class S>
    requires UpperSweep<S>
[[gnu::always_inline]] inline void group(ThenMultiply<S> const& s, Index j0) {
    S const& sweep = s;
    Columns<C, S> const columns(sweep, j0);
    static_assert(B::rows % C == 0);
    Index const corner = j0 / B::rows * B::rows;
    B sum[4];
#pragma GCC unroll 16
    for (B& lanes : sum) lanes.empty_sum();
    SumsDown<B> above{s.x, sum, {}};
    side_by_side<B>(sweep, columns, 0, corner, above);
    SumsToDiagonal<B> rest{sum, {}, j0 - corner};
    if (corner + B::rows <= s.d) rest.here.load(s.x + corner);
    else
        rest.here.load_unpadded(s.x + corner,
                                rows_of<B>(corner, s.d));  // x belongs to the caller: nothing behind its end is read
    side_by_side<B>(sweep, columns, corner, corner + B::rows, rest);
    typename B::scalar products[4];
    B::sums(sum, products);
    std::copy_n(products, C, s.out + j0);
}

template <class B, class T>
[[gnu::always_inline]] inline void fill(T* out, Index i0, Index i1, B const& with) {
    for (; i0 < i1; i0 += B::rows) with.store(out + i0);
}
/// What the sums along the rows start from: -0; w in a triangle from zero.
template <class B, class S>
[[gnu::always_inline]] inline void start_sums(S const& s) {
    B start;
    start.empty_sum();
    if constexpr (UpperSweep<S>) start.zero();
    if constexpr (Sweep<S>)
        if constexpr (S::starts != Start::column) fill(s.w, 0, s.d, start);
}
template <class B, class S>
    requires(!UpperSweep<S>)
[[gnu::always_inline]] inline void start_sums(ThenMultiply<S> const& s) {
    B start;
    start.empty_sum();
    fill(s.out, 0, s.d, start);
}
/// C columns side by side while there are so many, then one after another.
template <class B, int C, class S>
[[gnu::always_inline]] inline void by_columns(S const& s) {
    start_sums<B>(s);
    Index j0 = 0;
    for (; j0 + C <= s.d; j0 += C) group<B, C>(s, j0);
    for (; j0 < s.d; ++j0) group<B, 1>(s, j0);
}

// --- which of the two ways -------------------------------------------------------------------------------------------

template <class B, class S>
constexpr Index columns_from = B::rows == 1 ? never
                               : B::wide    ? by_columns_from<S>.from_on_wide
                                            : by_columns_from<S>.from;
template <class B, class S>
constexpr int columns_together = B::wide && !UpperSweep<S> ? 8 : 4;
template <class B, class S, int registers = B::wide ? wide<S>.registers : S::registers>
constexpr int blocks_together = registers <= B::registers ? 1 : registers / B::registers;

template <class B, ByRows S>
[[gnu::always_inline]] inline void evaluate(S const& s) {
    if constexpr (columns_from<B, S> != never)
        if (s.d >= columns_from<B, S>) return by_columns<B, columns_together<B, S>>(s);
    groups<B, blocks_together<B, S>>(s, 0, s.d);
}
template <class B, class S>
    requires(B::rows > 1)
[[gnu::always_inline]] inline void evaluate(ThenMultiply<S> const& s) {
    if (UpperSweep<S> || s.d >= columns_from<B, ThenMultiply<S>>) return by_columns<B, columns_together<B, S>>(s);
    if constexpr (!UpperSweep<S>) groups<B, blocks_together<B, ThenMultiply<S>>>(s, 0, s.d);
}
/// For single rows: one pass, then the other.
template <class B, class S>
    requires(B::rows == 1)
[[gnu::always_inline]] inline void evaluate(ThenMultiply<S> const& s) {
    evaluate<B>(static_cast<S const&>(s));
    using T = typename B::scalar;
    if constexpr (UpperSweep<S>) evaluate<B>(MultiplyTransposed<T, Shape::upper>{s.d, s.ld, s.A, s.x, s.out});
    else evaluate<B>(Multiply<T>{s.d, s.ld, s.A, s.out, s.x});
}
