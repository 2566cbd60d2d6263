// Cells of columns that are not requested are read only where they contain a mark.
#include <rlslab/input/csv_marks.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::csv {

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

}  // namespace rlslab::csv
