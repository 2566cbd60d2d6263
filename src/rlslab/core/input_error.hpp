// The error for data or options that cannot be used. Its message is one printable line, whatever the file contains.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rlslab {

/// what() is one printable line: the place (file, line, column), what was expected, what was found.
class InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The number of bytes of the well-formed UTF-8 character at the start of the text. 0: there is none, or it is one on
/// which a terminal may act (a control character, a change of direction).
inline std::size_t printable_character(std::string_view text) {
    auto const byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    if (text.empty()) return 0;
    unsigned const lead = byte(0);
    if (lead < 0x80) return lead >= 0x20 && lead != 0x7f ? 1 : 0;
    std::size_t const length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || text.size() < length) return 0;
    unsigned code = lead & (0x7fu >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return 0;
        code = code << 6 | (byte(i) & 0x3fu);
    }
    unsigned const least = length == 4 ? 0x10000 : length == 3 ? 0x800 : 0xa0;  // overlong forms, C1 controls
    bool const surrogate = code >= 0xd800 && code <= 0xdfff;
    bool const line_or_direction = (code >= 0x200b && code <= 0x200f) || (code >= 0x2028 && code <= 0x202e) ||
                                   (code >= 0x2066 && code <= 0x2069) || code == 0xfeff;
    return code < least || code > 0x10ffff || surrogate || line_or_direction ? 0 : length;
}

/// Text from a file or a command line, made printable on one line: other bytes as \xNN, everything after `limit`
/// characters as "...".
inline std::string printable(std::string_view text, std::size_t limit = 40) {
    constexpr char hex[] = "0123456789abcdef";
    std::string line;
    for (std::size_t shown = 0; !text.empty(); ++shown) {
        if (shown == limit) return line + "...";
        std::size_t const length = printable_character(text);
        if (length == 0) {
            unsigned const byte = static_cast<unsigned char>(text[0]);
            line += {'\\', 'x', hex[byte >> 4], hex[byte & 15]};
        } else {
            line += text.substr(0, length);
        }
        text.remove_prefix(length == 0 ? 1 : length);
    }
    return line;
}

}  // namespace rlslab
