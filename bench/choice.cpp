// Reads the options, and compares a row's name with them.
#include "bench/choice.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <sstream>
#include <stdexcept>

namespace rlslab::bench {
namespace {

constexpr Index largest = 512;  // certifying the scenario of 512 parameters takes a minute

std::vector<Index> sizes_in(std::string const& list) {
    std::vector<Index> out;
    for (std::string const& word : split(list, ',')) {
        Index size = 0;
        auto const [end, fault] = std::from_chars(word.data(), word.data() + word.size(), size);
        if (fault != std::errc() || end != word.data() + word.size() || size < 1 || size > largest)
            throw std::runtime_error(
                fmt::format("--sizes {}: expected whole numbers from 1 to {}, as in 5,12", list, largest));
        out.push_back(size);
    }
    std::ranges::sort(out);
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

}  // namespace

std::vector<std::string> split(std::string const& text, char at) {
    std::vector<std::string> out;
    std::istringstream in(text + at);
    for (std::string part; std::getline(in, part, at);) out.push_back(part);
    return out;
}

Choice& choice() {
    static Choice made;
    return made;
}

bool Choice::has(std::string const& row) const {
    if (!made) return true;
    std::vector<std::string> const parts = split(row, '/');
    if (parts.size() != 4) return false;
    bool const chosen_arithmetic = parts[2] == "float" ? in_float : in_double;
    bool const size = std::ranges::any_of(sizes, [&](Index d) { return parts[3] == std::to_string(d); });
    return size && (parts[0] == "peer" || (parts[0] == (fixed ? "fixed" : "update") && chosen_arithmetic));
}

void take_choice(int& argc, char** argv) {
    Choice out;
    std::vector<Index> sizes;
    int kept = 1;
    for (int i = 1; i < argc; ++i) {
        std::string const word = argv[i], name = word.substr(0, word.find('='));
        auto const value = [&]() -> std::string {
            std::string const given = name != word ? word.substr(name.size() + 1) : i + 1 < argc ? argv[++i] : "";
            if (given.empty() || given.starts_with("--"))
                throw std::runtime_error(fmt::format("{}: expected a value", name));
            return given;
        };
        if (name == "--sizes") sizes = sizes_in(value());
        else if (name == "--csv") out.csv = value();
        else if (word == "--double") out.in_double = true;
        else if (word == "--float") out.in_float = true;
        else if (word == "--fixed") out.fixed = true;
        else if (word == "--mine") out.mine = true;
        else {
            argv[kept++] = argv[i];
            continue;
        }
        out.made = true;
    }
    argc = kept;
    if (out.made) {
        std::vector<Index> const compiled(fixed_sizes.begin(), fixed_sizes.end());
        out.sizes = !sizes.empty() ? sizes : out.fixed ? compiled : std::vector<Index>{4, 16, 64};
        if (!out.in_float) out.in_double = true;
        if (out.fixed && out.in_float) throw std::runtime_error("--fixed: is in double; it does not go with --float");
        if (out.fixed && !std::ranges::includes(compiled, out.sizes))
            throw std::runtime_error(
                fmt::format("--fixed: expected sizes among {}, which are compiled", fmt::join(fixed_sizes, ", ")));
        choice() = out;
    }
}

}  // namespace rlslab::bench
