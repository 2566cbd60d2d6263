// A filter's state as bytes: the same on every machine, checked before a number of them is believed.
#pragma once

#include <rlslab/state/state_format.hpp>
#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/storage.hpp>

#include <tuple>
#include <vector>

namespace rlslab {

namespace detail {

template <class X>
concept Irregular = requires(X const& x) { IrregularState<X>::put(x, [](auto const&) {}); };

template <class T>
inline constexpr bool is_square = false;
template <class T, int N>
inline constexpr bool is_square<StateMatrix<T, N>> = true;
template <class T, int N>
inline constexpr bool is_square<SymmetricMatrix<T, N>> = true;

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
/// A filter whose type only the run knows walks and describes its state itself.
template <class X>
concept HidesItsState = requires { requires X::hides_its_state; };
/// Whether that is so of F, or of what F is around: then F's own names do not tell the variant.
template <class F>
concept NamedAtRunTime = requires(F const& f) { f.variant_name(); };
template <class F>
std::string_view variant_of(F const& f) {
    if constexpr (NamedAtRunTime<F>) return f.variant_name();
    else return F::name;
}
/// Any callable that takes entries.
class EntryVisitor {
    void const* to_;
    void (*visit_)(void const*, StateEntry const&);

public:
    template <class To>
    explicit EntryVisitor(To const& to)
        : to_(&to), visit_([](void const* at, StateEntry const& entry) { (*static_cast<To const*>(at))(entry); }) {}
    void operator()(StateEntry const& entry) const { visit_(to_, entry); }
};

/// Shows what x says by name, from outside in: to(entry).
template <class To, class X>
void describe(To const& to, X const& x) {
    if constexpr (HidesItsState<X>) {
        x.describe_state(EntryVisitor(to));
    } else if constexpr (NamesItsState<X>) {
        auto const entry = [&to](char kind, std::string_view name, double value) {
            StateEntry out{.kind = kind, .value = value + 0.0};  // -0.0 is the option 0
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
        if constexpr (requires(X const& x) { X::options(x); })
            out += std::tuple_size_v<decltype(X::options(std::declval<X const&>()))>;
        [&]<std::size_t... i>(std::index_sequence<i...>) {
            ((out += is_first_of_its_type<Members, i>()
                         ? entries_of<std::remove_cvref_t<std::tuple_element_t<i, Members>>>()
                         : 0),
             ...);
        }(std::make_index_sequence<std::tuple_size_v<Members>>());
    }
    return out;
}
template <class F>
std::size_t entries_in(F const& f) {
    if constexpr (NamedAtRunTime<F>) {
        std::size_t out = 0;
        auto const count = [&out](StateEntry const&) { ++out; };
        describe(count, f);
        return out;
    } else {
        return entries_of<F>();
    }
}
template <class F>
inline constexpr std::size_t entry_bytes = 4 + StateEntry::size * entries_of<F>();

struct Silent {
    void token(char, std::uint64_t) {}
    void length(char, Index, std::size_t) {}
    void name(std::string_view) {}
};

/// Is shown a count without its end.
struct BareCounts : Silent {};

/// Shows every member to `to`, in order.
template <class To, class X>
void walk(To& to, X& x) {
    using Member = std::remove_const_t<X>;
    if constexpr (HidesItsState<Member>) {
        x.walk_state(to);
    } else if constexpr (NamesItsState<Member>) {
        if constexpr (requires { Member::name; }) to.name(variant_of(x));
        to.token('(', 0);
        std::apply([&to](auto&... members) { (walk(to, members), ...); }, Member::state(x));
        to.token(')', 0);
    } else if constexpr (Encodable<Member>) {
        to.token('n', Encoding<Member>::size);
        if constexpr (std::derived_from<To, BareCounts> && requires { x.most; }) to.number(x.n);
        else to.number(x);
    } else if constexpr (is_square<Member>) {
        to.length('m', x.size(), Encoding<std::remove_cvref_t<decltype(x(0, 0))>>::size);
        for (Index j = 0; j < x.size(); ++j)
            for (Index i = 0; i < x.size(); ++i) to.number(x(i, j));
    } else if constexpr (Irregular<Member>) {
        to.token('s', 0);
        to.irregular(x);
    } else if constexpr (requires { x.each([](auto&) {}); }) {  // elements that are made for the walk
        to.length('a', Index(x.size()), 0);
        x.each([&to](auto& element) { walk(to, element); });
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
    Reading(std::span<std::byte const> bytes, bool keep_them) : from(bytes), keep(keep_them) {}
    template <class T>
    bool read(T& x) {
        possible = possible && from.size() >= Encoding<T>::size && Encoding<T>::read(from.data(), x);
        if (possible) from = from.subspan(Encoding<T>::size);
        return possible;
    }
    template <class T>
    void number(T& x) {
        T read_one = x;
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
    static constexpr Known value = N == Dynamic ? Known{.exact = false, .square = true}
                                                : Known{.bytes = std::size_t(N * N) * Encoding<T>::size, .size = N};
};
template <class T, int N>
struct KnownOf<SymmetricMatrix<T, N>> : KnownOf<StateMatrix<T, N>> {};  // the file has all d x d numbers
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
    if constexpr (HidesItsState<X>) return {.exact = false};
    else if constexpr (NamesItsState<X>) return known_of(static_cast<decltype(X::state(std::declval<X&>()))*>(nullptr));
    else if constexpr (Encodable<X>) return {.bytes = Encoding<X>::size};
    else return KnownOf<X>::value;
}

template <class T>
constexpr std::uint64_t lanes_of() {
    if constexpr (requires { T::lanes; }) return T::lanes;
    else return 1;
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
                    .min_exp = std::uint32_t(min_exponent<T>()),
                    .max_exp = std::uint32_t(max_exponent<T>())};
    std::string_view const name = detail::variant_of(f);
    std::copy(name.begin(), name.end(), out.variant.begin());
    std::copy(Traits::name.begin(), Traits::name.end(), out.arithmetic.begin());
    detail::Measuring measuring;
    detail::walk(measuring, f);
    measuring.into(out);
    out.bytes += StateHeader::size + 4 + StateEntry::size * detail::entries_in(f) + StateHeader::checksum;
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
inline constexpr std::size_t state_bytes =
    StateHeader::size + detail::entry_bytes<F> + detail::known<F>().bytes + StateHeader::checksum;

/// Writes f's state and returns how many bytes it took. `to` may be longer; throws std::invalid_argument where it is
/// shorter. Allocates nothing; d^2 operations.
template <NamesItsState F>
std::size_t save(F const& f, std::span<std::byte> to) {
    StateHeader const header = state_header(f);
    expects(to.size() >= header.bytes, "room for the state: state_size(filter) bytes");
    std::size_t const end = std::size_t(header.bytes) - StateHeader::checksum;
    header.write(to.data());
    std::byte* at = to.data() + StateHeader::size;
    detail::write_low(detail::entries_in(f), 4, at);
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

namespace detail {
/// The first thing that f says by name otherwise than the entries do.
template <NamesItsState F>
StateFault compared(F const& f, std::span<std::byte const> entries) {
    if (entries.size() != 4 + StateEntry::size * entries_in(f)) return StateFault::layout;
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
    if (!same_edition) return StateFault::edition;
    return same_options ? StateFault::none : StateFault::options;
}
}  // namespace detail

/// f becomes the filter that was saved, bit for bit; f was made with the same size and the same options, its forgetting
/// and prior may be others. Anything but StateFault::none leaves f as it was. Neither allocates nor throws (sparse
/// variants and fleets allocate). A checksum is no signature: who can write a file can also make its checksum right.
template <NamesItsState F>
StateFault load(F& f, std::span<std::byte const> from) {
    StateHeader found;
    if (StateFault const fault = StateHeader::read(from, found); fault != StateFault::none) return fault;
    StateHeader const expected = state_header(f);
    if (found.variant != expected.variant) return StateFault::variant;
    if (!same_arithmetic(found, expected)) return StateFault::arithmetic;
    if (found.parameters != expected.parameters) return StateFault::size;
    auto const entries = entries_in(from);
    if (StateFault const fault = detail::compared(f, entries); fault != StateFault::none) return fault;
    if (found.layout != expected.layout) return StateFault::layout;
    std::size_t const first = StateHeader::size + entries.size();
    auto const numbers = from.subspan(first, from.size() - first - StateHeader::checksum);
    detail::Reading looking(numbers, false), keeping(numbers, true);
    detail::walk(looking, f);
    if (!looking.possible || !looking.from.empty()) return StateFault::value;
    detail::walk(keeping, f);
    return StateFault::none;
}

}  // namespace rlslab
