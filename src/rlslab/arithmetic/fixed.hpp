// Fixed point, as in signal processors: words that hold integers, sums of products exact until they are stored.
#pragma once

#include <rlslab/core/encoding.hpp>
#include <rlslab/arithmetic/thread_state.hpp>
#include <rlslab/arithmetic/fixed_format.hpp>
#include <rlslab/arithmetic/storage_traits.hpp>

#include <cmath>
#include <compare>
#include <mutex>

namespace rlslab {

template <FixedFormat F>
class Fixed;
template <FixedFormat F>
class FixedSum;

namespace detail {
template <class X>
struct FormatOf {};
template <FixedFormat F>
struct FormatOf<Fixed<F>> {
    static constexpr FixedFormat value = F;
};
template <FixedFormat F>
struct FormatOf<FixedSum<F>> : FormatOf<Fixed<F>> {};
template <class X>
concept FixedTerm = requires { FormatOf<X>::value; };
/// Terms of one format.
template <class B, class A>
concept TermWith = FixedTerm<B> && FormatOf<A>::value == FormatOf<B>::value;
/// What an operation on such terms gives: a number that is exact until it is stored, or a word at once.
template <class X>
using ResultWith =
    std::conditional_t<FormatOf<X>::value.sums == Sums::exact, FixedSum<FormatOf<X>::value>, Fixed<FormatOf<X>::value>>;
}  // namespace detail

/// A word of F.bits bits that stands for the number n q, q = 2^-F.fraction, -2^(bits-1) <= n < 2^(bits-1):
/// Q15 is {16, 15}, Q31 is {32, 31}; 1 needs an integer bit, bits >= fraction + 2, and every variant uses it.
///
///   a + b, a - b    exact. With Sums::exact the result is a FixedSum: a number of 2 fraction bits in an accumulator of
///                   128 bits, which cannot overflow below 2^32 terms
///   a b             exact likewise. A factor is a word: a FixedSum that is multiplied, or divides, is stored first
///   a / b           the exact quotient of a (which may be a FixedSum) and the word b, rounded once. b = 0: the last
///                   word on a's side, 0 / 0 = 0; marked and counted
///   sqrt(a)         rounded once, by integers. a < 0: 0, marked and counted
///   storing         a FixedSum becomes a word wherever text names it T, puts it in memory, or passes it as T: rounded
///                   once to a multiple of q (F.rounding), then saturated or wrapped to the word (F.overflow)
///   comparisons     exact, also between words and sums
///   from double     rounded to nearest and saturated whatever F says, as converters do; NaN: 0, marked
///   to double       exact; NaN where marked. value() is the word's number, marked or not
///
/// With Sums::rounded every +, -, x stores: "one rounding for each product" instead of "for each sum".
///
/// Overflow is reported as breakdown. A word that overflowed, or was computed from one, is marked: is_finite is false
/// for it, as it is for infinities and NaN elsewhere, and so Step::health is nonfinite. Marks are the emulation's: only
/// is_finite reads them, where a processor would read its status bits. FixedEvents (fixed_events) counts what happened
/// in this thread, and keeps the largest number there was: the integer bits that a filter needs. A sum of squares that
/// overflows and is then divided out first (rotations.hpp) leaves no mark on the result, but is counted.
///
/// What a variant's text assumes of floating point and fixed point lacks: errors relative to the number. lambda is in
/// force as the word for it says (1 - lambda is a multiple of q), P0 must fit, and so must 1/P0 where information is
/// propagated. Sources: Analog Devices, Blackfin Processor Programming Reference (pages read); docs/theory.md 65.
template <FixedFormat F>
class Fixed {
    static_assert(F.bits == 0 || is_fixed_format(F));
    std::int64_t word_ = 0;
    bool marked_ = false;
    friend FixedSum<F>;
    friend Encoding<Fixed>;

    using Wide = detail::Wide;
    struct Made {};
    constexpr Fixed(std::int64_t word, bool marked, Made) : word_(word), marked_(marked) {}

    /// The word for n q, n rounded already from an exact number that is zero or not.
    static Fixed stored(Wide n, bool exactly_zero, bool marked) {
        detail::Word const word = detail::word_for(n, format());
        detail::fixed_events_so_far.underflows += n == 0 && !exactly_zero;
        return {word.n, marked || word.overflowed, Made{}};
    }
    static Fixed from(double x) {
        double const scaled = x * std::ldexp(1.0, format().fraction);
        if (!(scaled == scaled)) return {0, true, Made{}};
        double const far = 0x1p62, near = scaled > far ? far : scaled < -far ? -far : scaled;
        std::int64_t n = std::int64_t(near);
        double const rest = near - double(n);  // exact: beyond 2^53 there is none
        if (rest > 0.5 || (rest == 0.5 && n % 2 != 0)) ++n;
        if (rest < -0.5 || (rest == -0.5 && n % 2 != 0)) --n;
        Wide const limit = Wide(1) << (format().bits - 1);
        Fixed out = stored(n, x == 0, false);
        if (out.marked_) out.word_ = std::int64_t(n < 0 ? -limit : limit - 1);
        return out;
    }

public:
    /// F, or what the thread's FixedScope says.
    static constexpr FixedFormat const& format() {
        if constexpr (F.bits == 0) return FixedScope::format();
        else return FormatConstant::value;
    }

    Fixed() = default;
    explicit Fixed(int n) : Fixed(from(n)) {}
    explicit Fixed(double x) : Fixed(from(x)) {}
    Fixed(FixedSum<F> const& sum) : Fixed(sum.stored()) {}

    std::int64_t word() const { return word_; }
    bool marked() const { return marked_; }
    double value() const { return std::ldexp(double(word_), -format().fraction); }
    explicit operator double() const { return marked_ ? std::numeric_limits<double>::quiet_NaN() : value(); }

    friend Fixed operator-(Fixed const& a) { return stored(-Wide(a.word_), a.word_ == 0, a.marked_); }
    friend Fixed sqrt(Fixed const& a) { return FixedSum<F>::root(a); }
    friend Fixed abs(Fixed const& a) { return a.word_ < 0 ? -a : a; }
    friend bool isfinite(Fixed const& a) { return !a.marked_; }

private:
    struct FormatConstant {
        static constexpr FixedFormat value = F;
    };
};

/// n q^2: an exact sum of words and of products of two words. See Fixed.
template <FixedFormat F>
class FixedSum {
    using Wide = detail::Wide;
    using Word = Fixed<F>;
    Wide n_ = 0;
    bool marked_ = false;
    FixedSum(Wide n, bool marked) : n_(n), marked_(marked) {}
    static FixedSum of(FixedSum const& a) { return a; }
    static FixedSum of(Word const& a) { return a; }
    static Word factor(Word const& a) { return a; }
    static Word factor(FixedSum const& a) { return a.stored(); }

public:
    FixedSum() = default;
    explicit FixedSum(int n) : FixedSum(Word(n)) {}
    explicit FixedSum(double x) : FixedSum(Word(x)) {}
    FixedSum(Word const& word) : n_(Wide(word.word_) << Word::format().fraction), marked_(word.marked_) {}

    Word stored() const {
        FixedFormat const& f = Word::format();
        return Word::stored(detail::shifted_down(n_, f.fraction, f.rounding), n_ == 0, marked_);
    }
    explicit operator double() const { return static_cast<double>(stored()); }
    bool marked() const { return marked_; }

    template <detail::TermWith<Word> A, detail::TermWith<Word> B>
    static FixedSum sum(A const& a, B const& b) {
        FixedSum const x = of(a), y = of(b);
        return {x.n_ + y.n_, x.marked_ || y.marked_};
    }
    template <detail::TermWith<Word> A, detail::TermWith<Word> B>
    static FixedSum product(A const& a, B const& b) {
        Word const x = factor(a), y = factor(b);
        return {Wide(x.word_) * y.word_, x.marked_ || y.marked_};
    }
    template <detail::TermWith<Word> A, detail::TermWith<Word> B>
    static Word quotient(A const& a, B const& b) {
        FixedSum const x = of(a);
        Word const y = factor(b);
        if (y.word_ == 0) {
            ++detail::fixed_events_so_far.zero_divisors;
            Wide const limit = Wide(1) << (Word::format().bits - 1);
            return {std::int64_t(x.n_ == 0 ? 0 : x.n_ < 0 ? -limit : limit - 1), true, typename Word::Made{}};
        }
        return Word::stored(detail::divided(x.n_, y.word_, Word::format().rounding), x.n_ == 0, x.marked_ || y.marked_);
    }
    static Word root(FixedSum const& a) {
        if (a.n_ < 0) {
            ++detail::fixed_events_so_far.negative_roots;
            return {0, true, typename Word::Made{}};
        }
        return Word::stored(detail::rooted(a.n_, Word::format().rounding), a.n_ == 0, a.marked_);
    }
    template <detail::TermWith<Word> A, detail::TermWith<Word> B>
    static std::strong_ordering compared(A const& a, B const& b) {
        Wide const x = of(a).n_, y = of(b).n_;
        return x < y    ? std::strong_ordering::less
               : x == y ? std::strong_ordering::equal
                        : std::strong_ordering::greater;
    }

    friend FixedSum operator-(FixedSum const& a) { return {-a.n_, a.marked_}; }
    friend Word sqrt(FixedSum const& a) { return root(a); }
    friend FixedSum abs(FixedSum const& a) { return a.n_ < 0 ? -a : a; }
    friend bool isfinite(FixedSum const& a) { return !a.marked_; }
};

template <detail::FixedTerm A, detail::TermWith<A> B>
detail::ResultWith<A> operator+(A const& a, B const& b) {
    return FixedSum<detail::FormatOf<A>::value>::sum(a, b);
}
template <detail::FixedTerm A, detail::TermWith<A> B>
detail::ResultWith<A> operator-(A const& a, B const& b) {
    return FixedSum<detail::FormatOf<A>::value>::sum(a, -FixedSum<detail::FormatOf<A>::value>(b));
}
template <detail::FixedTerm A, detail::TermWith<A> B>
detail::ResultWith<A> operator*(A const& a, B const& b) {
    return FixedSum<detail::FormatOf<A>::value>::product(a, b);
}
template <detail::FixedTerm A, detail::TermWith<A> B>
Fixed<detail::FormatOf<A>::value> operator/(A const& a, B const& b) {
    return FixedSum<detail::FormatOf<A>::value>::quotient(a, b);
}
template <detail::FixedTerm A, detail::TermWith<A> B>
A& operator+=(A& a, B const& b) {
    return a = a + b;
}
template <detail::FixedTerm A, detail::TermWith<A> B>
A& operator-=(A& a, B const& b) {
    return a = a - b;
}
template <detail::FixedTerm A, detail::TermWith<A> B>
A& operator*=(A& a, B const& b) {
    return a = a * b;
}
template <detail::FixedTerm A, detail::TermWith<A> B>
A& operator/=(A& a, B const& b) {
    return a = a / b;
}
template <detail::FixedTerm A, detail::TermWith<A> B>
bool operator==(A const& a, B const& b) {
    return FixedSum<detail::FormatOf<A>::value>::compared(a, b) == 0;
}
template <detail::FixedTerm A, detail::TermWith<A> B>
std::strong_ordering operator<=>(A const& a, B const& b) {
    return FixedSum<detail::FormatOf<A>::value>::compared(a, b);
}

/// Words whose format is asked as one run after another: what FixedScope says when an operation is done.
using VariableFixed = Fixed<FixedFormat{.bits = 0, .fraction = 0}>;
/// The same, rounded after every operation.
using VariableFixedRounded = Fixed<FixedFormat{.bits = 0, .fraction = 0, .sums = Sums::rounded}>;

/// The word, then its mark. A word that the format in force has no room for is not read.
template <FixedFormat F>
struct Encoding<Fixed<F>> {
    static constexpr std::size_t size = 9;
    static void write(Fixed<F> const& x, std::byte* to) {
        detail::write_low(std::uint64_t(x.word_), 8, to);
        to[8] = std::byte(x.marked_);
    }
    static bool read(std::byte const* from, Fixed<F>& x) {
        std::int64_t const word = std::int64_t(detail::read_low(from, 8)),
                           limit = std::int64_t{1} << (Fixed<F>::format().bits - 1);
        x = Fixed<F>(word, from[8] == std::byte(1), typename Fixed<F>::Made{});
        return -limit <= word && word < limit && from[8] <= std::byte(1);
    }
};

/// A kernel's running rows and the lanes of its dot products are accumulators.
template <FixedFormat F>
    requires(F.sums == Sums::exact)
struct AccumulatorOf<Fixed<F>> {
    using type = FixedSum<F>;
};

/// The other threads' words have the format of the calling one, and what happens there is counted here in the end.
template <FixedFormat F>
class ThreadState<Fixed<F>> {
    FixedFormat format_ = FixedScope::format();
    mutable std::mutex mutex_;
    mutable FixedEvents parts_{};

public:
    ~ThreadState() { detail::fixed_events_so_far = detail::fixed_events_so_far + parts_; }
    class Part {
        ThreadState const& state_;
        FixedScope scope_;
        detail::FixedAccount account_{false};

    public:
        Part(ThreadState const& state, std::uint64_t) : state_(state), scope_(state.format_) {}
        ~Part() {
            std::lock_guard const lock(state_.mutex_);
            state_.parts_ = state_.parts_ + detail::fixed_events_so_far;
        }
    };
};

/// The events go back to what they were.
template <FixedFormat F>
struct UncountedScope<Fixed<F>> : detail::FixedAccount {
    UncountedScope() : FixedAccount(false) {}
};

/// digits: of a number in [1, 2), fraction + 1. min_exp makes a sum of squares large enough (least_sum_of_squares) from
/// 1 on: its root then is off by q/4 at most. max_exp: of the largest word. Where the format varies 53 bits hold every
/// number.
template <FixedFormat F>
struct ArithmeticTraits<Fixed<F>> {
    static constexpr std::string_view name = "fixed";
    static constexpr int digits = F.bits == 0 ? 53 : F.fraction + 1, min_exp = -digits,
                         max_exp = F.bits == 0 ? 0 : F.bits - 2 - F.fraction;
};
template <>
inline int significand_bits<VariableFixed>() {
    return FixedScope::format().fraction + 1;
}
template <>
inline int significand_bits<VariableFixedRounded>() {
    return FixedScope::format().fraction + 1;
}
template <>
inline int min_exponent<VariableFixed>() {
    return -significand_bits<VariableFixed>();
}
template <>
inline int min_exponent<VariableFixedRounded>() {
    return min_exponent<VariableFixed>();
}

}  // namespace rlslab

template <rlslab::FixedFormat F>
struct Eigen::NumTraits<rlslab::Fixed<F>> : rlslab::detail::StorageTraits<rlslab::Fixed<F>> {
    using Number = rlslab::Fixed<F>;
    static Number highest() { return Number(0x1p62); }
    static Number lowest() { return Number(-0x1p62); }
    static Number infinity() { return Number(std::numeric_limits<double>::infinity()); }
    static Number quiet_NaN() { return Number(std::numeric_limits<double>::quiet_NaN()); }
};
