// The JSON that Google Benchmark writes, made JSON: it writes NaN and Infinity, which JSON has not, for the relative
// scatter of times that are 0.
#pragma once

#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <string>

namespace rlslab::bench {

/// Numbers that are not finite become null. Throws nlohmann::json::parse_error.
inline nlohmann::json parsed_results(std::string const& text) {
    static std::regex const not_finite("(: *)-?(NaN|nan|Infinity|inf)(?=[,\\s}])");
    return nlohmann::json::parse(std::regex_replace(text, not_finite, "$1null"));
}

/// The kind of machine of a run, by name: processor, instruction set, compiler.
std::string machine_of(auto const& run) {
    auto const& context = run.at("context");
    return fmt::format("{}, {}, {}", context.value("cpu", "unknown processor"),
                       context.value("instructions", "unknown instruction set"),
                       context.value("compiler", "unknown compiler"));
}

/// make(the text of the file). Throws std::runtime_error, with the file's name before any complaint; `missing` where
/// there is none.
template <class Make>
auto made_from(std::string const& path, std::string const& missing, Make make) {
    try {
        std::ifstream file(path, std::ios::binary);
        if (!file) throw std::runtime_error(missing);
        return make(std::string{std::istreambuf_iterator<char>(file), {}});
    } catch (std::exception const& error) {
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    }
}

}  // namespace rlslab::bench
