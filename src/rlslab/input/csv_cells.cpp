// Cells as numbers, which the standard library reads; cells with letters or hexadecimal digits, which it might accept,
// are not passed to it. Then decimal marks, and times.
#include <rlslab/input/csv_cells.hpp>

#include <rlslab/input/csv.hpp>
#include <rlslab/input/csv_text.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

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

// --- decimal marks: cells of other columns are read only where they contain a mark -----------------------------------

namespace {

constexpr std::size_t longest_number = 40;

/// The decimal mark that a cell shows as a number of one reading, with marks between thousands ("1.353,27",
/// "1.234.567"), or with a unit or percent sign behind it ("15,7 %"); 0: none.
char mark_shown(std::string_view cell) {
    if (cell.size() > longest_number || cell.find_first_of(".,") == cell.npos) return 0;
    if (Kind const kind = reading_of(cell).kind; kind == Kind::comma || kind == Kind::point)
        return kind == Kind::comma ? ',' : '.';
    if (!cell.empty() && (cell.front() == '-' || cell.front() == '+')) cell.remove_prefix(1);
    std::size_t const end = std::min(cell.find_first_not_of("0123456789.,"), cell.size());
    std::string_view const number = cell.substr(0, end), unit = trimmed(cell.substr(end));
    bool const bare = end == cell.size();
    if (number.empty() || (!bare && (unit.empty() || unit.find_first_of("0123456789.,:/-") != unit.npos))) return 0;
    std::size_t const last = number.find_last_of(".,");
    if (last == number.npos || last + 1 == number.size() || number.front() == '.' || number.front() == ',') return 0;
    char const mark = number[last], other = mark == '.' ? ',' : '.';
    auto const count = std::ranges::count(number, mark);
    auto const in_threes = [&](std::string_view whole) {  // "1.234.567" but for the first group
        for (std::size_t at = whole.find_first_of(".,"); at != whole.npos; at = whole.find_first_of(".,", at + 1))
            if (std::min(whole.find_first_of(".,", at + 1), whole.size()) - at != 4) return false;
        return true;
    };
    if (count > 1) return number.find(other) == number.npos && in_threes(number) ? other : 0;    // "1.234.567"
    if (number.find(other) != number.npos) return in_threes(number.substr(0, last)) ? mark : 0;  // "1.353,27"
    return !bare && number.size() - last != 4 ? mark : 0;                                        // "15,7 %"
}

}  // namespace

std::optional<Marks::Fault> Marks::set_mark(char mark, Cell at) {
    if (mark_ == 0) {
        mark_ = mark;
        line_ = at.line;
        auto const& grouped = mark == '.' ? comma_group_ : point_group_;
        if (grouped) return Fault{*grouped, complaint(Kind::grouped, grouped->text)};
        return std::nullopt;
    }
    std::string const as = given_ ? "" : fmt::format(" as in line {}", line_), found = in_quotes(at.text);
    return Fault{std::move(at),
                 fmt::format("expected a decimal {}{}, found {}", mark_ == '.' ? "point" : "comma", as, found)};
}

std::optional<Marks::Fault> Marks::number(Kind kind, long line, std::size_t column, std::string_view text) {
    bool const doubtful = kind == Kind::comma_or_group || kind == Kind::point_or_group;
    if (!doubtful && kind != Kind::comma && kind != Kind::point) return std::nullopt;
    char const mark = kind == Kind::comma || kind == Kind::comma_or_group ? ',' : '.';
    if (!doubtful || (mark_ != 0 && mark_ != mark))
        return mark_ == mark ? std::nullopt : set_mark(mark, {line, column, std::string(text)});
    auto& first = mark == ',' ? comma_group_ : point_group_;
    if (!given_ && !first) first = Cell{line, column, std::string(text)};
    return std::nullopt;
}

void Marks::row(Row const& row, long line) {
    if (given_) return;
    columns_.resize(row.size());
    auto const look_at = [&](std::size_t i) {
        std::string_view const cell = row[i];
        Column& column = columns_[i];
        bool const marked = cell.find_first_of(".,") != cell.npos;
        if (marked && !column.group) column.group = reading_of(cell).kind == Kind::point_or_group;
        if (!marked && !column.whole && cell.find_first_not_of("0123456789", cell.starts_with('-')) == cell.npos &&
            reading_of(cell).kind == Kind::whole)
            column.whole = Cell{line, i, std::string(cell)};
        char const mark = mark_shown(cell);
        if (auto& first = mark == ',' ? comma_ : point_; mark != 0 && !first) first = Cell{line, i, std::string(cell)};
    };
    if (mark_ != 0)  // a decimal comma alone can contradict it then
        for (std::size_t i = 0; !comma_ && (i = row.with_one(',', i)) < row.size(); ++i) look_at(i);
    else
        for (std::size_t i = 0; i < row.size(); ++i) look_at(i);
}

std::optional<Marks::Fault> Marks::end(char separator) const {
    auto const doubt = [](Cell const& at, std::optional<Cell> const& other) {
        bool const comma = at.text.find(',') != at.text.npos;
        std::string shown = "no number says which";
        if (other) {
            auto const has = [&](char mark) { return other->text.find(mark) != other->text.npos; };
            shown = fmt::format("{} in line {} has {}", in_quotes(other->text), other->line,
                                has(comma ? '.' : ',')   ? comma ? "a decimal point" : "a decimal comma"
                                : !has('.') && !has(',') ? "no decimals"
                                : comma                  ? "commas between thousands"
                                                         : "points between thousands");
        }
        return Fault{
            at,
            fmt::format("{} may be a decimal {} or a mark between thousands, and {} (--decimal {} if it is the former; "
                        "take it out if it is the latter)",
                        in_quotes(at.text), comma ? "comma" : "point", shown, comma ? ',' : '.')};
    };
    if (point_group_ && comma_) return doubt(*point_group_, comma_);
    if (mark_ != 0) return std::nullopt;
    if (comma_group_ && point_) return doubt(*comma_group_, point_);
    if (comma_group_ && point_group_) return Fault{*comma_group_, complaint(Kind::grouped, comma_group_->text)};
    if (comma_group_ && !comma_) return doubt(*comma_group_, std::nullopt);
    if (!point_group_ || point_) return std::nullopt;
    auto const mixed = std::ranges::find_if(columns_, [](Column const& c) { return c.group && c.whole; });
    if (mixed != columns_.end()) return doubt(*point_group_, mixed->whole);
    if (separator == ';') return doubt(*point_group_, std::nullopt);
    return std::nullopt;
}

// --- times: one clock a column, since hours of two places cannot be put in order -------------------------------------

std::optional<double> TimeCells::read(Reading reading, std::string_view cell, long line, std::size_t column) {
    auto const time = is_value(reading.kind) ? std::optional(reading.value) : time_in(cell);
    std::string const found = in_quotes(cell);
    if (!time) {
        expected =
            "expected a time (a number, 2024-05-17 06:00:00, 17.05.2024 06:00, 06:00:00, an offset behind as +02:00), "
            "found " +
            found;
        unread = found + " is not read as a time (2024-05-17 06:00:00 is)";
        return {};
    }
    if (reading.kind == Kind::missing) return time;
    if (is_value(reading.kind)) first_.try_emplace(reading.kind, Marks::Cell{line, column, std::string(cell)});
    Written const here = is_value(reading.kind) ? Written::number : written(cell);
    if (written_ == Written::missing) written_ = here, line_ = line;
    if (here == written_) return time;
    char const* const above = written_ == Written::number   ? "a number"
                              : written_ == Written::hour   ? "an hour without a date"
                              : written_ == Written::offset ? "a time with its offset from UTC (Z, +02:00)"
                                                            : "a date without an offset from UTC";
    expected = fmt::format("expected {} as in line {}, found {}", above, line_, found);
    unread = fmt::format("{} in line {} is not {} as in line {}", found, line, above, line_);
    return {};
}

bool TimeCells::in_doubt(Marks of_others, char separator) {
    for (auto const& [kind, at] : first_)
        if (of_others.number(kind, at.line, at.column, at.text)) {
            unread = fmt::format("{} in line {} has another mark than the numbers", in_quotes(at.text), at.line);
            return true;
        }
    auto const fault = of_others.end(separator);
    if (fault)
        unread = fmt::format("{} in line {} may have a decimal mark or one between thousands",
                             in_quotes(fault->at.text), fault->at.line);
    return fault.has_value();
}

}  // namespace rlslab::csv
