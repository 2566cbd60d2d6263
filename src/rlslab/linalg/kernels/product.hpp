// A product of matrices: the text for every arithmetic, which defines the bits, and the one for registers. Included by
// dispatch.hpp once for each instruction set, each time in a namespace of its own: no #pragma once.

/// The text for every arithmetic.
template <class P, class T>
    requires(P::width == 1)
void evaluate(SubtractProduct<T> const& h) {
    for (Index from = 0; from < h.depth; from += h.together) {
        Index const to = std::min(from + h.together, h.depth);
        for (Index j = 0; j < h.columns; ++j)
            for (Index i = h.lower ? j : 0; i < h.rows; ++i) {
                T sum(0);
                for (Index k = from; k < to; ++k)
                    sum += h.A[i * h.a_row + k * h.a_column] * h.B[k * h.b_row + j * h.b_column];
                h.C[j * h.ldc + i] -= sum;
            }
    }
}

/// A strip of `side` of x's lines, n numbers each, one number of each line after another; lines that there are not are
/// zeros.
template <int side, class T>
[[gnu::always_inline]] inline void pack(T const* x, Index line, Index step, Index lines, Index n, T* out) {
    if (lines == side && line == 1) {
        for (Index k = 0; k < n; ++k)
#pragma GCC unroll 64
            for (int i = 0; i < side; ++i) out[k * side + i] = x[k * step + i];
    } else {
        for (int i = 0; i < side; ++i)
            for (Index k = 0; k < n; ++k) out[k * side + i] = i < lines ? x[i * line + k * step] : T(0);
    }
}

/// C -= A B for R registers of rows and `side` columns, n products each, of which `rows` x `columns` are there. In
/// column j what is above row `first` + j stands.
template <class P, int R, int side, class T = typename P::scalar>
[[gnu::always_inline]] inline void tile(T const* a, T const* b, Index n, T* c, Index ldc, Index rows, Index columns,
                                        Index first) {
    using Register = typename P::Register;
    Register sum[side][R];
#pragma GCC unroll 16
    for (int j = 0; j < side; ++j)
#pragma GCC unroll 16
        for (int r = 0; r < R; ++r) sum[j][r] = Register{};
    for (Index k = 0; k < n; ++k, a += R * P::width, b += side) {
        Register x[R];
#pragma GCC unroll 16
        for (int r = 0; r < R; ++r) x[r] = P::load(a + r * P::width);
#pragma GCC unroll 16
        for (int j = 0; j < side; ++j)
#pragma GCC unroll 16
            for (int r = 0; r < R; ++r) sum[j][r] = sum[j][r] + x[r] * b[j];
    }
    if (rows == R * P::width && columns == side && first + side <= 1) {
#pragma GCC unroll 16
        for (int j = 0; j < side; ++j)
#pragma GCC unroll 16
            for (int r = 0; r < R; ++r) {
                T* const at = c + j * ldc + r * P::width;
                P::store(at, P::load(at) - sum[j][r]);
            }
    } else {
        alignas(64) T out[side][R * P::width];
#pragma GCC unroll 16
        for (int j = 0; j < side; ++j)
#pragma GCC unroll 16
            for (int r = 0; r < R; ++r) P::store(out[j] + r * P::width, sum[j][r]);
        for (Index j = 0; j < columns; ++j)
            for (Index i = std::max(first + j, Index(0)); i < rows; ++i) c[j * ldc + i] -= out[j][i];
    }
}

/// The text for registers: strips of A and of B are copied, so that each register is loaded from one place behind the
/// last.
template <class P, class T>
    requires(P::width > 1)
[[gnu::always_inline]] inline void evaluate(SubtractProduct<T> const& h) {
    constexpr bool wide = P::width * int(sizeof(T)) == 64;
    constexpr int R = wide ? 3 : 2, side = wide ? 8 : 4, high = R * P::width;
    using Product = SubtractProduct<T>;
    constexpr Index most_rows = Product::rows_at_once / high * high, most_columns = Product::columns_at_once;
    T *const of_a = h.room, *const of_b = h.room + h.rows_at_once * h.together;
    for (Index from = 0; from < h.depth; from += h.together) {
        Index const n = std::min(h.together, h.depth - from);
        for (Index left = 0; left < h.columns; left += most_columns) {
            Index const right = std::min(left + most_columns, h.columns);
            for (Index j = left; j < right; j += side)
                pack<side>(h.B + from * h.b_row + j * h.b_column, h.b_column, h.b_row, std::min<Index>(side, right - j),
                           n, of_b + (j - left) * n);
            for (Index top = h.lower ? left / most_rows * most_rows : 0; top < h.rows; top += most_rows) {
                Index const bottom = std::min(top + most_rows, h.rows);
                for (Index i = top; i < bottom; i += high)
                    pack<high>(h.A + i * h.a_row + from * h.a_column, h.a_row, h.a_column,
                               std::min<Index>(high, bottom - i), n, of_a + (i - top) * n);
                for (Index j = left; j < right; j += side)
                    for (Index i = top; i < bottom; i += high)
                        if (!h.lower || i + high > j)
                            tile<P, R, side>(of_a + (i - top) * n, of_b + (j - left) * n, n, h.C + j * h.ldc + i, h.ldc,
                                             std::min<Index>(high, bottom - i), std::min<Index>(side, right - j),
                                             h.lower ? j - i : -side);
            }
        }
    }
}
