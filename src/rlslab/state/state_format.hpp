// What stands at which byte of a saved state, before the numbers.
#pragma once

#include <rlslab/core/encoding.hpp>

#include <string_view>

namespace rlslab {

// A state of version 2, whole numbers and numbers with the least significant byte first:
//
//    0  magic: 89 52 4c 53 0d 0a 1a 0a               16  smallest and largest exponent of the arithmetic, 4 + 4 bytes
//    8  version, 2 bytes                             24  d, 4 bytes           28  checksum of the layout, 4 bytes
//   10  lanes of the arithmetic, 2 bytes             32  bytes in all, 8 bytes
//   12  bits p of its significand, 4 bytes           40  the variant's name, 32 bytes
//   72  the arithmetic's name, 24 bytes
//   96  how many entries follow, 4 bytes; then each, 32 bytes: kind, name (23 bytes, zeros behind), a binary64
//       'f'  a filter, or what is around one, from outside in; its edition
//       'o'  an option of it        'c'  a count of it
//       the members that F::state names, in their order, numbers as Encoding has them, matrices by columns, whole
//       squares (kernels read the half of a triangle that is zero)
//  end  CRC-32 of all before, 4 bytes
//
// The layout is the sequence of members, their kinds and lengths. Magic, version, length and checksum stay where they
// are in every version, so that each tells damage from another version.
inline constexpr std::uint16_t state_version = 2;

/// Why bytes were refused.
enum class StateFault {
    none,
    no_state,
    cut_short,
    too_long,
    damaged,
    other_version,
    variant,
    arithmetic,
    size,
    layout,
    value,
    edition,
    options
};

constexpr std::string_view name_of(StateFault fault) {
    constexpr std::string_view names[] = {"none",
                                          "not a state",
                                          "cut short",
                                          "longer than it says",
                                          "damaged: its checksum is another",
                                          "of another version of the format",
                                          "of another variant",
                                          "of another arithmetic",
                                          "of another size",
                                          "of other options: what is composed, or its lengths",
                                          "of numbers that no filter holds",
                                          "of another edition of the algorithm: what follows would have other bits",
                                          "of other options"};
    return names[static_cast<int>(fault)];
}

/// What a state says of itself before its numbers.
struct StateHeader {
    static constexpr std::size_t size = 96, checksum = 4;
    static constexpr std::array<unsigned char, 8> magic{0x89, 'R', 'L', 'S', 0x0d, 0x0a, 0x1a, 0x0a};
    template <int n>
    using Name = std::array<char, n>;  ///< zeros behind

    std::uint64_t version = state_version, lanes = 1, digits = 0, min_exp = 0, max_exp = 0, parameters = 0, layout = 0,
                  bytes = 0;
    Name<32> variant{};
    Name<24> arithmetic{};

    template <std::size_t n>
    static std::string_view text(std::array<char, n> const& name) {
        return {name.data(), std::size_t(std::find(name.begin(), name.end(), '\0') - name.begin())};
    }
    friend bool same_arithmetic(StateHeader const& a, StateHeader const& b) {
        return a.arithmetic == b.arithmetic && a.lanes == b.lanes && a.digits == b.digits && a.min_exp == b.min_exp &&
               a.max_exp == b.max_exp;
    }

    /// Shows each field with where it begins and how many bytes it takes.
    static void fields(auto& header, auto number, auto name) {
        number(header.version, 8, 2);
        number(header.lanes, 10, 2);
        number(header.digits, 12, 4);
        number(header.min_exp, 16, 4);
        number(header.max_exp, 20, 4);
        number(header.parameters, 24, 4);
        number(header.layout, 28, 4);
        number(header.bytes, 32, 8);
        name(header.variant, 40);
        name(header.arithmetic, 72);
    }
    void write(std::byte* to) const {
        for (std::size_t i = 0; i < magic.size(); ++i) to[i] = std::byte(magic[i]);
        fields(
            *this, [to](std::uint64_t n, int at, int length) { detail::write_low(n, std::size_t(length), to + at); },
            [to](auto const& text, int at) {
                std::transform(text.begin(), text.end(), to + at, [](char c) { return std::byte(c); });
            });
    }
    /// The header of a whole and undamaged state; or the first thing that the bytes are not.
    static StateFault read(std::span<std::byte const> from, StateHeader& out) {
        auto const is = [](std::byte b, unsigned char c) { return b == std::byte(c); };
        if (from.size() < magic.size() ||
            !std::equal(magic.begin(), magic.end(), from.begin(), [&](auto c, auto b) { return is(b, c); }))
            return StateFault::no_state;
        if (from.size() < size + checksum) return StateFault::cut_short;
        fields(
            out,
            [from](std::uint64_t& n, int at, int length) {
                n = detail::read_low(from.data() + at, std::size_t(length));
            },
            [from](auto& text, int at) {
                std::transform(from.begin() + at, from.begin() + at + std::ptrdiff_t(text.size()), text.begin(),
                               [](std::byte b) { return char(b); });
            });
        if (from.size() < out.bytes) return StateFault::cut_short;
        if (from.size() > out.bytes) return StateFault::too_long;
        std::size_t const end = from.size() - checksum;
        Checksum sum;
        sum.add(from.first(end));
        if (out.version == 0 || detail::read_low(from.data() + end, checksum) != sum.value())
            return StateFault::damaged;
        return out.version == state_version ? StateFault::none : StateFault::other_version;
    }
};

/// What a state says by name, between header and numbers.
struct StateEntry {
    static constexpr std::size_t size = 32;
    char kind = 0;  ///< 'f', 'o' or 'c'
    StateHeader::Name<23> name{};
    double value = 0;

    void write(std::byte* to) const {
        to[0] = std::byte(kind);
        std::transform(name.begin(), name.end(), to + 1, [](char c) { return std::byte(c); });
        Encoding<double>::write(value, to + 24);
    }
    static StateEntry read(std::byte const* from) {
        StateEntry out{.kind = char(from[0])};
        std::transform(from + 1, from + 24, out.name.begin(), [](std::byte b) { return char(b); });
        Encoding<double>::read(from + 24, out.value);
        return out;
    }
    bool same_value(StateEntry const& other) const {
        return __builtin_bit_cast(std::uint64_t, value) == __builtin_bit_cast(std::uint64_t, other.value);
    }
};
/// The bytes between header and numbers of a whole state; empty where there are fewer.
inline std::span<std::byte const> entries_in(std::span<std::byte const> whole) {
    auto const behind = whole.subspan(StateHeader::size, whole.size() - StateHeader::size - StateHeader::checksum);
    if (behind.size() < 4) return {};
    std::uint64_t const bytes = 4 + detail::read_low(behind.data(), 4) * StateEntry::size;
    return bytes <= behind.size() ? behind.first(std::size_t(bytes)) : std::span<std::byte const>{};
}

}  // namespace rlslab
