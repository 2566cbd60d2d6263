// Reading a state's file, and why it was refused.
#include <rlslab/adapt/state_file.hpp>

#include <cerrno>
#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace rlslab {
namespace {

std::string described(StateHeader const& header) {
    std::string out =
        fmt::format("{} in {}", printable(StateHeader::text(header.variant)), printable(StateHeader::text(header.arithmetic)));
    if (header.lanes > 1) out += fmt::format(" of {} lanes", header.lanes);
    if (header.parameters > 0) out += fmt::format(" with {} parameter{}", header.parameters, header.parameters == 1 ? "" : "s");
    return out;
}

}  // namespace

std::string refusal(StateFault fault, StateHeader const& expected, std::span<std::byte const> found) {
    std::string out = fmt::format("expected a state of {}, found ", described(expected));
    StateHeader header;
    StateFault const whole = StateHeader::read(found, header);
    if (whole == StateFault::later_version)
        return out + fmt::format("one of format {}, this program reads formats up to {}", header.version, state_version);
    if (whole != StateFault::none)
        return out + fmt::format("{} bytes that are {}{}", found.size(), whole == StateFault::no_state ? "" : "a state ", name_of(whole));
    out += "one of " + described(header);
    bool const other_format = fault == StateFault::arithmetic && header.arithmetic == expected.arithmetic;
    if (other_format) out += fmt::format(", {} bits there, {} here", header.digits, expected.digits);
    if (fault == StateFault::layout || fault == StateFault::value) out += fmt::format(", {}", name_of(fault));
    return out;
}

namespace detail {

std::vector<std::byte> bytes_of(std::filesystem::path const& path) {
    if (std::error_code none; std::filesystem::is_directory(path, none)) refuse_state(path, "cannot read: it is a folder");
    std::ifstream file(path, std::ios::binary);
    std::vector<char> const text{std::istreambuf_iterator<char>(file), {}};
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
