// Any bytes as a CSV file: read, or refused in one printable line; what was read does not depend on how the bytes came,
// and is read again bit for bit from what it is written as.
#include "tests/fuzz/fuzz.hpp"

#include <rlslab/input/csv.hpp>

#include <fmt/format.h>

#include <bit>
#include <cmath>

namespace rlslab::fuzz {
namespace {

struct Outcome {
    Columns data;
    std::string refusal;
    bool operator==(Outcome const& other) const {
        auto const same = [](double a, double b) {
            return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (a != a && b != b);
        };
        return refusal == other.refusal && data.header == other.data.header && data.names == other.data.names &&
               data.lines == other.data.lines &&
               std::ranges::equal(data.values, other.data.values,
                                  [&](auto const& a, auto const& b) { return std::ranges::equal(a, b, same); });
    }
};

/// Every column whose name is not empty and not another's, of bytes that come `piece` at a time.
Outcome read(std::string_view bytes, std::size_t piece, CsvFormat format) {
    Outcome out;
    try {
        CsvFile file(
            [bytes, piece](std::span<char> to) mutable {
                std::size_t const now = std::min({piece, to.size(), bytes.size()});
                std::ranges::copy(bytes.substr(0, now), to.begin());
                bytes.remove_prefix(now);
                return now;
            },
            "fuzzed", format);
        std::vector<std::string> names;
        for (auto const& name : file.names())
            if (!name.empty() && std::ranges::count(file.names(), name) == 1 && names.size() < 8) names.push_back(name);
        if (names.empty()) names.push_back("no such");
        out.data = file.read(names);
    } catch (InputError const& error) {
        out.refusal = one_line(error);
    }
    return out;
}

std::string written(Columns const& data) {
    std::string text;
    auto const cell = [&](std::size_t j, std::string const& x) { text += (j == 0 ? "\"" : ";\"") + x + '"'; };
    if (data.header) {
        for (std::size_t j = 0; j < data.names.size(); ++j) {
            std::string name = "name " + data.names[j];  // neither a number nor missing nor "sep=;"
            for (auto at = name.find('"'); at != name.npos; at = name.find('"', at + 2)) name.insert(at, 1, '"');
            cell(j, name);
        }
        text += '\n';
    }
    for (std::size_t i = 0; i < std::size_t(data.rows()); ++i, text += '\n')
        for (std::size_t j = 0; j < data.names.size(); ++j)
            cell(j, std::isnan(data.values[j][i]) ? "NA" : fmt::format("{}", data.values[j][i]));
    return text;
}

}  // namespace

void take(std::string_view bytes) {
    CsvFormat format;
    if (!bytes.empty()) {  // the first byte is the format
        unsigned const choice = static_cast<unsigned char>(bytes[0]);
        if (choice < 32)
            format = {.separator = "\0,;\t| "[choice % 8 % 6], .decimal = "\0.,"[choice / 8 % 3]},
            bytes.remove_prefix(1);
    }
    Outcome const whole = read(bytes, bytes.size() + 1, format);
    expect(whole == read(bytes, 1 + bytes.size() % 7, format), "the same in pieces");
    if (!whole.refusal.empty()) return;
    expect(whole.data.rows() > 0, "rows, or a refusal");
    for (auto const& column : whole.data.values) {
        expect(Index(column.size()) == whole.data.rows(), "columns of equal length");
        for (double const x : column)
            expect(std::isnan(x) || std::abs(x) <= largest_value, "values within bounds, or missing");
    }
    if (!whole.data.header && whole.data.names.size() > 0 &&
        whole.data.names.back() != std::to_string(whole.data.names.size()))
        return;
    for (std::string const& name : whole.data.names)
        if (name.find("\r\n") != name.npos) return;  // a line's end, and written again another
    std::string const text = written(whole.data);
    Outcome again = read(text, text.size() + 1, {.separator = ';', .decimal = '.'});
    again.data.lines = whole.data.lines;
    if (whole.data.header)
        for (std::string& name : again.data.names) name.erase(0, 5);
    expect(again == whole, "read again as it was written");
}

}  // namespace rlslab::fuzz
