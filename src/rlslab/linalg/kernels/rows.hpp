// Rotations of several rows that are in flight at the same time. Included by dispatch.hpp once for each instruction
// set: no #pragma once.
//
// Rotation i of row r needs what rotation i of row r - 1 left of L, and what rotation i - 1 of row r left of x. So step
// n does rotation n - r of every row r. These need nothing of one another, and each finds the operands that it finds
// when one row follows another.

/// One number of each row in flight: row r in lane r.
template <class T, int Bytes>
struct Abreast : SimdBlock<T, std::min(Bytes, RotateInRows<T>::together* int(sizeof(T))), RotateInRows<T>::together> {
    using Block = SimdBlock<T, std::min(Bytes, RotateInRows<T>::together* int(sizeof(T))), RotateInRows<T>::together>;
    using typename Block::Mask, typename Block::V, typename Block::Word;
    using Block::add_product, Block::registers, Block::rows, Block::scale, Block::subtract_product, Block::v, Block::W;

    [[gnu::always_inline]] void add_product(Abreast const& a, Abreast const& b) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = v[m] + a.v[m] * b.v[m];
    }
    [[gnu::always_inline]] void subtract_product(Abreast const& a, Abreast const& b) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = v[m] - a.v[m] * b.v[m];
    }
    [[gnu::always_inline]] friend Abreast const& conjugate(Abreast const& a) { return a; }  // of real numbers
    /// Row r takes number q - r of the `count` numbers at x + r ld, or 0 where there is none; put together in
    /// registers: narrow stores do not forward to a wide load.
    [[gnu::always_inline]] void gather(T const* x, Index ld, int q, int count) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m)
            v[m] = gathered(x, ld, q, count, m * W, std::make_integer_sequence<int, W>());
    }
    /// Row r takes row r - 1's number, the first row takes `first`.
    [[gnu::always_inline]] void pass_on(T first) {
        V before;  // not 0 + first, which is another number for -0
#pragma GCC unroll 16
        for (int i = 0; i < W; ++i) before[i] = first;
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) {
            V const here = v[m];
            v[m] = shifted(before, here, std::make_integer_sequence<int, W>());
            before = here;
        }
    }
    [[gnu::always_inline]] T last() const { return v[registers - 1][W - 1]; }

    /// Rows for which something holds.
    struct Where {
        Mask in[registers];
    };
    [[gnu::always_inline]] static Where within(RowRange p) {
        Where out;
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) {
            Mask row;
#pragma GCC unroll 16
            for (int i = 0; i < W; ++i) row[i] = Word(m * W + i);
            out.in[m] = (row >= Mask{} + Word(p.first)) & (row < Mask{} + Word(p.last));
        }
        return out;
    }
    [[gnu::always_inline]] Where zeros() const {
        Where out;
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) out.in[m] = v[m] == V{};
        return out;
    }
    /// The number where the condition holds, a elsewhere; and the other way round.
    [[gnu::always_inline]] void only(Where const& here, Abreast const& a) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = here.in[m] ? v[m] : a.v[m];
    }
    [[gnu::always_inline]] void replace(Where const& there, Abreast const& a) {
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m) v[m] = there.in[m] ? a.v[m] : v[m];
    }
    [[gnu::always_inline]] void fill(T a) {
#pragma GCC unroll 16
        for (V& r : v) r = V{} + a;
    }
    /// Whether every number lies above `least` and is finite, but for the rows `aside`.
    [[gnu::always_inline]] bool in_range(T least, Where const& aside) const {
        Mask out = Mask{} - 1;
#pragma GCC unroll 16
        for (int m = 0; m < registers; ++m)
            out = out & (aside.in[m] | ((V{} + least < v[m]) & (v[m] <= V{} + std::numeric_limits<T>::max())));
        return holds_in_all<T>(out);
    }

private:
    // Functions, not lambdas, which GCC does not inline in large files.
    [[gnu::always_inline]] static T number(T const* x, Index ld, int q, int count, int r) {
        return 0 <= q - r && q - r < count ? x[r * ld + q - r] : T(0);
    }
    template <int... i>
    [[gnu::always_inline]] static V gathered(T const* x, Index ld, int q, int count, int r,
                                             std::integer_sequence<int, i...>) {
        return V{number(x, ld, q, count, r + i)...};
    }
    template <int... i>
    [[gnu::always_inline]] static V shifted(V const& before, V const& here, std::integer_sequence<int, i...>) {
        return __builtin_shufflevector(before, here, (W - 1 + i)...);
    }
};

/// Row by row, where a square overflows or underflows in one of them.
template <class R>
[[gnu::noinline]] void givens_one_by_one(R const& a, R const& b, R& c, R& s, R& r) {
    typename R::scalar x[R::rows], y[R::rows], turn[3][R::rows];
    a.store(x), b.store(y);
    for (int i = 0; i < R::rows; ++i) {
        auto const one = givens(x[i], y[i]);
        turn[0][i] = one.c, turn[1][i] = one.s, turn[2][i] = one.r;
    }
    c.load(turn[0]), s.load(turn[1]), r.load(turn[2]);
}
/// The rotations that make b zero against a >= 0, each with the bits of givens(a, b).
template <class R>
[[gnu::always_inline]] inline void givens(R const& a, R const& b, R& c, R& s, R& r) {
    using T = typename R::scalar;
    auto const nothing = b.zeros();
    R square = b, sum = a;
    square.scale(b);
    sum.scale(a);
    sum.add(square);
    if (!sum.in_range(least_sum_of_squares<T>(), nothing)) return givens_one_by_one(a, b, c, s, r);
    r = sum;
    r.square_root_each();
    c = a, s = b;
    c.divide(r);
    s.divide(r);
    R one, zero;
    one.fill(T(1)), zero.zero();
    c.replace(nothing, one);
    s.replace(nothing, zero);
    r.replace(nothing, a);
}

/// The corner of L on the diagonal at i0. A column of it goes from memory to the first row in flight, from row to row
/// with each step, and from the last row back to memory.
template <class B>
struct Corner {
    using T = typename B::scalar;
    using R = Abreast<T, sizeof(typename B::V)>;
    static constexpr int count = R::rows, steps = B::rows + count - 1;
    R x[steps + B::rows];       // x[q]: number q - r of row r
    R column[B::rows], z, eta;  // column[j]: number j below the diagonal of the column that row r has reached
    T c[steps][count], s[steps][count];

    T const& cosine(Index r, Index i) const { return c[i + r][r]; }
    T const& sine(Index r, Index i) const { return s[i + r][r]; }

    /// m: columns of the corner. A row that has not begun, or is through, turns by nothing and keeps its numbers: 0
    /// times an infinity would not. What is computed beside the corner's numbers reaches padding at most.
    template <int n>
    [[gnu::always_inline]] void advance(RotateInRows<T> const& k, Index i0, Index m) {
        constexpr int numbers = std::min(B::rows, steps - n);
        T* const from = k.L + (i0 + std::min<Index>(n, m - 1)) * k.ld + i0 +
                        n;  // behind the last column it is no matter what is read
#pragma GCC unroll 16
        for (int j = 0; j < numbers; ++j) column[j].pass_on(n + j < B::rows ? from[j] : T(0));
        z.pass_on(n < B::rows ? k.z[i0 + n] : T(0));
        auto const turning = R::within({n - m + 1, n + 1});
        R a = column[0], b = x[n], turn_c, turn_s, keep;
        a.scale(k.root_lambda);
        keep.zero();
        b.only(turning, keep);
        givens(a, b, turn_c, turn_s, column[0]);
#pragma GCC unroll 16
        for (int j = 1; j < numbers; ++j) {
            keep = x[n + j];
            rotate(column[j], x[n + j], k.root_lambda, turn_c, turn_s);
            if (n + 1 < count) x[n + j].only(turning, keep);
        }
        keep = eta;
        rotate(z, eta, k.root_lambda, turn_c, turn_s);
        eta.only(turning, keep);
        turn_c.store(c[n]), turn_s.store(s[n]);
        if constexpr (n >= count - 1) {
            T* const to = k.L + (i0 + n - (count - 1)) * (k.ld + 1);
#pragma GCC unroll 16
            for (int j = 0; j < numbers; ++j) to[j] = column[j].last();
            k.z[i0 + n - (count - 1)] = z.last();
        }
        if constexpr (n + 1 < steps)
            if (n + 1 < m + count - 1) advance<n + 1>(k, i0, m);
    }
    [[gnu::always_inline]] void finish(RotateInRows<T> const& k, Index i0, Index m) {
#pragma GCC unroll 32
        for (int q = 0; q < steps; ++q) x[q].gather(k.x + i0, k.ld, q, B::rows);
#pragma GCC unroll 16
        for (R& number : column) number.zero();
        z.zero();
        eta.load(k.eta);
        advance<0>(k, i0, m);
        eta.store(k.eta);
        for (Index r = 0; r < count; ++r)
            for (Index i = 0; i < m; ++i) {
                k.c[r * k.ld + i0 + i] = cosine(r, i);
                k.s[r * k.ld + i0 + i] = sine(r, i);
            }
    }
    /// The corner's rotations, applied to block j0 below it.
    [[gnu::always_inline]] void apply(RotateInRows<T> const& k, Index i0, Index j0) const {
        B below[count];
#pragma GCC unroll 16
        for (int r = 0; r < count; ++r) below[r].load(k.x + r * k.ld + j0);
        for (int i = 0; i < B::rows; ++i) {
            T* const here = k.L + (i0 + i) * k.ld + j0;
            B t;
            t.load(here);
#pragma GCC unroll 16
            for (int r = 0; r < count; ++r) rotate(t, below[r], k.root_lambda, cosine(r, i), sine(r, i));
            t.store(here);
        }
#pragma GCC unroll 16
        for (int r = 0; r < count; ++r) below[r].store(k.x + r * k.ld + j0);
    }
};

template <class B, class T>
[[gnu::always_inline]] inline void evaluate(RotateInRows<T> const& k) {
    for (Index i0 = 0; i0 < k.d; i0 += B::rows) {
        Corner<B> corner;
        corner.finish(k, i0, rows_of<B>(i0, k.d).last);
        for (Index j0 = i0 + B::rows; j0 < k.d; j0 += B::rows) corner.apply(k, i0, j0);
    }
}
