// The two types in which the texts of the kernels are written: one row (ScalarRow), or a block of eight (SimdBlock;
// four for the smallest fixed sizes). Included by dispatch.hpp once for each instruction set, each time in a namespace
// of its own: no #pragma once.
//
// ScalarRow works in every arithmetic. SimdBlock holds whole registers. Rows that do not exist are padding, which may
// hold any number; sums mask it out. Both types have the same members, so that one text serves both.

template <class T>
struct ScalarRow {
    using scalar = T;
    static constexpr int rows = 1, registers = 2;  // as many as fit if T is a Pack
    static constexpr bool padded = false, wide = false;
    Accumulator<T> x;

    [[gnu::always_inline]] void zero() { x = T(0); }
    [[gnu::always_inline]] void empty_sum() { x = -T(0); }
    [[gnu::always_inline]] void load(T const* from) { x = *from; }
    [[gnu::always_inline]] void store(T* to) const { *to = x; }
    [[gnu::always_inline]] void scale(T const& a) { x *= a; }
    [[gnu::always_inline]] void divide(T const& a) { x /= a; }
    [[gnu::always_inline]] void scale(ScalarRow const& a) { x *= a.x; }
    [[gnu::always_inline]] void divide(ScalarRow const& a) { x /= a.x; }
    [[gnu::always_inline]] void subtract(ScalarRow const& a) { x -= a.x; }
    [[gnu::always_inline]] void add(ScalarRow const& a) { x += a.x; }
    [[gnu::always_inline]] void square_root_each() {
        if constexpr (Hardware<T>) {  // as an instruction: a call that may set errno would spill the other registers
            typedef T Two __attribute__((vector_size(16)));
            x = root_of_each(Two{x})[0];
        } else {
            x = square_root(x);
        }
    }
    [[gnu::always_inline]] void clear(Truth<T> const& where) { x = select(where, T(0), x); }
    [[gnu::always_inline]] void set(ScalarRow const& a) { x = a.x; }
    [[gnu::always_inline]] void add_product(ScalarRow const& a, T const& b) { x += a.x * b; }
    [[gnu::always_inline]] void subtract_product(ScalarRow const& a, T const& b) { x -= a.x * b; }
};

/// The row of a complex matrix: the factors are complex or real. A product with a complex factor is not conjugated
/// here.
template <class F>
struct ScalarRow<Complex<F>> {
    using scalar = Complex<F>;
    static constexpr int rows = 1, registers = 2;
    static constexpr bool padded = false, wide = false;
    scalar x;

    [[gnu::always_inline]] void zero() { x = scalar(0); }
    [[gnu::always_inline]] void load(scalar const* from) { x = *from; }
    [[gnu::always_inline]] void store(scalar* to) const { *to = x; }
    template <class A>
    [[gnu::always_inline]] void scale(A const& a) {
        x *= a;
    }
    [[gnu::always_inline]] void subtract(ScalarRow const& a) { x -= a.x; }
    [[gnu::always_inline]] void add(ScalarRow const& a) { x += a.x; }
    [[gnu::always_inline]] void clear(Truth<F> const& where) { x = select(where, scalar(0), x); }
    [[gnu::always_inline]] void set(ScalarRow const& a) { x = a.x; }
    template <class A>
    [[gnu::always_inline]] void add_product(ScalarRow const& a, A const& b) {
        x += a.x * b;
    }
    template <class A>
    [[gnu::always_inline]] void subtract_product(ScalarRow const& a, A const& b) {
        x -= a.x * b;
    }
};

template <class T, int Bytes, int Rows = 8>
struct SimdBlock {
    using scalar = T;
    using Word = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;
    typedef T V __attribute__((vector_size(Bytes)));
    typedef T Anywhere __attribute__((vector_size(Bytes), aligned(alignof(T)), may_alias));
    typedef Word Mask __attribute__((vector_size(Bytes)));
    typedef Word MaskAnywhere __attribute__((vector_size(Bytes), aligned(alignof(Word)), may_alias));
    static constexpr int rows = Rows, W = Bytes / int(sizeof(T)), registers = Rows / W;
    static constexpr bool padded = true, wide = Bytes == 64;
    static_assert(Rows % W == 0);
    V v[registers];

    [[gnu::always_inline]] void zero() {
#pragma GCC unroll 16
        for (V& r : v) r = V{};
    }
    [[gnu::always_inline]] void empty_sum() {
#pragma GCC unroll 16
        for (V& r : v) r = -V{};
    }
    [[gnu::always_inline]] void load(T const* from) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = *reinterpret_cast<Anywhere const*>(from + m * W);
    }
    [[gnu::always_inline]] void load_unpadded(T const* from, RowRange p) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) {
            Index const left = p.last - m * W;
            T const* const at = from + m * W;
            v[m] = V{};
            if (left >= W) {
                v[m] = *reinterpret_cast<Anywhere const*>(at);
#ifdef __x86_64__  // not through an array: narrow stores do not forward to a wide load, which would wait
            } else if constexpr (Bytes == 64) {
                v[m] = V(__builtin_ia32_loadupd512_mask(at, V{}, first_lanes(left)));
            } else if constexpr (Bytes == 32 && sizeof(T) == 8) {
                typedef long long Lanes __attribute__((vector_size(Bytes)));
                v[m] = V(
                    __builtin_ia32_maskloadpd256(reinterpret_cast<V const*>(at), Lanes(mask(left < 0 ? 0 : left, 0))));
            } else if constexpr (Bytes == 32) {
                v[m] = V(__builtin_ia32_maskloadps256(reinterpret_cast<V const*>(at), mask(left, 0)));
            } else if constexpr (W == 2) {
                if (left == 1) v[m] = V(_mm_load_sd(at));
#endif
            } else if (left > 0) {
                for (Index i = 0; i < left; ++i) v[m][i] = at[i];
            }
        }
    }
    [[gnu::always_inline]] void store(T* to) const {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) *reinterpret_cast<Anywhere*>(to + m * W) = v[m];
    }
    /// Writes the rows in p; the others keep their values in memory.
    [[gnu::always_inline]] void store_present(T* to, RowRange p) const {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) {
            auto* const there = reinterpret_cast<Anywhere*>(to + m * W);
            Mask const here = mask(p.last, m) & ~mask(p.first, m);
            *there = V((here & Mask(v[m])) | (~here & Mask(V(*there))));
        }
    }
    [[gnu::always_inline]] void set(SimdBlock const& a) { *this = a; }
    [[gnu::always_inline]] void scale(T a) {
#pragma GCC unroll 16
        for (V& r : v) r = r * a;
    }
    [[gnu::always_inline]] void divide(T a) {
#pragma GCC unroll 16
        for (V& r : v) r = r / a;
    }
    [[gnu::always_inline]] void scale(SimdBlock const& a) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = v[m] * a.v[m];
    }
    [[gnu::always_inline]] void divide(SimdBlock const& a) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = v[m] / a.v[m];
    }
    [[gnu::always_inline]] void subtract(SimdBlock const& a) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = v[m] - a.v[m];
    }
    [[gnu::always_inline]] void add(SimdBlock const& a) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = v[m] + a.v[m];
    }
    /// after_i = s + (x_0 + ... + x_i), before_i = after_{i-1}, s = the last after. The vectors are built in registers,
    /// because narrow stores do not forward to the wide loads that follow.
    [[gnu::always_inline]] void accumulate(T& s, SimdBlock& before, SimdBlock& after, RowRange p) const {
        T here[Rows + 1];
        here[0] = T(0);
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) {
            V term = v[m];
            if (p.last < Rows) leave_out(term, p.last, m);
#pragma GCC unroll 16
            for (int i = 0; i < W; ++i) here[m * W + i + 1] = m + i > 0 ? here[m * W + i] + term[i] : term[i];
        }
        before.put_together(here);
        after.put_together(here + 1);
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) {
            before.v[m] = s + before.v[m];
            after.v[m] = s + after.v[m];
        }
        s += here[Rows];
    }
    /// The rows from numbers that are in registers.
    [[gnu::always_inline]] void put_together(T const* x) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) {
            T const* const a = x + m * W;
            if constexpr (W == 2) v[m] = V{a[0], a[1]};
            else if constexpr (W == 4) v[m] = V{a[0], a[1], a[2], a[3]};
            else v[m] = V{a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7]};
        }
    }
    [[gnu::always_inline]] void square_root_each() {
#pragma GCC unroll 16
        for (V& r : v) r = root_of_each(r);
    }
    [[gnu::always_inline]] void add_product(SimdBlock const& a, T b) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = v[m] + a.v[m] * b;
    }
    [[gnu::always_inline]] void subtract_product(SimdBlock const& a, T b) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = v[m] - a.v[m] * b;
    }
    /// Subtracts a b from the rows before `first`, and c d from the other rows.
    template <int first>
    [[gnu::always_inline]] void subtract_either(SimdBlock const& a, T b, SimdBlock const& c, T d) {
        subtract_either_in_each<first>(a, b, c, d, std::make_integer_sequence<int, registers>());
    }
    /// Adds x - x in the rows of p: zero for a number, NaN for an infinity or a NaN.
    [[gnu::always_inline]] void add_difference(SimdBlock const& x, RowRange p) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) {
            V difference = x.v[m] - x.v[m];
            if (p.last < Rows) leave_out(difference, p.last, m);
            v[m] = v[m] + difference;
        }
    }
    [[gnu::always_inline]] bool all_zero() const {
        V sum = v[0];
#pragma GCC unroll 16
        for (int m = 1; m < registers; ++m) sum = sum + v[m];
        Mask const zero = sum == V{};
#ifdef __x86_64__
        if constexpr (Bytes == 64) return __builtin_ia32_cmppd512_mask(sum, V{}, 0, 255, 4) == 255;
#endif
        return holds_in_all<T>(zero);
    }
    /// The running lanes of dot products. A row outside p adds -0, which changes no number, not even a zero. The
    /// functions "_all" are for blocks without padding.
    [[gnu::always_inline]] void start_sum_all(SimdBlock const& a, SimdBlock const& b) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = a.v[m] * b.v[m];
    }
    [[gnu::always_inline]] void start_sum(SimdBlock const& a, SimdBlock const& b, RowRange p) {
        start_sum_all(a, b);
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) leave_out(v[m], p.last, m);
    }
    [[gnu::always_inline]] void sum_all(SimdBlock const& a, SimdBlock const& b) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = v[m] + a.v[m] * b.v[m];
    }
    [[gnu::always_inline]] void sum(SimdBlock const& a, SimdBlock const& b, RowRange p) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) {
            V product = a.v[m] * b.v[m];
            leave_out(product, p.last, m);
            v[m] = v[m] + product;
        }
    }
    /// sum(a, b, {0, count}), count known when this is compiled.
    template <int count>
    [[gnu::always_inline]] void sum_first(SimdBlock const& a, SimdBlock const& b) {
        sum_first_in_each<count>(a, b, std::make_integer_sequence<int, registers>());
    }
    /// ((0+4)+(2+6)) + ((1+5)+(3+7)) of each of four blocks. Always writes four numbers; out is padded.
    [[gnu::always_inline]] static void sums(SimdBlock (&a)[4], T* out) {
        if constexpr (W == 2) {
            V pair[4];
#pragma GCC unroll 16
            for (int c = 0; c < 4; ++c) {
                V const* const r = a[c].v;
                if constexpr (Rows == 8) pair[c] = (r[0] + r[2]) + (r[1] + r[3]);
                else pair[c] = r[0] + r[1];
            }
#pragma GCC unroll 16
            for (int c = 0; c < 4; c += 2)
                *reinterpret_cast<Anywhere*>(out + c) = __builtin_shufflevector(pair[c], pair[c + 1], 0, 2) +
                                                        __builtin_shufflevector(pair[c], pair[c + 1], 1, 3);
        } else {
            typedef T Four __attribute__((vector_size(4 * sizeof(T))));
            typedef T FourAnywhere __attribute__((vector_size(4 * sizeof(T)), aligned(alignof(T)), may_alias));
            Four h[4];
#pragma GCC unroll 16
            for (int c = 0; c < 4; ++c) {
                V const* const r = a[c].v;
                if constexpr (W == 8)
                    h[c] = __builtin_shufflevector(r[0], r[0], 0, 1, 2, 3) +
                           __builtin_shufflevector(r[0], r[0], 4, 5, 6, 7);
                else if constexpr (Rows == 8) h[c] = r[0] + r[1];
                else h[c] = r[0];
            }
            Four const p =
                __builtin_shufflevector(h[0], h[1], 0, 1, 4, 5) + __builtin_shufflevector(h[0], h[1], 2, 3, 6, 7);
            Four const q =
                __builtin_shufflevector(h[2], h[3], 0, 1, 4, 5) + __builtin_shufflevector(h[2], h[3], 2, 3, 6, 7);
            Four const even = __builtin_shufflevector(p, q, 0, 2, 4, 6),
                       odd = __builtin_shufflevector(p, q, 1, 3, 5, 7);
            *reinterpret_cast<FourAnywhere*>(out) = even + odd;
        }
    }

private:
    // Functions, not lambdas, which GCC does not inline in large files.
    template <int first, int... m>
    [[gnu::always_inline]] void subtract_either_in_each(SimdBlock const& a, T b, SimdBlock const& c, T d,
                                                        std::integer_sequence<int, m...>) {
        (subtract_either_in<first - m * W>(v[m], a.v[m], b, c.v[m], d), ...);
    }
    template <int count, int... m>
    [[gnu::always_inline]] void sum_first_in_each(SimdBlock const& a, SimdBlock const& b,
                                                  std::integer_sequence<int, m...>) {
        (sum_first_in<count - m * W>(v[m], a.v[m], b.v[m]), ...);
    }
    template <int count>
    [[gnu::always_inline]] static void sum_first_in(V& x, V const& a, V const& b) {
        if constexpr (count >= W) x = x + a * b;
        else if constexpr (count > 0) x = x + put_together<count>(a * b, -V{}, std::make_integer_sequence<int, W>());
    }
    template <int first, int... i>
    [[gnu::always_inline]] static V put_together(V const& before, V const& after, std::integer_sequence<int, i...>) {
        return __builtin_shufflevector(before, after, (i < first ? i : W + i)...);
    }
    template <int first>
    [[gnu::always_inline]] static void subtract_either_in(V& x, V const& a, T b, V const& c, T d) {
        if constexpr (first >= W) {
            x = x - a * b;
        } else if constexpr (first <= 0) {
            x = x - c * d;
        } else {
            x = x - put_together<first>(a * b, c * d, std::make_integer_sequence<int, W>());
        }
    }
    /// All bits set in the lanes of register m that hold rows < count, none in the others.
    [[gnu::always_inline]] static Mask mask(Index count, int m) {
        alignas(64) static constexpr Word table[16] = {-1, -1, -1, -1, -1, -1, -1, -1, 0, 0, 0, 0, 0, 0, 0, 0};
        return *reinterpret_cast<MaskAnywhere const*>(table + 8 - count + m * W);
    }
    /// The same for the only register of eight rows, as AVX-512 has it: a bit a row.
    [[gnu::always_inline]] static std::uint8_t first_lanes(Index count) { return std::uint8_t(255u >> (8 - count)); }
    [[gnu::always_inline]] static void leave_out(V& product, Index count, int m) {
        Mask const here = mask(count, m);
        product = V((here & Mask(product)) | (~here & Mask(-V{})));
    }
};
