// Products of a matrix and four vectors side by side: number j of vector i is v[4 j + i]. Included by
// adapt/probes.hpp once for each instruction set, each time in a namespace of its own: no #pragma once.
//
// A matrix is what has a(i, j); `widened` turns its numbers into L. A dot product has four running sums, of j = 0, 1,
// 2, 3 mod 4 from its first number on, then (0 + 2) + (1 + 3); all else is a sum of columns, the first column first.

template <class L>
struct Four {
    L of[4];
    [[gnu::always_inline]] void load(L const* v) {
        for (int i = 0; i < 4; ++i) of[i] = v[i];
    }
    [[gnu::always_inline]] void store(L* v) const {
        for (int i = 0; i < 4; ++i) v[i] = of[i];
    }
    [[gnu::always_inline]] void add(Four const& x) {
        for (int i = 0; i < 4; ++i) of[i] += x.of[i];
    }
    [[gnu::always_inline]] void add_product(L const& a, Four const& x) {
        for (int i = 0; i < 4; ++i) of[i] += a * x.of[i];
    }
    [[gnu::always_inline]] void add_square(L const& a, Four const& x) {
        for (int i = 0; i < 4; ++i) of[i] += a * x.of[i] * x.of[i];
    }
};
template <>
struct Four<double> {
    typedef double V __attribute__((vector_size(32)));
    typedef double Anywhere __attribute__((vector_size(32), aligned(alignof(double)), may_alias));
    V of;
    [[gnu::always_inline]] void load(double const* v) { of = *reinterpret_cast<Anywhere const*>(v); }
    [[gnu::always_inline]] void store(double* v) const { *reinterpret_cast<Anywhere*>(v) = of; }
    [[gnu::always_inline]] void add(Four const& x) { of += x.of; }
    [[gnu::always_inline]] void add_product(double a, Four const& x) { of += a * x.of; }
    [[gnu::always_inline]] void add_square(double a, Four const& x) { of += a * x.of * x.of; }
};

template <class L>
struct ByFour {
    /// sum_j a(j) v_j, first <= j < end, end > first or zero.
    template <class A>
    [[gnu::always_inline]] static void dot(A const& a, L const* v, Index first, Index end, Four<L>& out) {
        Four<L> sum[4] = {}, x;
        Index j = first;
        for (; j + 4 <= end; j += 4)
#pragma GCC unroll 4
            for (int c = 0; c < 4; ++c) {
                x.load(v + 4 * (j + c));
                sum[c].add_product(widened<L>(a(j + c)), x);
            }
#pragma GCC unroll 3
        for (int c = 0; c < 3; ++c)
            if (j + c < end) {
                x.load(v + 4 * (j + c));
                sum[c].add_product(widened<L>(a(j + c)), x);
            }
        sum[0].add(sum[2]);
        sum[1].add(sum[3]);
        sum[0].add(sum[1]);
        out = sum[0];
    }
    /// v_i += sum_c a(i, c) by_c, first <= i < end.
    template <int C, class A>
    [[gnu::always_inline]] static void add(A const& a, Four<L> const (&by)[C], L* v, Index first, Index end) {
        for (Index i = first; i < end; ++i) {
            Four<L> sum;
            sum.load(v + 4 * i);
#pragma GCC unroll 4
            for (int c = 0; c < C; ++c) sum.add_product(widened<L>(a(i, c)), by[c]);
            sum.store(v + 4 * i);
        }
    }
    /// The same for columns j ... j + C - 1 of a matrix times from_j ... .
    template <int C, class A>
    [[gnu::always_inline]] static void add_columns(A const& a, Index j, L const* from, L* v, Index first, Index end) {
        Four<L> by[C];
        for (int c = 0; c < C; ++c) by[c].load(from + 4 * (j + c));
        add([&](Index i, int c) { return a(i, j + c); }, by, v, first, end);
    }

    /// m_i += w psi psi'x_i; vector `of_y`, if it is one of the four, += w y psi.
    static void row(L const* psi, Index d, L const& w, L const& wy, int of_y, L const* x, L* m) {
        Four<L> by[1];
        dot([psi](Index j) { return psi[j]; }, x, 0, d, by[0]);
#pragma GCC unroll 4
        for (int i = 0; i < 4; ++i) by[0].of[i] = i == of_y ? wy : L(by[0].of[i] * w);
        add([psi](Index i, int) { return psi[i]; }, by, m, 0, d);
    }
    /// x_i += w psi_i^2: numbers one by one, not vectors.
    static void squares(L const* psi, Index d, L const& w, L* x) {
        Index const whole = d - d % 4;
        for (Index j = 0; j < whole; j += 4) {
            Four<L> sum, row;
            sum.load(x + j), row.load(psi + j);
            sum.add_square(w, row);
            sum.store(x + j);
        }
        for (Index j = whole; j < d; ++j) x[j] += w * psi[j] * psi[j];
    }
    /// v = A v; `copy` is workspace.
    template <class A>
    static void full(A const& a, L* v, L* copy, Index d) {
        std::copy_n(v, 4 * d, copy);
        std::fill_n(v, 4 * d, L(0));
        Index j = 0;
        for (; j + 4 <= d; j += 4) add_columns<4>(a, j, copy, v, 0, d);
        for (; j < d; ++j) add_columns<1>(a, j, copy, v, 0, d);
    }
    /// v = A'v, A full or an upper triangle.
    template <class A>
    static void transposed(A const& a, L* v, L* copy, Index d, bool triangle) {
        if (!triangle) std::copy_n(v, 4 * d, copy);
        for (Index j = d - 1; j >= 0; --j) {
            Four<L> sum;
            dot([&](Index i) { return a(i, j); }, triangle ? v : copy, 0, triangle ? j + 1 : d, sum);
            sum.store(v + 4 * j);
        }
    }
    /// v = A v, A an upper triangle.
    template <class A>
    static void upper(A const& a, L* v, Index d) {
        for (Index j = 0; j < d; j += 4) {
            Index const end = std::min<Index>(j + 4, d);
            if (end == j + 4) add_columns<4>(a, j, v, v, 0, j);
            for (Index k = j; k < end; ++k) {
                add_columns<1>(a, k, v, v, end == j + 4 ? j : 0, k);
                for (int i = 0; i < 4; ++i) v[4 * k + i] *= widened<L>(a(k, k));
            }
        }
    }
    /// v = A^-T D^-1 A^-1 v, A a lower triangle.
    template <class A, class Over>
    static void solve(A const& a, Over over, L* v, Index d) {
        Four<L> sum[1];
        for (Index j = 0; j < d; ++j) {
            for (int i = 0; i < 4; ++i) v[4 * j + i] /= -widened<L>(a(j, j));
            sum[0].load(v + 4 * j);
            add([&](Index i, int) { return a(i, j); }, sum, v, j + 1, d);
            for (int i = 0; i < 4; ++i) v[4 * j + i] /= -over(j);
        }
        for (Index j = d - 1; j >= 0; --j) {
            dot([&](Index i) { return a(i, j); }, v, j + 1, d, sum[0]);
            for (int i = 0; i < 4; ++i) v[4 * j + i] = (v[4 * j + i] - sum[0].of[i]) / widened<L>(a(j, j));
        }
    }
};
