// A panel of eight reflections that are folded into a triangle together, by products of matrices: the text for every
// arithmetic, which defines the bits, and the one for registers. Included by dispatch.hpp once for each instruction
// set, each time in a namespace of its own: no #pragma once.

/// A panel while it is at work: of `columns` columns `turned` are reflected one by one, the first `count` of which are
/// pivots; what is behind these is reached by products.
template <class T>
struct PanelAtWork {
    static constexpr int most = ReflectPanel<T>::most;
    ReflectPanel<T> const& h;
    int count, turned;
    T beta[most], pivot[most], s[2 * most], t[2 * most];

    [[gnu::always_inline]] explicit PanelAtWork(ReflectPanel<T> const& panel)
        : h(panel), count(int(std::min<Index>(most, h.columns - 1))),
          turned(h.leaves_columns() ? count : int(h.columns)) {}
    [[gnu::always_inline]] T* column(Index j) const { return h.A + j * h.ld; }
    /// What stands above column j in the row of reflection q.
    [[gnu::always_inline]] T& above(Index q, Index j) const {
        if (j + 1 < h.columns) return h.above[q * h.ld_above + j];
        return j < h.columns ? h.last[q] : h.other[j - h.columns][h.first + q];
    }
    /// (2) for the right-hand sides behind the last, where those before are reflected one by one.
    template <class Dot, class Subtract>
    [[gnu::always_inline]] void turn_others(Dot const& dot, Subtract const& subtract) {
        for (Index j = h.columns; j < h.columns + h.others; ++j)
            for (int q = 0; q < count; ++q) {
                T& r = above(q, j);
                T const by = beta[q] * (pivot[q] * r + dot(column(q), column(j)));
                r -= by * pivot[q];
                subtract(by, column(q), column(j));
            }
    }
    /// (1) and (2) but for the columns themselves: the coefficients t_j from s_j = x_q'a_j.
    [[gnu::always_inline]] void turn(int q) {
        T& a = above(q, q);
        UndividedReflector<T> const turn(a, s[q]);
        beta[q] = turn.beta, pivot[q] = turn.pivot;
        a = turn.r;
        for (int j = q + 1; j < turned; ++j) {
            T& r = above(q, j);
            t[j] = beta[q] * (pivot[q] * r + s[j]);
            r -= t[j] * pivot[q];
        }
    }
};

/// The text for every arithmetic.
template <class P, class T>
    requires(P::width == 1)
void evaluate(ReflectPanel<T> const& h) {
    constexpr int most = ReflectPanel<T>::most;
    PanelAtWork<T> panel(h);
    int const count = panel.count, turned = panel.turned;
    auto const sums = [&](int q) {
        for (int j = q; j < turned; ++j) panel.s[j] = T(0) + T(dot(panel.column(q), panel.column(j), h.rows));
    };
    sums(0);
    for (int q = 0; q < count; ++q) {
        panel.turn(q);
        for (int j = q + 1; j < turned; ++j)
            for (Index k = 0; k < h.rows; ++k) panel.column(j)[k] -= panel.t[j] * panel.column(q)[k];  // (2)
        if (q + 1 < count) sums(q + 1);
    }
    if (turned == h.columns)
        return panel.turn_others([&](T const* x, T const* a) { return T(0) + T(dot(x, a, h.rows)); },
                                 [&](T const& by, T const* x, T* a) {
                                     for (Index k = 0; k < h.rows; ++k) a[k] -= by * x[k];
                                 });
    auto const product = [&](T const* x, T const* a) {
        T sum(0);
        for (Index k = 0; k < h.rows; ++k) sum += x[k] * a[k];
        return sum;
    };
    T G[most][most], t[most];
    for (int q = 0; q < most; ++q)
        for (int p = 0; p < q; ++p) G[p][q] = product(panel.column(p), panel.column(q));  // (3)
    for (Index j = most; j < h.columns + h.others; ++j) {
        T* const a = panel.column(j);
        for (int q = 0; q < most; ++q) t[q] = product(panel.column(q), a);
        for (int q = 0; q < most; ++q) {  // (4)
            T& r = panel.above(q, j);
            for (int p = 0; p < q; ++p) t[q] -= t[p] * G[p][q];
            t[q] = panel.beta[q] * (panel.pivot[q] * r + t[q]);
            r -= t[q] * panel.pivot[q];
        }
        for (Index k = 0; k < h.rows; ++k)
            for (int q = 0; q < most; ++q) a[k] -= t[q] * panel.column(q)[k];  // (5)
    }
}

/// One pass over C columns at a, ld apart, of whole blocks of eight rows: with `change` a -= t v, with `sum` then
/// s = next'a + 0, where next is the first of them as it is then if `own`.
template <class P, int C, bool change, bool sum, bool own, class T = typename P::scalar>
[[gnu::always_inline]] inline void pass_over(T const* v, T const* next, Index n, T* a, Index ld, T const* t, T* s) {
    using B = SimdBlock<T, P::width* int(sizeof(T))>;
    constexpr int registers = 8 / P::width, fours = (C + 3) / 4;
    B lanes[fours][4];
    T by[C];
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c) by[c] = change ? t[c] : T(0);
#pragma GCC unroll 16
    for (int c = 0; c < 4 * fours; ++c) lanes[c / 4][c % 4].zero();
    for (Index k = 0; k < n; k += 8)
#pragma GCC unroll 16
        for (int r = 0; r < registers; ++r) {
            typename P::Register x{}, with{};
            if constexpr (change) x = P::load(v + k + r * P::width);
            if constexpr (sum && !own) with = P::load(next + k + r * P::width);
#pragma GCC unroll 16
            for (int c = 0; c < C; ++c) {
                T* const at = a + c * ld + k + r * P::width;
                typename P::Register y = P::load(at);
                if constexpr (change) P::store(at, y = y - by[c] * x);
                if (own && c == 0) with = y;
                if constexpr (sum) lanes[c / 4][c % 4].v[r] = lanes[c / 4][c % 4].v[r] + with * y;
            }
        }
    if constexpr (sum) {
        T sums[4 * fours];
#pragma GCC unroll 16
        for (int f = 0; f < fours; ++f) B::sums(lanes[f], sums + 4 * f);
#pragma GCC unroll 16
        for (int c = 0; c < C; ++c) s[c] = sums[c];
    }
}
/// The pass over the columns from j on, after reflection q (none for q < 0), with the products with column q + 1.
template <class P, int C, bool change, bool sum, class T>
[[gnu::always_inline]] inline void pass_on(PanelAtWork<T>& panel, int q, int j, Index n) {
    T const *const v = panel.column(change ? q : 0), *const next = panel.column(sum ? q + 1 : 0);
    int const end = std::min(panel.turned, 2 * panel.most);  // g++ 12 warns of columns that there are not
    for (; j + C <= end; j += C)
        pass_over<P, C, change, sum, false>(v, next, n, panel.column(j), panel.h.ld, panel.t + j, panel.s + j);
    if constexpr (C > 1) pass_on<P, C / 2, change, sum>(panel, q, j, n);
}
/// The same from q + 1 on, the first column that is changed among them.
template <class P, int C, bool change, class T>
[[gnu::always_inline]] inline void pass_from_next(PanelAtWork<T>& panel, int q, Index n) {
    int const j = q + 1;
    if (j + C <= panel.turned) {
        pass_over<P, C, change, true, true>(panel.column(change ? q : 0), panel.column(j), n, panel.column(j),
                                            panel.h.ld, panel.t + j, panel.s + j);
        return pass_on<P, C, change, true>(panel, q, j + C, n);
    }
    if constexpr (C > 1) pass_from_next<P, C / 2, change>(panel, q, n);
}

/// A square of numbers, a register a column, becomes one of a register a row.
template <class Part>
[[gnu::always_inline]] inline void turn_square(Part (&x)[2]) {
    Part const first = x[0];
    x[0] = __builtin_shufflevector(first, x[1], 0, 2);
    x[1] = __builtin_shufflevector(first, x[1], 1, 3);
}
template <class Part>
[[gnu::always_inline]] inline void turn_square(Part (&x)[4]) {
    Part const even = __builtin_shufflevector(x[0], x[1], 0, 4, 2, 6),
               odd = __builtin_shufflevector(x[0], x[1], 1, 5, 3, 7),
               even_of_next = __builtin_shufflevector(x[2], x[3], 0, 4, 2, 6),
               odd_of_next = __builtin_shufflevector(x[2], x[3], 1, 5, 3, 7);
    x[0] = __builtin_shufflevector(even, even_of_next, 0, 1, 4, 5);
    x[1] = __builtin_shufflevector(odd, odd_of_next, 0, 1, 4, 5);
    x[2] = __builtin_shufflevector(even, even_of_next, 2, 3, 6, 7);
    x[3] = __builtin_shufflevector(odd, odd_of_next, 2, 3, 6, 7);
}
/// out = x', x of 8 columns ld apart and n rows, whole blocks of eight: row after row.
template <class P, class T>
[[gnu::always_inline]] inline void turn_into_rows(T const* x, Index ld, Index n, T* out) {
    constexpr int side = P::width == 2 ? 2 : 4;
    typedef T Part __attribute__((vector_size(side * sizeof(T))));
    typedef T PartAnywhere __attribute__((vector_size(side * sizeof(T)), aligned(alignof(T)), may_alias));
    for (Index k = 0; k < n; k += side)
#pragma GCC unroll 4
        for (int q = 0; q < 8; q += side) {
            Part square[side];
#pragma GCC unroll 4
            for (int i = 0; i < side; ++i) square[i] = *reinterpret_cast<PartAnywhere const*>(x + (q + i) * ld + k);
            turn_square(square);
#pragma GCC unroll 4
            for (int i = 0; i < side; ++i) *reinterpret_cast<PartAnywhere*>(out + (k + i) * 8 + q) = square[i];
        }
}

/// w_c = V'a_c for C columns, V row after row: each sum goes over the rows from the first to the last.
template <class P, int C, class T>
[[gnu::always_inline]] inline void products(T const* V, T const* a, Index ld, Index n, T (&w)[C][8]) {
    constexpr int registers = 8 / P::width;
    typename P::Register sum[C][registers];
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c)
#pragma GCC unroll 16
        for (auto& r : sum[c]) r = typename P::Register{};
    for (Index k = 0; k < n; ++k) {
        typename P::Register v[registers];
#pragma GCC unroll 16
        for (int r = 0; r < registers; ++r) v[r] = P::load(V + 8 * k + r * P::width);
#pragma GCC unroll 16
        for (int c = 0; c < C; ++c) {
            T const x = a[c * ld + k];
#pragma GCC unroll 16
            for (int r = 0; r < registers; ++r) sum[c][r] = sum[c][r] + v[r] * x;
        }
    }
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c)
#pragma GCC unroll 16
        for (int r = 0; r < registers; ++r) P::store(w[c] + r * P::width, sum[c][r]);
}

/// (3) to (5) for C columns from j on; then for the others, C by C, then fewer.
template <class P, int C, class T>
[[gnu::always_inline]] inline void reach_columns(PanelAtWork<T> const& panel, T const (*G)[8], Index n, Index j) {
    using Register = typename P::Register;
    constexpr int registers = 8 / P::width;
    ReflectPanel<T> const& h = panel.h;
    for (; j + C <= h.to; j += C) {
        alignas(64) T t[C][8];
        products<P, C>(h.V, panel.column(j), h.ld, n, t);
        for (int c = 0; c < C; ++c) {
            Register w[registers];
#pragma GCC unroll 16
            for (int m = 0; m < registers; ++m) w[m] = P::load(t[c] + m * P::width);
#pragma GCC unroll 16
            for (int q = 0; q < 8; ++q) {
                T& r = panel.above(q, j + c);
                T const by = panel.beta[q] * (panel.pivot[q] * r + w[q / P::width][q % P::width]);
                r -= by * panel.pivot[q];
                t[c][q] = by;
#pragma GCC unroll 16
                for (int m = q / P::width; m < registers; ++m) w[m] = w[m] - by * P::load(G[q] + m * P::width);
            }
        }
        T const* const v = panel.column(0);
        for (Index k = 0; k < n; k += 8) {
            Register a[C][registers];
#pragma GCC unroll 16
            for (int c = 0; c < C; ++c)
#pragma GCC unroll 16
                for (int r = 0; r < registers; ++r) a[c][r] = P::load(panel.column(j + c) + k + r * P::width);
#pragma GCC unroll 16
            for (int q = 0; q < 8; ++q)
#pragma GCC unroll 16
                for (int r = 0; r < registers; ++r) {
                    Register const x = P::load(v + q * h.ld + k + r * P::width);
#pragma GCC unroll 16
                    for (int c = 0; c < C; ++c) a[c][r] = a[c][r] - t[c][q] * x;
                }
#pragma GCC unroll 16
            for (int c = 0; c < C; ++c)
#pragma GCC unroll 16
                for (int r = 0; r < registers; ++r) P::store(panel.column(j + c) + k + r * P::width, a[c][r]);
        }
    }
    if constexpr (C > 1) reach_columns<P, C / 2>(panel, G, n, j);
}

/// The text for registers. Rows up to a multiple of eight are zeros: they add zeros to sums that are no -0.
template <class P, class T>
    requires(P::width > 1)
[[gnu::always_inline]] inline void evaluate(ReflectPanel<T> const& h) {
    constexpr int abreast = P::width == 8 && sizeof(T) == 8 ? 8 : 4, most_columns = P::width == 8   ? 8
                                                                                    : P::width == 4 ? 5
                                                                                                    : 3;
    Index const n = padded<T, Dynamic>(h.rows);
    PanelAtWork<T> panel(h);
    int const count = panel.count;
    T(*const G)[8] = reinterpret_cast<T(*)[8]>(h.V + 8 * n);
    auto const make_V = [&] {
        turn_into_rows<P>(h.A, h.ld, n, h.V);
        for (int q = 0; q < 8; q += 2)
            products<P, 2>(h.V, panel.column(q), h.ld, n, *reinterpret_cast<T(*)[2][8]>(G[q]));
    };
    using Part = typename ReflectPanel<T>::Part;
    if (h.part == Part::columns || h.part == Part::more_columns) {
        std::copy_n(h.kept, 8, panel.beta), std::copy_n(h.kept + 8, 8, panel.pivot);
        if (h.part == Part::columns) make_V();
        return reach_columns<P, most_columns>(panel, G, n, h.from);
    }
    pass_from_next<P, abreast, false>(panel, -1, n);
    for (int q = 0; q < count; ++q) {
        panel.turn(q);
        if (q + 1 < count) pass_from_next<P, abreast, true>(panel, q, n);
        else pass_on<P, abreast, true, false>(panel, q, q + 1, n);
    }
    if (panel.turned == h.columns)
        return panel.turn_others(
            [&](T const* x, T const* a) {
                T const* const read[1] = {a};
                T sum[1];
                dots<P, 1>(x, read, n, sum);
                return T(0) + sum[0];
            },
            [&](T const& by, T const* x, T* a) {
                for (Index k = 0; k < n; k += P::width) P::store(a + k, P::load(a + k) - by * P::load(x + k));
            });
    if (h.part == Part::pivots) {
        std::copy_n(panel.beta, 8, h.kept), std::copy_n(panel.pivot, 8, h.kept + 8);
    } else {
        make_V();
        reach_columns<P, most_columns>(panel, G, n, 8);
    }
}
