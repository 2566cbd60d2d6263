// One list of keys and values, in three notations.
#include "src/lab/report/provenance.hpp"

#include "src/lab/report/page.hpp"

#include <chrono>
#include <fmt/chrono.h>
#include <nlohmann/json.hpp>

namespace rlslab::report {

std::vector<std::pair<std::string, std::string>> items(Provenance const& of) {
    std::vector<std::pair<std::string, std::string>> all{
        {"command", of.command}, {"file", of.file},
        {"sha256", of.sha256},   {"rows", of.rows > 0 ? fmt::format("{}", of.rows) : ""},
        {"version", version},    {"revision", revision},
        {"compiler", compiler},  {"instruction_set", of.instruction_set},
        {"date", of.date}};
    std::erase_if(all, [](auto const& item) { return item.second.empty(); });
    return all;
}

std::string as_json(Provenance const& of) {
    nlohmann::ordered_json out;
    for (auto const& [key, value] : items(of)) out[key] = value;
    if (of.rows > 0) out["rows"] = of.rows;
    // A file's name need not be UTF-8.
    return out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string as_comments(Provenance const& of) {
    std::string out;
    for (auto [key, value] : items(of)) {
        for (char& c : value)
            if (c == '\n' || c == '\r') c = ' ';  // a word of the command may hold one
        out += fmt::format("# {}: {}\n", key, value);
    }
    return out;
}

std::string as_html(Provenance const& of) {
    std::string out = "<footer class=\"soft\"><p>";
    for (auto const& [key, value] : items(of))
        out += fmt::format(
            "{}{}: {}", out.ends_with("<p>") ? "" : "<br>\n", key == "instruction_set" ? "instruction set" : key,
            key == "command" || key == "sha256" ? "<code>" + escaped(value) + "</code>" : escaped(value));
    return out + "</p></footer>\n";
}

std::string shell_text(std::vector<std::string> const& words) {
    std::string out;
    for (std::string const& word : words) {
        bool const plain = !word.empty() && word.find_first_not_of(
                                                "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                "0123456789_-+=./,:@%") == word.npos;
        out += out.empty() ? "" : " ";
        if (plain) {
            out += word;
            continue;
        }
        out += '\'';
        for (char const c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
        out += '\'';
    }
    return out;
}

std::string date_now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

}  // namespace rlslab::report
