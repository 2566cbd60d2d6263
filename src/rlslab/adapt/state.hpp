// A filter's state as bytes: the same on every machine, checked before a number of them is believed.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/core/encoding.hpp>
#include <rlslab/linalg/storage.hpp>

#include <bit>
#include <tuple>
#include <vector>

namespace rlslab {

// A state of version 2, whole numbers and numbers with the least significant byte first:
//
//    0  magic: 89 52 4c 53 0d 0a 1a 0a               16  smallest and largest exponent of the arithmetic, 4 + 4 bytes
//    8  version, 2 bytes                             24  d, 4 bytes           28  checksum of the layout, 4 bytes
//   10  lanes of the arithmetic, 2 bytes             32  bytes in all, 8 bytes
//   12  bits p of its significand, 4 bytes           40  the variant's name, 32 bytes       72  the arithmetic's name, 24 bytes
//   96  how many entries follow, 4 bytes; then each, 32 bytes: kind, name (23 bytes, zeros behind), a binary64
//       'f'  a filter, or what is around one, from outside in; its edition        'o'  an option of it        'c'  a count of it
//       the members that F::state names, in their order, numbers as Encoding has them, matrices by columns, whole squares
//       (kernels read the half of a triangle that is zero)
//  end  CRC-32 of all before, 4 bytes
//
// The layout is the sequence of members, their kinds and lengths. Magic, version, length and checksum stay where they are in every
// version, so that each tells damage from another version. Version 1 has no entries: it does not tell rules, policies and options apart,
// and its editions are 1. A version after this one reads both: when a page's list changes, the page keeps its old list as state_1.
inline constexpr std::uint16_t state_version = 2;

/// Why bytes were refused.
enum class StateFault {
    none,
    no_state,
    cut_short,
    too_long,
    damaged,
    later_version,
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
                                          "of a later version",
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

    std::uint64_t version = state_version, lanes = 1, digits = 0, min_exp = 0, max_exp = 0, parameters = 0, layout = 0, bytes = 0;
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
            [to](auto const& text, int at) { std::transform(text.begin(), text.end(), to + at, [](char c) { return std::byte(c); }); });
    }
    /// The header of a whole and undamaged state; or the first thing that the bytes are not.
    static StateFault read(std::span<std::byte const> from, StateHeader& out) {
        auto const is = [](std::byte b, unsigned char c) { return b == std::byte(c); };
        if (from.size() < magic.size() || !std::equal(magic.begin(), magic.end(), from.begin(), [&](auto c, auto b) { return is(b, c); }))
            return StateFault::no_state;
        if (from.size() < size + checksum) return StateFault::cut_short;
        fields(
            out, [from](std::uint64_t& n, int at, int length) { n = detail::read_low(from.data() + at, std::size_t(length)); },
            [from](auto& text, int at) {
                std::transform(from.begin() + at, from.begin() + at + std::ptrdiff_t(text.size()), text.begin(),
                               [](std::byte b) { return char(b); });
            });
        if (from.size() < out.bytes) return StateFault::cut_short;
        if (from.size() > out.bytes) return StateFault::too_long;
        std::size_t const end = from.size() - checksum;
        Checksum sum;
        sum.add(from.first(end));
        if (out.version == 0 || detail::read_low(from.data() + end, checksum) != sum.value()) return StateFault::damaged;
        return out.version > state_version ? StateFault::later_version : StateFault::none;
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
        return std::bit_cast<std::uint64_t>(value) == std::bit_cast<std::uint64_t>(other.value);
    }
};
/// The bytes between header and numbers of a whole state; empty where there are fewer.
inline std::span<std::byte const> entries_in(StateHeader const& header, std::span<std::byte const> whole) {
    auto const behind = whole.subspan(StateHeader::size, whole.size() - StateHeader::size - StateHeader::checksum);
    if (header.version == 1 || behind.size() < 4) return {};
    std::uint64_t const bytes = 4 + detail::read_low(behind.data(), 4) * StateEntry::size;
    return bytes <= behind.size() ? behind.first(std::size_t(bytes)) : std::span<std::byte const>{};
}

namespace detail {

template <class X>
concept Irregular = requires(X const& x) { IrregularState<X>::put(x, [](auto const&) {}); };

template <class T>
inline constexpr bool is_square = false;
template <class T, int N>
inline constexpr bool is_square<StateMatrix<T, N>> = true;

template <class F>
constexpr std::string_view layer_of() {
    if constexpr (requires { F::layer; }) return F::layer;
    else return F::name;
}
template <class F>
constexpr int edition_of() {
    if constexpr (requires { F::edition; }) return F::edition;
    else return 1;
}
/// Whether member i is the first of its type: a window holds its filter twice.
template <class Members, std::size_t i>
constexpr bool is_first_of_its_type() {
    return []<std::size_t... j>(std::index_sequence<j...>) {
        return (!std::same_as<std::tuple_element_t<i, Members>, std::tuple_element_t<j, Members>> && ...);
    }(std::make_index_sequence<i>());
}
/// Shows what x says by name, from outside in: to(entry).
template <class To, class X>
void describe(To& to, X const& x) {
    if constexpr (NamesItsState<X>) {
        auto const entry = [&to](char kind, std::string_view name, double value) {
            StateEntry out{.kind = kind, .value = value};
            std::copy(name.begin(), name.end(), out.name.begin());
            to(out);
        };
        if constexpr (requires { X::name; }) {
            static_assert(layer_of<X>().size() <= 23);
            entry('f', layer_of<X>(), edition_of<X>());
        }
        if constexpr (requires { X::options(x); })
            for (StateOption const& option : X::options(x)) entry(option.count ? 'c' : 'o', option.name, option.value);
        auto const members = X::state(x);
        [&]<std::size_t... i>(std::index_sequence<i...>) {
            auto const inside = [&]<std::size_t j>(std::integral_constant<std::size_t, j>) {
                if constexpr (is_first_of_its_type<decltype(X::state(x)), j>()) describe(to, std::get<j>(members));
            };
            (inside(std::integral_constant<std::size_t, i>{}), ...);
        }(std::make_index_sequence<std::tuple_size_v<decltype(X::state(x))>>());
    }
}
/// How many entries that are.
template <class X>
constexpr std::size_t entries_of() {
    std::size_t out = 0;
    if constexpr (NamesItsState<X>) {
        using Members = decltype(X::state(std::declval<X const&>()));
        if constexpr (requires { X::name; }) ++out;
        if constexpr (requires(X const& x) { X::options(x); }) out += std::tuple_size_v<decltype(X::options(std::declval<X const&>()))>;
        [&]<std::size_t... i>(std::index_sequence<i...>) {
            ((out += is_first_of_its_type<Members, i>() ? entries_of<std::remove_cvref_t<std::tuple_element_t<i, Members>>>() : 0), ...);
        }(std::make_index_sequence<std::tuple_size_v<Members>>());
    }
    return out;
}
template <class F>
inline constexpr std::size_t entry_bytes = 4 + StateEntry::size * entries_of<F>();

/// Shows every member to `to`, in order.
template <class To, class X>
void walk(To& to, X& x) {
    using Member = std::remove_const_t<X>;
    if constexpr (NamesItsState<Member>) {
        if constexpr (requires { Member::name; }) to.name(Member::name);
        to.token('(', 0);
        std::apply([&to](auto&... members) { (walk(to, members), ...); }, Member::state(x));
        to.token(')', 0);
    } else if constexpr (Encodable<Member>) {
        to.token('n', to.version == 1 ? size_in_version_1<Member> : Encoding<Member>::size);
        to.number(x);
    } else if constexpr (is_square<Member>) {
        to.length('m', x.size(), Encoding<std::remove_cvref_t<decltype(x(0, 0))>>::size);
        for (Index j = 0; j < x.size(); ++j)
            for (Index i = 0; i < x.size(); ++i) to.number(x(i, j));
    } else if constexpr (Irregular<Member>) {
        to.token('s', 0);
        to.irregular(x);
    } else {
        using Element = std::remove_cvref_t<decltype(x[0])>;
        if constexpr (Encodable<Element>) {
            to.length('v', Index(x.size()), Encoding<Element>::size);
            for (Index i = 0; i < Index(x.size()); ++i) to.number(x.data()[i]);
        } else {
            to.length('a', Index(x.size()), 0);
            for (auto& element : x) walk(to, element);
        }
    }
}

/// What the header says: the first length is d.
class Measuring {
    Checksum layout_;
    std::uint64_t bytes_ = 0, parameters_ = 0;
    bool nested_ = false;

public:
    std::uint64_t version = state_version;
    void token(char kind, std::uint64_t n) {
        std::byte bytes[9] = {std::byte(kind)};
        write_low(n, 8, bytes + 1);
        layout_.add(bytes);
    }
    void length(char kind, Index n, std::size_t of_each) {
        token(kind, std::uint64_t(n));
        token('n', of_each);
        if (parameters_ == 0) parameters_ = std::uint64_t(n);
    }
    /// Of what is around a filter; its own stands in the header.
    void name(std::string_view text) {
        for (char const c : text)
            if (nested_) token(c, 0);
        nested_ = true;
    }
    template <class T>
    void number(T const&) {
        bytes_ += Encoding<T>::size;
    }
    template <class X>
    void irregular(X const& x) {
        IrregularState<X>::put(x, [this](auto const& n) { this->number(n); });
    }
    void into(StateHeader& header) const {
        header.layout = layout_.value();
        header.parameters = parameters_;
        header.bytes = bytes_;
    }
};

struct Silent {
    std::uint64_t version = state_version;
    void token(char, std::uint64_t) {}
    void length(char, Index, std::size_t) {}
    void name(std::string_view) {}
};

struct Writing : Silent {
    std::byte* to;
    explicit Writing(std::byte* first) : to(first) {}
    template <class T>
    void number(T const& x) {
        Encoding<T>::write(x, to);
        to += Encoding<T>::size;
    }
    template <class X>
    void irregular(X const& x) {
        IrregularState<X>::put(x, [this](auto const& n) { this->number(n); });
    }
};

/// Looked at first, then kept.
struct Reading : Silent {
    std::span<std::byte const> from;
    bool keep, possible = true;
    Reading(std::span<std::byte const> bytes, bool keep_them, std::uint64_t of_version) : from(bytes), keep(keep_them) {
        version = of_version;
    }
    template <class T>
    bool read(T& x) {
        possible = possible && from.size() >= Encoding<T>::size && Encoding<T>::read(from.data(), x);
        if (possible) from = from.subspan(Encoding<T>::size);
        return possible;
    }
    template <class T>
    void number(T& x) {
        T read_one = x;
        if constexpr (size_in_version_1<T> != Encoding<T>::size)
            if (version == 1) {
                auto one = x[0];
                if (read(one) && keep) x = T(one);
                return;
            }
        if (read(read_one) && keep) x = read_one;
    }
    template <class X>
    void irregular(X& x) {
        possible = IrregularState<X>::get(
                       x, [this](auto& n) { return this->read(n); }, keep) &&
                   possible;
    }
};

/// What the types alone tell. Dynamic lengths count as none, and exact is then false.
struct Known {
    std::size_t bytes = 0;
    bool exact = true, square = false;  ///< square: a d x d of dynamic d is there
    int size = 0;                       ///< the first fixed length, which is d; 0: there is none
    friend constexpr Known operator+(Known a, Known b) {
        return {a.bytes + b.bytes, a.exact && b.exact, a.square || b.square, a.size > 0 ? a.size : b.size};
    }
};
template <class X>
struct KnownOf {
    static constexpr Known value{.exact = false};
};
template <class X>
constexpr Known known();
template <class T, int N>
    requires(N != Dynamic)
struct KnownOf<StateVector<T, N>> {
    static constexpr Known value{.bytes = std::size_t(N) * Encoding<T>::size, .size = N};
};
template <class T, int N>
struct KnownOf<StateMatrix<T, N>> {
    static constexpr Known value =
        N == Dynamic ? Known{.exact = false, .square = true} : Known{.bytes = std::size_t(N * N) * Encoding<T>::size, .size = N};
};
template <class E, std::size_t n>
struct KnownOf<std::array<E, n>> {
    static constexpr Known value{n * known<E>().bytes, known<E>().exact, known<E>().square, known<E>().size};
};
template <class... Members>
constexpr Known known_of(std::tuple<Members&...> const*) {
    return (Known{} + ... + known<std::remove_const_t<Members>>());
}
template <class X>
constexpr Known known() {
    if constexpr (NamesItsState<X>) return known_of(static_cast<decltype(X::state(std::declval<X&>()))*>(nullptr));
    else if constexpr (Encodable<X>) return {.bytes = Encoding<X>::size};
    else return KnownOf<X>::value;
}

template <class T>
constexpr std::uint64_t lanes_of() {
    if constexpr (requires { T::lanes; }) return T::lanes;
    else return 1;
}

}  // namespace detail

namespace detail {
template <class F>
std::uint64_t layout_of(F const& f, std::uint64_t version) {
    Measuring measuring;
    measuring.version = version;
    walk(measuring, f);
    StateHeader out;
    measuring.into(out);
    return out.layout;
}
}  // namespace detail

/// What the state of f says of itself.
template <NamesItsState F>
StateHeader state_header(F const& f) {
    using T = typename F::scalar;
    using Traits = ArithmeticTraits<T>;
    static_assert(F::name.size() <= 32 && Traits::name.size() <= 24);
    StateHeader out{.lanes = detail::lanes_of<T>(),
                    .digits = std::uint64_t(significand_bits<T>()),
                    .min_exp = std::uint32_t(Traits::min_exp),
                    .max_exp = std::uint32_t(Traits::max_exp)};
    std::copy(F::name.begin(), F::name.end(), out.variant.begin());
    std::copy(Traits::name.begin(), Traits::name.end(), out.arithmetic.begin());
    detail::Measuring measuring;
    detail::walk(measuring, f);
    measuring.into(out);
    out.bytes += StateHeader::size + detail::entry_bytes<F> + StateHeader::checksum;
    return out;
}

/// Bytes of f's state.
template <NamesItsState F>
std::size_t state_size(F const& f) {
    return std::size_t(state_header(f).bytes);
}

/// The same where every length is fixed by the type: for a buffer of a microcontroller.
template <NamesItsState F>
    requires(detail::known<F>().exact)
inline constexpr std::size_t state_bytes = StateHeader::size + detail::entry_bytes<F> + detail::known<F>().bytes + StateHeader::checksum;

/// Writes f's state and returns how many bytes it took. `to` may be longer; throws std::invalid_argument where it is shorter. Allocates
/// nothing; d^2 operations.
template <NamesItsState F>
std::size_t save(F const& f, std::span<std::byte> to) {
    StateHeader const header = state_header(f);
    expects(to.size() >= header.bytes, "room for the state: state_size(filter) bytes");
    std::size_t const end = std::size_t(header.bytes) - StateHeader::checksum;
    header.write(to.data());
    std::byte* at = to.data() + StateHeader::size;
    detail::write_low(detail::entries_of<F>(), 4, at);
    at += 4;
    auto const put = [&at](StateEntry const& entry) {
        entry.write(at);
        at += StateEntry::size;
    };
    detail::describe(put, f);
    detail::Writing writing(at);
    detail::walk(writing, f);
    Checksum sum;
    sum.add(to.first(end));
    detail::write_low(sum.value(), StateHeader::checksum, to.data() + end);
    return end + StateHeader::checksum;
}

/// f's state: an array where every length is fixed by the type, else a vector.
template <NamesItsState F>
auto state_of(F const& f) {
    if constexpr (detail::known<F>().exact) {
        std::array<std::byte, state_bytes<F>> out;
        save(f, out);
        return out;
    } else {
        std::vector<std::byte> out(state_size(f));
        save(f, out);
        return out;
    }
}

/// Which edition of the algorithm a state may be of: `any` takes the numbers of another one. What follows then differs by rounding from
/// what the saved filter would have given.
enum class Edition { same, any };

namespace detail {
/// The first thing that f says by name otherwise than the entries do.
template <NamesItsState F>
StateFault compared(F const& f, std::span<std::byte const> entries, Edition accepted) {
    if (entries.size() != entry_bytes<F>) return StateFault::layout;
    bool named = true, same_edition = true, same_options = true;
    std::byte const* at = entries.data() + 4;
    auto const compare = [&](StateEntry const& mine) {
        StateEntry const found = StateEntry::read(at);
        at += StateEntry::size;
        named = named && found.kind == mine.kind && found.name == mine.name;
        if (mine.kind == 'f') same_edition = same_edition && found.same_value(mine);
        if (mine.kind == 'o') same_options = same_options && found.same_value(mine);
    };
    describe(compare, f);
    if (!named) return StateFault::layout;
    if (!same_edition && accepted == Edition::same) return StateFault::edition;
    return same_options ? StateFault::none : StateFault::options;
}
template <NamesItsState F>
StateFault compared_with_version_1(F const& f, Edition accepted) {
    bool first = true;
    auto const look = [&first](StateEntry const& mine) { first = first && (mine.kind != 'f' || mine.value == 1); };
    describe(look, f);
    return first || accepted == Edition::any ? StateFault::none : StateFault::edition;
}
}  // namespace detail

/// f becomes the filter that was saved, bit for bit; f was made with the same size and the same options, its forgetting and prior may be
/// others. Anything but StateFault::none leaves f as it was. Neither allocates nor throws (sparse variants allocate). A checksum is no
/// signature: who can write a file can also make its checksum right.
template <NamesItsState F>
StateFault load(F& f, std::span<std::byte const> from, Edition accepted = Edition::same) {
    StateHeader found;
    if (StateFault const fault = StateHeader::read(from, found); fault != StateFault::none) return fault;
    StateHeader const expected = state_header(f);
    if (found.variant != expected.variant) return StateFault::variant;
    if (!same_arithmetic(found, expected)) return StateFault::arithmetic;
    if (found.parameters != expected.parameters) return StateFault::size;
    auto const entries = entries_in(found, from);
    StateFault const fault = found.version == 1 ? detail::compared_with_version_1(f, accepted) : detail::compared(f, entries, accepted);
    if (fault != StateFault::none) return fault;
    if (found.layout != detail::layout_of(f, found.version)) return StateFault::layout;
    std::size_t const first = StateHeader::size + entries.size();
    auto const numbers = from.subspan(first, from.size() - first - StateHeader::checksum);
    detail::Reading looking(numbers, false, found.version), keeping(numbers, true, found.version);
    detail::walk(looking, f);
    if (!looking.possible || !looking.from.empty()) return StateFault::value;
    detail::walk(keeping, f);
    return StateFault::none;
}

}  // namespace rlslab
