// Reading a state's file, and why it was refused.
#include <rlslab/state/state_file.hpp>

#include <cerrno>
#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace rlslab {
namespace {

std::string described(StateHeader const& header) {
    std::string out = fmt::format("{} in {}", printable(StateHeader::text(header.variant)),
                                  printable(StateHeader::text(header.arithmetic)));
    if (header.lanes > 1) out += fmt::format(" of {} lanes", header.lanes);
    if (header.parameters > 0)
        out += fmt::format(" with {} parameter{}", header.parameters, header.parameters == 1 ? "" : "s");
    return out;
}

std::string name_of(StateEntry const& entry) { return printable(StateHeader::text(entry.name)); }

/// "guard around ridge around ud".
std::string layers(std::vector<StateEntry> const& entries) {
    std::string out;
    for (StateEntry const& entry : entries)
        if (entry.kind == 'f') out += (out.empty() ? "" : " around ") + name_of(entry);
    return out.empty() ? "something without names" : out;
}
/// A policy's number as its action.
std::string value_of(StateEntry const& entry) {
    constexpr std::string_view actions[] = {"report", "skip", "cap", "reset", "rebuild"};
    if (name_of(entry).starts_with("on_") && 0 <= entry.value && entry.value < double(std::size(actions)))
        return std::string(actions[std::size_t(entry.value)]);
    float const single = float(entry.value);  // the shortest text of a number of float, too
    return double(single) == entry.value ? fmt::format("{}", single) : fmt::format("{}", entry.value);
}
/// Where the two begin to differ: ", its guard has innovation 4, expected 6".
std::string difference(StateFault fault, std::vector<StateEntry> const& found,
                       std::vector<StateEntry> const& expected) {
    if (found.empty() || fault == StateFault::value) return fmt::format(", {}", name_of(fault));
    if (layers(found) != layers(expected)) return fmt::format(", {}, expected {}", layers(found), layers(expected));
    std::string layer;
    for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i) {
        if (found[i].kind == 'f') layer = name_of(found[i]);
        bool const looked_at = found[i].kind == (fault == StateFault::edition ? 'f' : 'o');
        if (!looked_at || found[i].same_value(expected[i])) continue;
        return fmt::format(", its {} has {} {}, expected {}", layer,
                           fault == StateFault::edition ? "edition" : name_of(found[i]), value_of(found[i]),
                           value_of(expected[i]));
    }
    return fmt::format(", {}", name_of(fault));
}
/// A state that cannot be read.
std::string unreadable(StateFault fault, StateHeader const& header, std::size_t bytes) {
    if (fault == StateFault::no_state) return bytes == 0 ? "nothing" : "something else";
    if (fault == StateFault::other_version)
        return fmt::format("one of format {}, this program reads format {}", header.version, state_version);
    return fmt::format("{} bytes that are a state {}", bytes, name_of(fault));
}

}  // namespace

std::string refusal(StateFault fault, StateHeader const& expected, std::vector<StateEntry> const& entries,
                    std::span<std::byte const> found) {
    std::string out = fmt::format("expected a state of {}, found ", described(expected));
    StateHeader header;
    if (StateFault const whole = StateHeader::read(found, header); whole != StateFault::none)
        return out + unreadable(whole, header, found.size());
    out += "one of " + described(header);
    bool const other_format = fault == StateFault::arithmetic && header.arithmetic == expected.arithmetic;
    if (other_format) out += fmt::format(", {} bits there, {} here", header.digits, expected.digits);
    if (fault >= StateFault::layout) out += difference(fault, state_entries(found), entries);
    return out;
}

std::vector<StateEntry> state_entries(std::span<std::byte const> whole) {
    std::vector<StateEntry> out;
    auto const bytes = entries_in(whole);
    for (std::size_t at = 4; at < bytes.size(); at += StateEntry::size)
        out.push_back(StateEntry::read(bytes.data() + at));
    return out;
}

std::string described_state(std::span<std::byte const> bytes) {
    StateHeader header;
    if (StateFault const fault = StateHeader::read(bytes, header); fault != StateFault::none)
        throw InputError("expected a state, found " + unreadable(fault, header, bytes.size()));
    std::string out =
        fmt::format("a state of {}: format {}, {} bytes\n", described(header), header.version, bytes.size());
    for (StateEntry const& entry : state_entries(bytes)) {
        if (entry.kind == 'f') out += fmt::format("{}, edition {}\n", name_of(entry), value_of(entry));
        else
            out +=
                fmt::format("  {:<16} {}{}\n", name_of(entry), value_of(entry), entry.kind == 'c' ? "  (counted)" : "");
    }
    return out;
}

namespace detail {

std::vector<std::byte> bytes_of(std::filesystem::path const& path) {
    if (std::error_code none; std::filesystem::is_directory(path, none))
        refuse_state(path, "cannot read: it is a folder");
    std::ifstream file(path, std::ios::binary);
    std::string text(StateHeader::magic.size(), '\0');
    file.read(text.data(), std::streamsize(text.size()));
    text.resize(std::size_t(file.gcount()));
    // What is no state may be large, or have no end (/dev/zero): it is not read.
    StateHeader header;
    if (StateHeader::read(std::as_bytes(std::span(text)), header) != StateFault::no_state)
        text.append(std::istreambuf_iterator<char>(file), {});
    if (!file.is_open() || file.bad()) refuse_state(path, fmt::format("cannot read: {}", std::strerror(errno)));
    std::vector<std::byte> out(text.size());
    std::transform(text.begin(), text.end(), out.begin(), [](char c) { return std::byte(c); });
    return out;
}

void refuse_state(std::filesystem::path const& path, std::string const& why) {
    throw InputError(fmt::format("{}: {}", printable(path.string(), 200), why));
}

}  // namespace detail
}  // namespace rlslab
