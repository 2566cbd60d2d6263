// A filter's state in a file that is there whole, old or new, whenever the program ends.
#pragma once

#include <rlslab/state/state.hpp>
#include <rlslab/core/files.hpp>
#include <rlslab/core/input_error.hpp>

namespace rlslab {

/// "expected a state of ud in float with 5 parameters, found one of qr in double with 3": one printable line.
/// parameters 0: any. `entries`: the names of the filter and its layers.
std::string refusal(StateFault fault, StateHeader const& expected, std::vector<StateEntry> const& entries,
                    std::span<std::byte const> found);

/// What f's state says by name.
template <NamesItsState F>
std::vector<StateEntry> state_entries(F const& f) {
    std::vector<StateEntry> out;
    auto const keep = [&out](StateEntry const& entry) { out.push_back(entry); };
    detail::describe(keep, f);
    return out;
}
/// What a whole state says by name.
std::vector<StateEntry> state_entries(std::span<std::byte const> whole);
/// What a state says of itself, a line each: the variant, its arithmetic and size, what is around it, editions,
/// options, counts. Throws InputError for bytes that are no whole state.
std::string described_state(std::span<std::byte const> bytes);

namespace detail {
/// The bytes of a file. Throws InputError.
std::vector<std::byte> bytes_of(std::filesystem::path const& path);
[[noreturn]] void refuse_state(std::filesystem::path const& path, std::string const& why);
}  // namespace detail

/// The filter that was saved. Throws InputError for bytes that are no state of an F. Members around a filter that need
/// more than a Problem to be made are made first, and loaded into.
template <NamesItsState F>
F loaded(std::span<std::byte const> from) {
    using T = typename F::scalar;
    constexpr detail::Known types = detail::known<F>();
    F const plain(Problem<T>{.size = std::max(types.size, 1)});
    StateHeader found, expected = state_header(plain);
    expected.parameters = std::uint64_t(types.size);
    StateFault fault = StateHeader::read(from, found);
    if (fault == StateFault::none && found.variant != expected.variant) fault = StateFault::variant;
    if (fault == StateFault::none && !same_arithmetic(found, expected)) fault = StateFault::arithmetic;
    // Each number takes a byte: no file makes us allocate more than a multiple of its own size.
    std::uint64_t const d = found.parameters,
                        most = types.square ? from.size() / std::max<std::uint64_t>(d, 1) : from.size();
    if (fault == StateFault::none && (d < 1 || d > most || (types.size > 0 && d != expected.parameters)))
        fault = StateFault::size;
    if (fault == StateFault::none) {
        F f(Problem<T>{.size = Index(d)});
        fault = load(f, from);
        if (fault == StateFault::none) return f;
    }
    throw InputError(refusal(fault, expected, state_entries(plain), from));
}

/// Writes f's state; see replace_file for on_disk. Throws InputError where it cannot be written.
template <NamesItsState F>
void save(F const& f, std::filesystem::path const& path, bool on_disk = true) {
    std::vector<std::byte> bytes(state_size(f));
    save(f, std::span(bytes));
    replace_file(path, {reinterpret_cast<char const*>(bytes.data()), bytes.size()}, on_disk);
}

/// f becomes the filter that was saved there. Throws InputError, naming the file, what was expected and what was found;
/// f is then as it was.
template <NamesItsState F>
void load(F& f, std::filesystem::path const& path) {
    std::vector<std::byte> const bytes = detail::bytes_of(path);
    if (StateFault const fault = load(f, std::span(bytes)); fault != StateFault::none)
        detail::refuse_state(path, refusal(fault, state_header(f), state_entries(f), bytes));
}
template <NamesItsState F>
F loaded(std::filesystem::path const& path) {
    std::vector<std::byte> const bytes = detail::bytes_of(path);
    try {
        return loaded<F>(std::span(bytes));
    } catch (InputError const& error) {
        detail::refuse_state(path, error.what());
    }
}

}  // namespace rlslab
