// What the kernels of blocks of rows compute, and in which order. Included by kernel_types.hpp.
#pragma once

#include <rlslab/core/matrices.hpp>

namespace rlslab::kernels {

/// Up to eight reflections I - beta_q v_q v_q', v_q = (pivot_q, x_q): they make zeros below R of the first columns of
/// A, of all but the last where A has no more than eight, and change the columns behind. For q = 0, 1, ..., j > q:
///
///   (1) r = -+|(R_qq, x_q)|,  pivot = R_qq - r,  beta = -1 / (r pivot);  0, where x_q'x_q = 0 or r^2 is too small
///   (2) t_j = beta_q (pivot_q R_qj + x_q'a_j),  R_qj -= t_j pivot_q,  a_j -= t_j x_q
///
/// If more than `most` columns are behind the pivots, these follow by products of matrices:
///
///   (3) w = V'a_j,  G = V'V,  V = (x_0 ... x_7)
///   (4) t_q = beta_q (pivot_q R_qj + (w_q - sum_{p<q} t_p G_pq)),  R_qj -= t_q pivot_q      (5) a_j -= sum_q t_q x_q
///
/// Sums of (1) and (2) go in eight lanes, those of (3) over the rows from the first, (4) and (5) in the order of the
/// reflections; those over rows begin with 0. R_qj is above[q ld_above + j], last[q] for the last column. For float and
/// double A's columns are padded to eight rows with zeros, and V has room for 8 numbers a row and 64 more. All numbers
/// must be finite, and neither squares nor products of two columns overflow.
///
/// Threads may share the work in registers, where leaves_columns(). One takes Part::pivots, and leaves 16 numbers in
/// `kept`; then each takes Part::columns: `from` ... `to` - 1 of them, with a V of its own; more_columns has that V.
template <class T>
struct ReflectPanel {
    static constexpr int most = 8;
    Index rows, columns, ld;  // of A
    T *A, *above;
    Index ld_above;
    T *last, *V;
    Index others = 0;  // further right-hand sides: columns of A behind the last, R_qj at other[j - columns][first + q]
    T* const* other = nullptr;
    Index first = 0;
    enum class Part { whole, pivots, columns, more_columns } part = Part::whole;
    Index from = most, to = columns + others;
    T* kept = nullptr;
    bool leaves_columns() const { return columns > 2 * most; }
};
/// C -= A B, A of `rows` x `depth`, B of `depth` x `columns`; number (i, k) of A is A[i a_row + k a_column], B alike,
/// those of a column of C stand one behind another, columns ldc apart. Where `lower`, what is above C's diagonal
/// stands. Each number of C loses sums of `together` products, one sum after another:
///
///   c_ij -= ((0 + a_i0 b_0j) + a_i1 b_1j) + ...
///
/// C overlaps neither A nor B. `room` has room_of numbers, for float and double.
template <class T>
struct SubtractProduct {
    static constexpr Index together = 256, rows_at_once = 96, columns_at_once = 1024,
                           room_of = (rows_at_once + columns_at_once) * together;
    Index rows, columns, depth;
    T const* A;
    Index a_row, a_column;
    T const* B;
    Index b_row, b_column;
    T* C;
    Index ldc;
    T* room;
    bool lower = false;
};

}  // namespace rlslab::kernels
