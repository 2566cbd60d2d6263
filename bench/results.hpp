// The JSON that Google Benchmark writes, made JSON: it writes NaN and Infinity, which JSON has not, for the relative scatter of times that
// are 0.
#pragma once

#include <nlohmann/json.hpp>
#include <regex>
#include <string>

namespace rlslab::bench {

/// Numbers that are not finite become null. Throws nlohmann::json::parse_error.
inline nlohmann::json parsed_results(std::string const& text) {
    static std::regex const not_finite("(: *)-?(NaN|nan|Infinity|inf)(?=[,\\s}])");
    return nlohmann::json::parse(std::regex_replace(text, not_finite, "$1null"));
}

}  // namespace rlslab::bench
