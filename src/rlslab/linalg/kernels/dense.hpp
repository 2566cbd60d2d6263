// Kernels on whole columns and full squares. Included by dispatch.hpp once for each instruction set: no #pragma once.

/// The rows of the block at i0 that come before `end`.
template <class B>
inline RowRange rows_of(Index i0, Index end) {
    return {0, end - i0 < B::rows ? end - i0 : B::rows};
}

/// The block at i0 of a column. Columns are padded: the block is read whole.
template <class B, class T>
[[gnu::always_inline]] inline B block_of(T const* column, Index i0) {
    B out;
    out.load(column + i0);
    return out;
}

// --- elementwise, in one pass over a column --------------------------------------------------------------------------

// One line, one operation.
// clang-format off
template <class B, class T>
[[gnu::always_inline]] inline void apply(DivideByOne<T> const& k, Index, B& x) { x.divide(k.s); }
template <class B, class T>
[[gnu::always_inline]] inline void apply(Divide<T> const& k, Index i0, B& x) { x.divide(block_of<B>(k.y, i0)); }
template <class B, class T>
[[gnu::always_inline]] inline void apply(Scale<T> const& k, Index i0, B& x) { x.scale(block_of<B>(k.y, i0)); }
template <class B, class T>
[[gnu::always_inline]] inline void apply(SquareRoots<T> const&, Index, B& x) { x.square_root_each(); }
template <class B, class T>
[[gnu::always_inline]] inline void apply(AddScaled<T> const& k, Index i0, B& x) {
    x.add_product(block_of<B>(k.y, i0), k.a);
}
template <class B, class T>
[[gnu::always_inline]] inline void apply(ScaleByOne<T> const& k, Index, B& x) { x.scale(k.a); }
template <class B, class T>
[[gnu::always_inline]] inline void apply(Add<T> const& k, Index i0, B& x) { x.add(block_of<B>(k.y, i0)); }
// clang-format on
template <class B, class T>
[[gnu::always_inline]] inline void apply(AddProduct<T> const& k, Index i0, B& x) {
    B y = block_of<B>(k.y, i0);
    y.scale(block_of<B>(k.z, i0));
    x.add(y);
}
template <class B, class T>
[[gnu::always_inline]] inline void apply(PrefixSums<T> const& k, Index i0, B& x) {
    B const terms = x;
    B before;
    terms.accumulate(*k.s, before, x, rows_of<B>(i0, k.d));
    before.store(k.before + i0);
}
template <class B, Elementwise K>
[[gnu::always_inline]] inline void evaluate(K const& k) {
    for (Index i0 = 0; i0 < k.d; i0 += B::rows) {
        B x = block_of<B>(k.x, i0);
        apply(k, i0, x);
        x.store(k.out + i0);
    }
}

/// after_i = s + (x_0 + ... + x_i), before_i = after_{i-1} within blocks of eight: from one block to the next only one
/// addition waits for another. This is the text for single rows; it adds in the order of SimdBlock::accumulate.
template <class B, class T>
    requires(B::rows == 1)
[[gnu::always_inline]] inline void evaluate(PrefixSums<T> const& k) {
    T s = *k.s;
    for (Index i0 = 0; i0 < k.d; i0 += 8) {
        T here = k.x[i0], last = s;
        for (Index i = i0; i < std::min(i0 + 8, k.d); ++i) {
            if (i > i0) here += k.x[i];
            k.before[i] = last;
            last = s + here;
            k.out[i] = last;
        }
        s = last;
    }
    *k.s = s;
}

/// Whether every number of a column is finite.
template <class B, class T>
    requires(B::rows == 1)
[[gnu::always_inline]] inline void evaluate(AllFinite<T> const& k) {
    *k.finite = true;
    for (Index i = 0; i < k.d; ++i) *k.finite = *k.finite && is_finite(k.x[i]);
}
template <class B, class T>
    requires(B::rows > 1)
[[gnu::always_inline]] inline void evaluate(AllFinite<T> const& k) {
    B differences;
    differences.zero();
    for (Index i0 = 0; i0 < k.d; i0 += B::rows) differences.add_difference(block_of<B>(k.x, i0), rows_of<B>(i0, k.d));
    *k.finite = differences.all_zero();
}

// --- dot products, four columns at once ------------------------------------------------------------------------------

/// out_j = A_j'x; for an upper triangle only the rows down to the diagonal.
template <class B, class T, Shape shape>
    requires(B::rows == 1)
[[gnu::always_inline]] inline void evaluate(MultiplyTransposed<T, shape> const& k) {
    for (Index j = 0; j < k.d; ++j) {
        Index const n = shape == Shape::full ? k.d : j + 1;
        k.out[j] = dot(k.A + j * k.ld, k.x, n);
    }
}
/// Adds the products in the block at i0, where row `first` holds the diagonal of column 0. Below its diagonal a column
/// has no rows.
template <int first, class B, class T, int... c>
[[gnu::always_inline]] inline void to_diagonal(B (&sum)[4], T const* const (&column)[4], Index i0, B const& x,
                                               std::integer_sequence<int, c...>) {
    (sum[c].template sum_first<first + c + 1>(block_of<B>(column[c], i0), x), ...);
}
template <class B, class T, Shape shape>
    requires(B::rows > 1)
[[gnu::always_inline]] inline void evaluate(MultiplyTransposed<T, shape> const& k) {
    constexpr bool upper = shape == Shape::upper;
    Index const tail = k.d / B::rows * B::rows;  // x belongs to the caller: nothing behind its end is read
    B x_tail;
    x_tail.zero();  // otherwise g++ 12 warns in every file that includes this
    if (tail < k.d) x_tail.load_unpadded(k.x + tail, rows_of<B>(tail, k.d));
    for (Index j0 = 0; j0 < k.d; j0 += 4) {
        Index const count = k.d - j0 < 4 ? k.d - j0 : 4;
        Index const last = (upper ? j0 : k.d - 1) / B::rows * B::rows;  // the block with rows that are not present
        T const* column[4];
#pragma GCC unroll 16
        for (int c = 0; c < 4; ++c) column[c] = k.A + (c < count ? j0 + c : j0) * k.ld;
        B sum[4], x, a;
        if (last > 0) {
            x.load(k.x);
#pragma GCC unroll 16
            for (int c = 0; c < 4; ++c) {
                a.load(column[c]);
                sum[c].start_sum_all(a, x);
            }
            for (Index i0 = B::rows; i0 < last; i0 += B::rows) {
                x.load(k.x + i0);
#pragma GCC unroll 16
                for (int c = 0; c < 4; ++c) {
                    a.load(column[c] + i0);
                    sum[c].sum_all(a, x);
                }
            }
        }
        if (B::rows == 8 && last == 0)
#pragma GCC unroll 16
            for (int c = 0; c < 4; ++c) sum[c].empty_sum();
        x = x_tail;
        if (last < tail) x.load(k.x + last);
        if (upper && B::rows == 8 &&
            count == 4) {  // the rows that count are known when this is compiled: no masks from memory
            if (j0 == last) to_diagonal<0>(sum, column, last, x, std::make_integer_sequence<int, 4>());
            else to_diagonal<B::rows - 4>(sum, column, last, x, std::make_integer_sequence<int, 4>());
        } else {
#pragma GCC unroll 16
            for (int c = 0; c < 4; ++c) {
                RowRange const present{0, (upper ? j0 + c + 1 : k.d) - last};
                a.load(column[c] + last);
                if constexpr (B::rows == 8) sum[c].sum(a, x, present);
                else sum[c].start_sum(a, x, present);  // of at most four rows there is one block
            }
        }
        B::sums(sum, k.out + j0);
    }
}

// --- products of squares ---------------------------------------------------------------------------------------------

/// out = A B, a few blocks of rows in registers, summed over the columns of A in their order.
template <class B, int K, class T>
[[gnu::always_inline]] inline void rows(MultiplySquares<T> const& k, Index i0) {
    for (Index j = 0; j < k.d; ++j) {
        B sum[K], a;
        for (Index n = 0; n < k.d; ++n) {
            T const b = k.B[n * k.row + j * k.column];
#pragma GCC unroll 16
            for (int m = 0; m < K; ++m) {
                Index const i = i0 + m * B::rows;
                a.load(k.A + n * k.ld + i);
                if (n == 0) sum[m] = a, sum[m].scale(b);
                else sum[m].add_product(a, b);
            }
        }
#pragma GCC unroll 16
        for (int m = 0; m < K; ++m) sum[m].store(k.out + j * k.ld + i0 + m * B::rows);
    }
}
