// A message is compared by what it names (option, place, number, name), not by its English: that stands in
// tests/program/messages.cpp alone.
#pragma once

#include <gmock/gmock.h>

#include <cctype>
#include <sstream>
#include <string>

namespace rlslab {

/// `thing` stands in `message`, and is no part of a longer word, option or number there.
inline bool stands_in(std::string const& message, std::string const& thing) {
    auto const inner = [&](size_t at) {
        return at < message.size() && (std::isalnum(static_cast<unsigned char>(message[at])) || message[at] == '_');
    };
    for (size_t at = message.find(thing); at != message.npos; at = message.find(thing, at + 1)) {
        size_t const end = at + thing.size();
        bool const begins = at == 0 || !(inner(at - 1) || message[at - 1] == '-' || message[at - 1] == '.');
        bool const ends = !inner(end) && !(end < message.size() && message[end] == '.' && inner(end + 1));
        if (begins && ends) return true;
    }
    return false;
}

/// A message that names each of the `things`, which blanks separate: Names("data.csv:3 column 2 y abc").
MATCHER_P(Names, things, "names " + testing::PrintToString(std::string(things))) {
    std::istringstream words{std::string(things)};
    for (std::string thing; words >> thing;)
        if (!stands_in(arg, thing)) return *result_listener << "not " << thing, false;
    return arg != "no error";
}

}  // namespace rlslab
