// JSON as it is written here: objects from their names and values, lists from what each thing is made into.
#pragma once

#include <rlslab/core/misuse.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace rlslab::report {

using Json = nlohmann::ordered_json;

/// {"name": value, ...}, blanks between the names: a value for each, or none, and all are null.
inline Json object(std::string_view names, std::vector<Json> const& values) {
    size_t const count = size_t(std::ranges::count(names, ' ')) + 1;
    expects(values.empty() || values.size() == count, "a value for each name");
    Json out = Json::object();
    for (size_t at = 0, i = 0; at < names.size(); ++i) {
        size_t const end = std::min(names.find(' ', at), names.size());
        out[std::string(names.substr(at, end - at))] = values.empty() ? Json() : values[i];
        at = end + 1;
    }
    return out;
}
/// The list of what `of` makes of each.
Json each(auto const& all, auto const& of) {
    Json out = Json::array();
    for (auto const& x : all) out.push_back(of(x));
    return out;
}

}  // namespace rlslab::report
