// The loops of a Householder reflection on columns of any length, with one order of evaluation for registers of any
// width. Included by dispatch.hpp once for each instruction set, each time in a namespace of its own: no #pragma once.

/// A register that is one number, for every arithmetic: eight of them are the running lanes.
template <class T>
struct Lane {
    using scalar = T;
    using Register = T;
    using Sum = Accumulator<T>;
    static constexpr int width = 1, columns = 1;  // one column after another, as the formula reads
    template <class X>
    static X const& load(X const* x) {
        return *x;
    }
    template <class X>
    static void store(X* to, std::type_identity_t<X> const& x) {
        *to = x;
    }
};

/// Registers of `bytes` bytes, which together hold the eight running lanes. `columns` columns at once keep eight
/// registers busy.
template <class T, int bytes>
struct Packed {
    using scalar = T;
    typedef T Register __attribute__((vector_size(bytes)));
    typedef T Anywhere __attribute__((vector_size(bytes), aligned(alignof(T)), may_alias));
    using Sum = Register;
    static constexpr int width = bytes / int(sizeof(T)), columns = width;
    [[gnu::always_inline]] static Register load(T const* x) { return *reinterpret_cast<Anywhere const*>(x); }
    [[gnu::always_inline]] static void store(T* to, Register const& x) { *reinterpret_cast<Anywhere*>(to) = x; }
};

/// v'a for n < 8 numbers: the tree without the lanes that do not exist.
template <class T>
T short_dot(T const* v, T const* a, Index n) {
    Accumulator<T> lane[8]{};  // otherwise g++ 12 warns in every file that includes this
    for (Index i = 0; i < n; ++i) lane[i] = v[i] * a[i];
    for (Index half = 4; half >= 1; half /= 2)
        for (Index i = 0; i < half && i + half < n; ++i) lane[i] += lane[i + half];
    return lane[0];
}

/// v'a_c for C columns at once, each in eight running lanes, then the tree ((0+4)+(2+6)) + ((1+5)+(3+7)); n >= 1.
template <class P, int C, class T = typename P::scalar>
[[gnu::always_inline]] inline void dots(T const* v, T const* const (&a)[C], Index n, T (&out)[C]) {
    if (n < 8) {
        for (int c = 0; c < C; ++c) out[c] = short_dot(v, a[c], n);
        return;
    }
    constexpr int registers = 8 / P::width;
    typename P::Sum sum[C][registers];
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c)
#pragma GCC unroll 16
        for (int r = 0; r < registers; ++r) sum[c][r] = P::load(v + r * P::width) * P::load(a[c] + r * P::width);
    Index k = 8;
    for (; k + 8 <= n; k += 8)
#pragma GCC unroll 16
        for (int r = 0; r < registers; ++r) {
            typename P::Register const x = P::load(v + k + r * P::width);
#pragma GCC unroll 16
            for (int c = 0; c < C; ++c) sum[c][r] += x * P::load(a[c] + k + r * P::width);
        }
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c) {
        alignas(64) Accumulator<T> lane[8];
        if (k < n) {  // the last few numbers go to the first few lanes
#pragma GCC unroll 16
            for (int r = 0; r < registers; ++r) P::store(lane + r * P::width, sum[c][r]);
            for (Index i = 0; k + i < n; ++i) lane[i] += v[k + i] * a[c][k + i];
#pragma GCC unroll 16
            for (int r = 0; r < registers; ++r) sum[c][r] = P::load(lane + r * P::width);
        }
#pragma GCC unroll 16
        for (int half = registers / 2; half >= 1; half /= 2)
#pragma GCC unroll 16
            for (int r = 0; r < half; ++r) sum[c][r] += sum[c][r + half];
        P::store(lane, sum[c][0]);
#pragma GCC unroll 16
        for (int half = P::width / 2; half >= 1; half /= 2)
#pragma GCC unroll 16
            for (int i = 0; i < half; ++i) lane[i] += lane[i + half];
        out[c] = lane[0];
    }
}

/// t = tau (above + v'a),  above -= t,  a -= t v, for C columns.
template <class P, int C, class T = typename P::scalar>
[[gnu::always_inline]] inline void reflect_columns(Reflection<T> const& h, Index j) {
    T *a[C], *above[C];
    T const* read[C];
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c) {
        read[c] = a[c] = h.A + (j + c) * h.ld;
        above[c] = j + c + 1 < h.columns ? h.above + j + c : h.last;
    }
    T t[C];
    dots<P, C>(h.v, read, h.rows, t);
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c) {
        t[c] = h.tau * (*above[c] + t[c]);
        *above[c] -= t[c];
        t[c] = -t[c];
    }
    Index k = 0;
    for (; k + 8 <= h.rows; k += 8)
#pragma GCC unroll 16
        for (int r = 0; r < 8; r += P::width) {
            typename P::Register const x = P::load(h.v + k + r);
#pragma GCC unroll 16
            for (int c = 0; c < C; ++c) P::store(a[c] + k + r, P::load(a[c] + k + r) + t[c] * x);
        }
    for (; k < h.rows; ++k)
#pragma GCC unroll 16
        for (int c = 0; c < C; ++c) a[c][k] += t[c] * h.v[k];
}

template <class P, class T>
[[gnu::always_inline]] inline void evaluate(Reflection<T> const& h) {
    Index j = 0;
    for (; j + P::columns <= h.columns; j += P::columns) reflect_columns<P, P::columns>(h, j);
    if constexpr (P::columns > 4)
        if (j + 4 <= h.columns) reflect_columns<P, 4>(h, j), j += 4;
    if constexpr (P::columns > 2)
        if (j + 2 <= h.columns) reflect_columns<P, 2>(h, j), j += 2;
    if constexpr (P::columns > 1)
        if (j < h.columns) reflect_columns<P, 1>(h, j);
}

/// v'v.
template <class P, class T>
[[gnu::always_inline]] inline void evaluate(SumOfSquares<T> const& s) {
    T const* const x[1] = {s.v};
    T out[1];
    dots<P, 1>(s.v, x, s.rows, out);
    *s.sum = out[0];
}

/// v /= pivot.
template <class P, class T>
[[gnu::always_inline]] inline void evaluate(Division<T> const& s) {
    Index k = 0;
    for (; k + 8 <= s.rows; k += 8)
#pragma GCC unroll 16
        for (int r = 0; r < 8; r += P::width) P::store(s.v + k + r, P::load(s.v + k + r) / s.pivot);
    for (; k < s.rows; ++k) s.v[k] /= s.pivot;
}
