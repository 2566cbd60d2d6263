// Binary128: IEEE binary128 by the compiler's own library, where a machine has it: +, -, x and / without another
// library.
#pragma once

#include <rlslab/arithmetic/storage_traits.hpp>
#include <rlslab/core/encoding.hpp>

#include <cfloat>
#include <compare>

#if LDBL_MANT_DIG == 113
#define RLSLAB_BINARY128 long double
#elif defined(__SIZEOF_FLOAT128__)
#define RLSLAB_BINARY128 __float128
#endif
#ifdef RLSLAB_BINARY128

namespace rlslab {

/// The numbers and roundings of Quad (quad.hpp), and its bytes in saved states, so that either can go on from the
/// other's. It has no square root: for the forms that need none.
class Binary128 {
    __extension__ typedef RLSLAB_BINARY128 Number;
    Number x_ = 0;

    static Binary128 of(Number x) {
        Binary128 out;
        out.x_ = x;
        return out;
    }

public:
    Binary128() = default;
    Binary128(std::integral auto n) : x_(Number(n)) {}
    Binary128(std::floating_point auto a) : x_(Number(a)) {}
    explicit operator double() const { return double(x_); }
    explicit operator float() const { return float(x_); }

    friend Binary128 operator+(Binary128 const& a, Binary128 const& b) { return of(a.x_ + b.x_); }
    friend Binary128 operator-(Binary128 const& a, Binary128 const& b) { return of(a.x_ - b.x_); }
    friend Binary128 operator*(Binary128 const& a, Binary128 const& b) { return of(a.x_ * b.x_); }
    friend Binary128 operator/(Binary128 const& a, Binary128 const& b) { return of(a.x_ / b.x_); }
    friend Binary128 operator-(Binary128 const& a) { return of(-a.x_); }
    Binary128& operator+=(Binary128 const& b) { return *this = *this + b; }
    Binary128& operator-=(Binary128 const& b) { return *this = *this - b; }
    Binary128& operator*=(Binary128 const& b) { return *this = *this * b; }
    Binary128& operator/=(Binary128 const& b) { return *this = *this / b; }
    friend bool operator==(Binary128 const& a, Binary128 const& b) { return a.x_ == b.x_; }
    friend std::partial_ordering operator<=>(Binary128 const& a, Binary128 const& b) {
        return a.x_ < b.x_    ? std::partial_ordering::less
               : a.x_ > b.x_  ? std::partial_ordering::greater
               : a.x_ == b.x_ ? std::partial_ordering::equivalent
                              : std::partial_ordering::unordered;
    }
    friend bool isnan(Binary128 const& a) { return !(a.x_ == a.x_); }
    friend bool isfinite(Binary128 const& a) { return a.x_ - a.x_ == Number(0); }

    /// The 64 low bits; and the sign, 15 bits of exponent and 48 bits of fraction.
    struct Words {
        std::uint64_t low, high;
    };
    Words words() const {
        auto const w = __builtin_bit_cast(std::array<std::uint64_t, 2>, x_);
        return std::endian::native == std::endian::big ? Words{w[1], w[0]} : Words{w[0], w[1]};
    }
    static Binary128 of(Words const& w) {
        bool const big = std::endian::native == std::endian::big;
        return of(__builtin_bit_cast(Number, big ? std::array{w.high, w.low} : std::array{w.low, w.high}));
    }
};

template <>
struct ArithmeticTraits<Binary128> {
    static constexpr std::string_view name = "quad";
    static constexpr int digits = 113, min_exp = -16382, max_exp = 16383;
};

/// As Encoding<Quad>: a kind (0 NaN, 1 infinity, 2 zero, 3 other; + 128 with a sign), e in 64 bits, and m of 113 bits
/// in 15 bytes, the first of them 1: +-m 2^e.
template <>
struct Encoding<Binary128> {
    static constexpr std::size_t size = 24;

    static void write(Binary128 const& x, std::byte* to) {
        std::fill(to, to + size, std::byte(0));
        auto [low, high] = x.words();
        bool const negative = high >> 63 != 0, fraction = (high << 16 | low) != 0;
        int const field = int(high >> 48 & 0x7fff);
        int const kind = field == 0x7fff ? (fraction ? 0 : 1) : field == 0 && !fraction ? 2 : 3;
        to[0] = std::byte(kind + (negative && kind > 0 ? 128 : 0));
        if (kind < 3) return;
        high &= 0xffffffffffff;
        int e = std::max(field, 1) - bias;
        if (field > 0) high |= lead;
        for (; (high & lead) == 0; --e) high = high << 1 | low >> 63, low <<= 1;
        Encoding<std::int64_t>::write(e, to + 1);
        detail::write_low(low, 8, to + 9);
        detail::write_low(high, 7, to + 17);
    }
    static bool read(std::byte const* from, Binary128& x) {
        int const kind = int(from[0]) & 127;
        std::int64_t e = 0;
        if (kind > 3 || !Encoding<std::int64_t>::read(from + 1, e)) return false;
        std::uint64_t low = detail::read_low(from + 9, 8), high = detail::read_low(from + 17, 7);
        std::int64_t field = kind == 3 ? e + bias : kind == 2 ? 0 : 0x7fff;
        if (kind == 0) high = std::uint64_t{1} << 47;
        if (kind == 3) {
            if (high >> 49 != 0 || (high & lead) == 0 || field < -112 || 0x7fff <= field) return false;
            for (; field < 1; ++field) low = low >> 1 | high << 63, high >>= 1;
            if ((high & lead) == 0) field = 0;
            high &= lead - 1;
        }
        x = Binary128::of({low, high | std::uint64_t(field) << 48 | std::uint64_t(int(from[0]) >> 7) << 63});
        std::byte again[size];  // other bytes where bits were lost, or there were more than the kind has
        write(x, again);
        return std::equal(again, again + size, from);
    }

private:
    static constexpr int bias = 16383 + 112;
    static constexpr std::uint64_t lead = std::uint64_t{1} << 48;
};

}  // namespace rlslab

template <>
struct Eigen::NumTraits<rlslab::Binary128> : rlslab::detail::StorageTraits<rlslab::Binary128> {};
#endif
