// The text of the kernels for fixed sizes up to eight: no loop and no padding, so that what one kernel leaves the next
// finds in registers, at any level of optimisation. The formulas are those of the other texts, and so are the bits.
// Included by dispatch.hpp after them, once: no #pragma once.

/// How N rows are held: the first `wide` in registers, the others one by one, in each kernel alike, because a number
/// that is stored with its neighbour and read alone, or the other way round, waits in the store buffer. For two rows a
/// register is slower than two numbers, and on a Cortex-M, which has none for several, all are numbers. Clang packs
/// numbers into registers itself; given a register times a number, it loads that number together with its neighbour in
/// memory, too early.
template <class T, int N>
struct SmallRows {
    using Wide = SimdBlock<T, 16, 16 / int(sizeof(T))>;
#ifdef __clang__
    static constexpr int wide = 0;
#else
    static constexpr int wide = N <= 2 || !Hardware<T> ? 0 : N / Wide::rows * Wide::rows;
#endif
    using Blocks = std::make_integer_sequence<int, wide / Wide::rows>;
    using Rest = std::make_integer_sequence<int, N - wide>;
};

// --- elementwise -----------------------------------------------------------------------------------------------------

template <class B, class K>
[[gnu::always_inline]] inline void apply_at(K const& k, Index i0) {
    B x = block_of<B>(k.x, i0);
    apply(k, i0, x);
    x.store(k.out + i0);
}
template <class B, class K, int... m>
[[gnu::always_inline]] inline void apply_in(K const& k, [[maybe_unused]] Index first,
                                            std::integer_sequence<int, m...>) {
    (apply_at<B>(k, first + m * B::rows), ...);
}
template <int N, class T, Elementwise K>
[[gnu::always_inline]] inline void evaluate_small(K const& k) {
    using Rows = SmallRows<T, N>;
    apply_in<typename Rows::Wide>(k, 0, typename Rows::Blocks());
    apply_in<ScalarRow<T>>(k, Rows::wide, typename Rows::Rest());
}

/// N numbers that are not in memory, stored as other kernels read them.
template <class B, class T>
[[gnu::always_inline]] inline void store_block(T const* x, T* out) {
    B block;
    if constexpr (B::rows == 1) block.load(x);
    else block.put_together(x);
    block.store(out);
}
template <class B, class T, int... m>
[[gnu::always_inline]] inline void store_in([[maybe_unused]] T const* x, [[maybe_unused]] T* out,
                                            std::integer_sequence<int, m...>) {
    (store_block<B>(x + m * B::rows, out + m * B::rows), ...);
}
template <int N, class T>
[[gnu::always_inline]] inline void store_small(T const (&x)[N], T* out) {
    using Rows = SmallRows<T, N>;
    store_in<typename Rows::Wide>(x, out, typename Rows::Blocks());
    store_in<ScalarRow<T>>(x + Rows::wide, out + Rows::wide, typename Rows::Rest());
}

/// after_j = s + (x_0 + ... + x_j), before_j = after_{j-1}, from j on; sum: x_0 + ... + x_{j-1}.
template <int j, int N, class T>
[[gnu::always_inline]] inline void sums_from(T const* x, T const& s, T sum, T (&before)[N], T (&after)[N]) {
    sum = j == 0 ? x[0] : sum + x[j];
    before[j] = j == 0 ? s : after[j == 0 ? 0 : j - 1];
    after[j] = s + sum;
    if constexpr (j + 1 < N) sums_from<j + 1>(x, s, sum, before, after);
}
template <int N, class T>
[[gnu::always_inline]] inline void evaluate_small(PrefixSums<T> const& k) {
    T before[N], after[N];
    sums_from<0>(k.x, *k.s, T(0), before, after);
    *k.s = after[N - 1];
    store_small(before, k.before);
    store_small(after, k.out);
}

template <class T, int... i>
[[gnu::always_inline]] inline bool no_difference(T const* x, std::integer_sequence<int, i...>) {
    return ((x[i] - x[i]) + ...) == T(0);
}
template <int N, class T>
[[gnu::always_inline]] inline void evaluate_small(AllFinite<T> const& k) {
    *k.finite = no_difference(k.x, std::make_integer_sequence<int, N>());
}

// --- products and sweeps ---------------------------------------------------------------------------------------------

template <int N, class T, Shape shape, int... j>
[[gnu::always_inline]] inline void multiply_columns(MultiplyTransposed<T, shape> const& k,
                                                    std::integer_sequence<int, j...>) {
    T const out[N] = {detail::lanes_summed<0, 1>(k.A + j * k.ld, k.x, shape == Shape::full ? N : j + 1)...};
    store_small(out, k.out);
}
template <int N, class T, Shape shape>
[[gnu::always_inline]] inline void evaluate_small(MultiplyTransposed<T, shape> const& k) {
    multiply_columns<N>(k, std::make_integer_sequence<int, N>());
}

template <class B, class S>
[[gnu::always_inline]] inline void begin_at(S const& s, Index i0, B& w) {
    if constexpr (S::starts == Start::column) w.load(s.w + i0);
    else if constexpr (S::starts == Start::zero) w.zero();
    else w.load(s.A + i0), w.scale(s.at(0));
}
template <class B, class S, class At>
[[gnu::always_inline]] inline void step_at(S const& s, At const& at, Index i0, Index j, B& w) {
    if (S::upper && i0 > j) return;
    B t = block_of<B>(s.A + j * s.ld, i0);
    step(s, at, t, w);
    if constexpr (S::writes) t.store(s.A + j * s.ld + i0);
}
template <int j, int N, class S, class B, int... m>
[[gnu::always_inline]] inline void steps_from(S const& s, Index first, B* w, std::integer_sequence<int, m...> blocks) {
    auto const at = s.at(j);
    (step_at(s, at, first + m * B::rows, j, w[m]), ...);
    if constexpr (j + 1 < N) steps_from<j + 1, N>(s, first, w, blocks);
}
template <class B, int N, class S, int... m>
[[gnu::always_inline]] inline void sweep_in(S const& s, Index first, std::integer_sequence<int, m...> blocks) {
    if constexpr (sizeof...(m) > 0) {
        constexpr int from = S::starts == Start::first_product;
        B w[sizeof...(m)];
        (begin_at(s, first + m * B::rows, w[m]), ...);
        if constexpr (from < N) steps_from<from, N>(s, first, w, blocks);
        if constexpr (S::starts != Start::column) (w[m].store(s.w + first + m * B::rows), ...);
    }
}
template <int N, class T, Sweep S>
[[gnu::always_inline]] inline void evaluate_small(S const& s) {
    using Rows = SmallRows<T, N>;
    sweep_in<typename Rows::Wide, N>(s, 0, typename Rows::Blocks());
    sweep_in<ScalarRow<T>, N>(s, Rows::wide, typename Rows::Rest());
}
template <int N, class T, Sweep S>
void evaluate_small(ThenMultiply<S> const&) = delete;  // so small a P is not multiplied ahead
// The one block of so small a SymmetricMatrix is a square. But below the diagonal w_j f_i is subtracted, not w_i f_j.
template <int N, class T>
void evaluate_small(OnBlocks<SubtractRankOne<T>> const&) = delete;
