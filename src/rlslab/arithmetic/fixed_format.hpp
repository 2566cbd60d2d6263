// What a fixed-point word is, how an exact number is put into one, and what is counted when it does not fit.
#pragma once

#include <rlslab/core/cpp20.hpp>

#include <rlslab/core/misuse.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

#ifndef __SIZEOF_INT128__
#error "rlslab: fixed-point words need the compiler's 128-bit integers, which 32-bit targets lack"
#endif

namespace rlslab {

/// How a number between two words is rounded.
///   nearest   to the nearer one, ties to the even one ("convergent" in processor manuals)
///   down      toward minus infinity: the low bits of the two's complement are dropped ("truncation"). A bias of half a
///             unit
enum class FixedRounding { nearest, down };
/// What a number beyond the words becomes: the nearest word there is, or the word with the same low bits (modulo
/// 2^bits).
enum class Overflow { saturate, wrap };
/// When sums and products are rounded: once, when the value of the expression is stored, or after every operation.
enum class Sums { exact, rounded };

/// Two's complement words of `bits` bits, `fraction` of them behind the point: the numbers n 2^-fraction for
/// -2^(bits-1) <= n < 2^(bits-1). bits = 0: what the FixedScope of the thread says, but for `sums`.
struct FixedFormat {
    int bits = 16;
    int fraction = 12;
    FixedRounding rounding = FixedRounding::nearest;
    Overflow overflow = Overflow::saturate;
    Sums sums = Sums::exact;
    friend constexpr bool operator==(FixedFormat const&, FixedFormat const&) = default;
};

/// Up to 48 bits: a double holds every word, and 128 bits the exact sum of 2^32 products of two words.
constexpr bool is_fixed_format(FixedFormat f) {
    return f.bits >= 2 && f.bits <= 48 && f.fraction >= 0 && f.fraction < f.bits;
}

/// While one is alive, this thread's words of variable format have this one; then the format before. Outside of any: 32
/// bits, 16 of them behind the point. A word made under one format has another value under another.
/// Throws std::invalid_argument unless 2 <= bits <= 48 and 0 <= fraction < bits.
class [[nodiscard]] FixedScope {
    static inline constinit thread_local FixedFormat current_{32, 16};
    FixedFormat previous_;

public:
    explicit FixedScope(FixedFormat format) : previous_(current_) {
        expects(is_fixed_format(format), "a word of 2 to 48 bits, 0 to bits - 1 of them behind the point");
        current_ = format;
    }
    ~FixedScope() { current_ = previous_; }
    FixedScope(FixedScope const&) = delete;
    FixedScope& operator=(FixedScope const&) = delete;
    static FixedFormat const& format() { return current_; }
};

/// What did not go well, and how large numbers became. The counts say what a processor's sticky status bits would have
/// said.
struct FixedEvents {
    long overflows = 0;       ///< numbers beyond the words, when they were stored
    long zero_divisors = 0;   ///< x / 0
    long negative_roots = 0;  ///< sqrt(x), x < 0
    long underflows = 0;      ///< nonzero numbers that were stored as 0
    std::int64_t peak = 0;    ///< the largest |n| to be stored, before overflow; at most 2^62

    /// Whether a result was undefined or out of range: underflow is rounding.
    bool broken() const { return overflows + zero_divisors + negative_roots > 0; }
    friend FixedEvents operator+(FixedEvents const& a, FixedEvents const& b) {
        return {a.overflows + b.overflows, a.zero_divisors + b.zero_divisors, a.negative_roots + b.negative_roots,
                a.underflows + b.underflows, std::max(a.peak, b.peak)};
    }
    friend bool operator==(FixedEvents const&, FixedEvents const&) = default;
};

namespace detail {
inline constinit thread_local FixedEvents fixed_events_so_far{};

/// Starts an account of this thread's events from nothing. In the end the one before goes on, with or without these.
class FixedAccount {
    FixedEvents before_ = std::exchange(fixed_events_so_far, {});
    bool added_;

public:
    explicit FixedAccount(bool added) : added_(added) {}
    ~FixedAccount() { fixed_events_so_far = added_ ? before_ + fixed_events_so_far : before_; }
    FixedAccount(FixedAccount const&) = delete;
    FixedAccount& operator=(FixedAccount const&) = delete;
};
}  // namespace detail

/// What happened in this thread during the call, in words of any format. Calls nest: the outer one sees the inner one's
/// too.
template <class Work>
FixedEvents fixed_events(Work&& work) {
    detail::FixedAccount const account(true);
    std::forward<Work>(work)();
    return detail::fixed_events_so_far;
}

namespace detail {

__extension__ typedef __int128 Wide;
constexpr Wide magnitude(Wide n) { return n < 0 ? -n : n; }

/// n / 2^s, rounded.
constexpr Wide shifted_down(Wide n, int s, FixedRounding rounding) {
    Wide const below = n >> s;
    if (s == 0 || rounding == FixedRounding::down) return below;
    Wide const rest = n - (below << s), half = Wide(1) << (s - 1);
    return below + (rest > half || (rest == half && (below & 1)));
}
/// n / d, rounded; d != 0.
constexpr Wide divided(Wide n, Wide d, FixedRounding rounding) {
    Wide below = n / d, rest = n % d;
    if (rest != 0 && (rest < 0) != (d < 0)) --below, rest += d;  // 0 <= rest / d < 1
    if (rounding == FixedRounding::down) return below;
    Wide const twice = 2 * magnitude(rest), size = magnitude(d);
    return below + (twice > size || (twice == size && (below & 1)));
}
/// The largest r with r^2 <= n, n > 0. Newton's iteration comes down on it from any start above.
template <class Integer>
constexpr Integer floor_root(Integer n, int bits) {
    Integer root = Integer(1) << (bits + 1) / 2;
    for (;;) {
        Integer const next = (root + n / root) / 2;
        if (next >= root) return root;
        root = next;
    }
}
/// sqrt(n), rounded; n >= 0. There are no ties: (r + 1/2)^2 is no integer.
constexpr Wide rooted(Wide n, FixedRounding rounding) {
    if (n == 0) return 0;
    int const bits =
        128 - (n >> 64 != 0 ? std::countl_zero(std::uint64_t(n >> 64)) : 64 + std::countl_zero(std::uint64_t(n)));
    Wide const below = bits < 62 ? Wide(floor_root(std::int64_t(n), bits)) : floor_root(n, bits);
    return below + (rounding == FixedRounding::nearest && n - below * below > below);
}

struct Word {
    std::int64_t n;
    bool overflowed;
};
/// The word for n, and whether n is another number. Counts what does not fit.
inline Word word_for(Wide n, FixedFormat const& f) {
    FixedEvents& events = fixed_events_so_far;
    Wide const limit = Wide(1) << (f.bits - 1), size = magnitude(n);
    events.peak = std::max(events.peak, std::int64_t(std::min(size, Wide(1) << 62)));
    if (n < limit && n >= -limit) return {std::int64_t(n), false};
    ++events.overflows;
    if (f.overflow == Overflow::saturate) return {std::int64_t(n < 0 ? -limit : limit - 1), true};
    Wide const low = n & (2 * limit - 1);
    return {std::int64_t(low < limit ? low : low - 2 * limit), true};
}

}  // namespace detail
}  // namespace rlslab
