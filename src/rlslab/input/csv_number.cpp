// The standard library reads the numbers; cells with letters or hexadecimal digits, which it might accept, are not
// passed to it.
#include <rlslab/input/csv_number.hpp>

#include <rlslab/input/csv.hpp>
#include <rlslab/input/csv_text.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace rlslab::csv {
namespace {

bool same_word(std::string_view a, std::string_view b) {
    auto const lower = [](char c) { return 'A' <= c && c <= 'Z' ? char(c - 'A' + 'a') : c; };
    return std::ranges::equal(a, b, {}, lower, lower);
}

bool is_digit(char c) { return '0' <= c && c <= '9'; }
bool all_digits(std::string_view text) { return !text.empty() && std::ranges::all_of(text, is_digit); }

/// The number "digits.digits e digits", with the dot first or last allowed; nothing unless all of the text is read.
Reading decimal(std::string_view cell, bool plus) {
    double value = 0;
    char const* const end = cell.data() + cell.size();
    auto const [stop, error] = std::from_chars(cell.data() + plus, end, value);
    if (stop != end) return {Kind::text};
    bool const held = error == std::errc() && std::abs(value) <= largest_value;
    if (!held) return {Kind::out_of_range};
    return {cell.find('.') == cell.npos ? Kind::whole : Kind::point, value};
}

/// "12,345,678", by a comma or a point.
bool in_groups(std::string_view digits, char between) {
    std::size_t const first = digits.find(between);
    if (first == digits.npos || first < 1 || first > 3 || digits[0] == '0') return false;
    for (std::size_t at = first; at < digits.size(); at += 4)
        if (digits[at] != between || !all_digits(digits.substr(at + 1, 3)) || digits.size() - at < 4) return false;
    return all_digits(digits.substr(0, first));
}

/// The kind of a cell that contains a comma.
Reading with_comma(std::string_view cell, bool plus, std::string_view magnitude) {
    auto const commas = std::ranges::count(magnitude, ','), points = std::ranges::count(magnitude, '.');
    if (commas == 1 && points == 0) {
        std::string pointed(cell);
        pointed[cell.find(',')] = '.';
        auto const [kind, value] = decimal(pointed, plus);
        if (kind != Kind::point) return {kind};
        return {in_groups(magnitude, ',') ? Kind::comma_or_group : Kind::comma, value};
    }
    // "1,234.5" and "1.234,5": groups before the last mark, digits behind it
    auto const grouped_before = [&](std::size_t last, char between) {
        auto const fraction = last < magnitude.size() ? magnitude.substr(last + 1) : std::string_view("0");
        return in_groups(magnitude.substr(0, last), between) && (fraction.empty() || all_digits(fraction));
    };
    bool const english = points <= 1 && grouped_before(magnitude.find('.'), ','),
               german = commas == 1 && grouped_before(magnitude.find(','), '.');
    return {english || german ? Kind::grouped : Kind::text};
}

}  // namespace

bool is_among(std::vector<std::string> const& words, double value) {
    return std::ranges::any_of(words, [&](std::string const& word) { return reading_of(word).value == value; });
}

std::string torn(std::vector<std::string> const& words, double value) {
    for (std::size_t i = 1; i < words.size(); ++i) {
        std::string_view const whole = words[i - 1];
        if (!all_digits(whole.substr(whole.starts_with('-'))) || !all_digits(words[i])) continue;
        std::string const word = words[i - 1] + '.' + words[i];
        if (reading_of(word).value == value) return word;
    }
    return "";
}

Reading reading_of(std::string_view cell, std::vector<std::string> const& words) {
    if (!words.empty()) {
        if (std::ranges::any_of(words, [&](std::string const& word) { return same_word(cell, word); }))
            return {Kind::missing};
        Reading const number = reading_of(cell);
        return is_among(words, number.value) ? Reading{Kind::missing} : number;
    }
    if (cell.empty() || cell == "." || cell == "?" || same_word(cell, "na") || same_word(cell, "n/a") ||
        same_word(cell, "#n/a") || same_word(cell, "null"))
        return {Kind::missing};
    bool const plus = cell[0] == '+';
    std::string_view const magnitude = cell.substr(plus || cell[0] == '-' ? 1 : 0);
    if (same_word(magnitude, "nan")) return {Kind::missing};
    if (same_word(magnitude, "inf") || same_word(magnitude, "infinity")) return {Kind::infinite};
    // from_chars accepts a minus but no plus; the letters that it accepts ("nan(1)") are no number here.
    if (magnitude.empty() || (magnitude[0] != '.' && magnitude[0] != ',' && !is_digit(magnitude[0])))
        return {Kind::text};
    if (magnitude.find(',') != magnitude.npos) return with_comma(cell, plus, magnitude);
    if (!in_groups(magnitude, '.')) return decimal(cell, plus);
    if (std::ranges::count(magnitude, '.') > 1) return {Kind::grouped};
    return {Kind::point_or_group, decimal(cell, plus).value};
}

bool is_value(Kind kind) { return kind <= Kind::comma_or_group || kind == Kind::missing; }

std::string complaint(Kind kind, std::string_view cell) {
    switch (kind) {
        case Kind::infinite: return "expected a finite number, found " + in_quotes(cell);
        case Kind::out_of_range:
            return "expected 0 or a size from 2^-1074 to 2^500 (squares must stay finite), found " + in_quotes(cell);
        case Kind::grouped: return "expected a number without marks between thousands, found " + in_quotes(cell);
        default: {
            std::string const found = in_quotes(cell);
            bool const word = cell.find_first_of("0123456789") == cell.npos || cell.find('#') != cell.npos;
            return "expected a number, found " + found +
                   (word ? " (--missing " + found + " if that is no value)" : std::string());
        }
    }
}

}  // namespace rlslab::csv
