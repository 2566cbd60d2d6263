// Text in lines of a certain width.
#include <rlslab/input/text.hpp>

#include <algorithm>

namespace rlslab {

std::string wrapped(std::string_view text, size_t at, size_t indent, size_t width) {
    std::string out;
    while (at + text.size() > width) {
        size_t const room = width - std::min(width, at);
        size_t end = text.rfind(' ', room);
        if (end == text.npos || text.find_first_not_of(' ') > end) end = text.find(' ', room);
        if (end == text.npos) break;
        out += text.substr(0, text.find_last_not_of(' ', end) + 1);
        text.remove_prefix(std::min(text.size(), text.find_first_not_of(' ', end)));
        out += '\n' + std::string(indent, ' ');
        at = indent;
    }
    return out + std::string(text);
}

size_t line_width(size_t columns, size_t most) { return columns > 0 ? std::clamp<size_t>(columns, 40, most) : most; }

}  // namespace rlslab
