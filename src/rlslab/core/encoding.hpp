// How a number becomes bytes that every machine reads alike, and the checksum over them.
#pragma once

#include <rlslab/core/random.hpp>
#include <rlslab/core/scalar.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace rlslab {

/// A T as `size` bytes, the least significant first, on every machine:
///   write(x, to)      every bit of x: -0, the bits of a NaN
///   read(from, x)     false where no T is written so
/// Each scalar specialises it beside its definition.
template <class T>
struct Encoding;

template <class T>
concept Encodable = requires(T const& x, T& y, std::byte* to, std::byte const* from) {
    { Encoding<T>::size } -> std::convertible_to<std::size_t>;
    Encoding<T>::write(x, to);
    { Encoding<T>::read(from, y) } -> std::same_as<bool>;
};

template <>
struct Encoding<bool> {
    static constexpr std::size_t size = 1;
    static void write(bool x, std::byte* to) { *to = std::byte(x); }
    static bool read(std::byte const* from, bool& x) {
        x = *from == std::byte(1);
        return x || *from == std::byte(0);
    }
};

namespace detail {
/// The low bytes of n.
inline void write_low(std::uint64_t n, std::size_t bytes, std::byte* to) {
    for (std::size_t i = 0; i < bytes; ++i) to[i] = std::byte(n >> (8 * i) & 0xff);
}
inline std::uint64_t read_low(std::byte const* from, std::size_t bytes) {
    std::uint64_t n = 0;
    for (std::size_t i = 0; i < bytes; ++i) n |= std::uint64_t(from[i]) << (8 * i);
    return n;
}
}  // namespace detail

/// Whole numbers, as 64 bits whatever their length here. What is beyond 2^62, or this machine's length, is not read: a
/// count may go on counting.
template <std::integral I>
struct Encoding<I> {
    static constexpr std::size_t size = 8;
    static void write(I const& x, std::byte* to) { detail::write_low(std::uint64_t(x), size, to); }
    static bool read(std::byte const* from, I& x) {
        std::uint64_t const bits = detail::read_low(from, size);
        if constexpr (std::unsigned_integral<I>) {
            x = I(bits);
            return std::uint64_t(x) == bits;
        } else {
            std::int64_t const n = std::int64_t(bits),
                               most = std::int64_t{1} << (sizeof(I) == 8 ? 62 : 8 * sizeof(I) - 2);
            x = I(n);
            return -most <= n && n <= most;
        }
    }
};

template <>
struct Encoding<Seed> {
    static constexpr std::size_t size = 8;
    static void write(Seed const& x, std::byte* to) { Encoding<std::uint64_t>::write(x.state, to); }
    static bool read(std::byte const* from, Seed& x) { return Encoding<std::uint64_t>::read(from, x.state); }
};

/// The bytes of IEEE's formats and x87's (without its padding), the least significant first.
template <std::floating_point T>
struct Encoding<T> {
    static constexpr int digits = std::numeric_limits<T>::digits;
    static_assert(digits == 24 || digits == 53 || digits == 64 || digits == 113,
                  "a long double that has no format of its own");
    static constexpr std::size_t size = digits == 24 ? 4 : digits == 53 ? 8 : digits == 64 ? 10 : 16;
    static void write(T const& x, std::byte* to) {
        std::memcpy(to, &x, size);
        if constexpr (std::endian::native == std::endian::big) std::reverse(to, to + size);
    }
    static bool read(std::byte const* from, T& x) {
        std::array<std::byte, size> bytes;
        std::copy(from, from + size, bytes.begin());
        if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
        x = T(0);
        std::memcpy(&x, bytes.data(), size);
        return true;
    }
};

/// A number kept in one double, where not every double is one.
template <class T, class IsOne>
struct EncodingInDouble {
    static_assert(sizeof(T) == sizeof(double) && std::is_trivially_copyable_v<T>);
    static constexpr std::size_t size = 8;
    static void write(T const& x, std::byte* to) { Encoding<double>::write(__builtin_bit_cast(double, x), to); }
    static bool read(std::byte const* from, T& x) {
        double value;
        Encoding<double>::read(from, value);
        x = __builtin_bit_cast(T, value);
        return IsOne{}(value);
    }
};

/// A member that is no fixed number of numbers (a sparse factor) specialises this beside its definition:
///   put(member, number)         calls number(x) for all that it consists of, in order
///   get(member, number, keep)   number(x) reads one into x, false at the end; returns whether a member was read. Where
///                               keep is false the member stays as it is
template <class X>
struct IrregularState;

/// CRC-32 of ISO 3309 (zlib's, PNG's, Ethernet's): reflected polynomial 0xedb88320, all ones at first and inverted at
/// last. Four bits at a time by a table of 16: 64 bytes of a microcontroller. Finds every change of up to 32 bits in a
/// row, and every two flipped bits that are less than 2^32 - 1 bits apart.
class Checksum {
    static constexpr std::array<std::uint32_t, 16> table = [] {
        std::array<std::uint32_t, 16> out{};
        for (std::uint32_t i = 0; i < 16; ++i) {
            out[i] = i;
            for (int bit = 0; bit < 4; ++bit) out[i] = out[i] >> 1 ^ (out[i] & 1 ? 0xedb88320u : 0);
        }
        return out;
    }();
    std::uint32_t rest_ = 0xffffffff;

public:
    constexpr void add(std::span<std::byte const> bytes) {
        for (std::byte const byte : bytes) {
            rest_ ^= std::uint32_t(byte);
            rest_ = rest_ >> 4 ^ table[rest_ & 15];
            rest_ = rest_ >> 4 ^ table[rest_ & 15];
        }
    }
    constexpr std::uint32_t value() const { return ~rest_; }
};

}  // namespace rlslab
