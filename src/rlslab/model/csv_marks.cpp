// Cells of columns that are not asked for are read only where they contain one mark.
#include <rlslab/model/csv_marks.hpp>

#include <fmt/format.h>

namespace rlslab::csv {

std::optional<Marks::Fault> Marks::take_mark(char mark, Cell at) {
    if (mark_ == 0) {
        mark_ = mark;
        line_ = at.line;
        auto const& grouped = mark == '.' ? comma_group_ : point_group_;
        if (grouped) return Fault{*grouped, complaint(Kind::grouped, grouped->text)};
        return std::nullopt;
    }
    std::string const as = given_ ? "" : fmt::format(" as in line {}", line_), found = in_quotes(at.text);
    return Fault{std::move(at), fmt::format("expected a decimal {}{}, found {}", mark_ == '.' ? "point" : "comma", as, found)};
}

std::optional<Marks::Fault> Marks::number(Kind kind, long line, std::size_t column, std::string_view text) {
    bool const doubtful = kind == Kind::comma_or_group || kind == Kind::point_or_group;
    if (!doubtful && kind != Kind::comma && kind != Kind::point) return std::nullopt;
    char const mark = kind == Kind::comma || kind == Kind::comma_or_group ? ',' : '.';
    if (!doubtful || (mark_ != 0 && mark_ != mark))
        return mark_ == mark ? std::nullopt : take_mark(mark, {line, column, std::string(text)});
    auto& first = mark == ',' ? comma_group_ : point_group_;
    if (!given_ && !first) first = Cell{line, column, std::string(text)};
    return std::nullopt;
}

void Marks::row(Row const& row, long line) {
    if (given_) return;
    auto const look = [&](std::optional<Cell>& first, char mark, Kind certain) {
        for (std::size_t i = 0; !first && (i = row.with_one(mark, i)) < row.size(); ++i)
            if (reading_of(row[i]).kind == certain) first = Cell{line, i, std::string(row[i])};
    };
    look(comma_, ',', Kind::comma);
    if (mark_ == 0) look(point_, '.', Kind::point);
}

std::optional<Marks::Fault> Marks::end(char separator) const {
    auto const doubt = [](Cell const& at, std::optional<Cell> const& other) {
        bool const comma = at.text.find(',') != at.text.npos;
        std::string const shown =
            other ? fmt::format("{} in line {} has a decimal {}", in_quotes(other->text), other->line, comma ? "point" : "comma")
                  : "no number says which";
        return Fault{at, fmt::format("{} may be a decimal {} or a mark between thousands, and {} (--decimal {} if it is the former)",
                                     in_quotes(at.text), comma ? "comma" : "point", shown, comma ? ',' : '.')};
    };
    if (point_group_ && comma_) return doubt(*point_group_, comma_);
    if (mark_ != 0) return std::nullopt;
    if (comma_group_ && point_) return doubt(*comma_group_, point_);
    if (comma_group_ && point_group_) return Fault{*comma_group_, complaint(Kind::grouped, comma_group_->text)};
    if (comma_group_ && !comma_) return doubt(*comma_group_, std::nullopt);
    if (point_group_ && !point_ && separator == ';') return doubt(*point_group_, std::nullopt);
    return std::nullopt;
}

}  // namespace rlslab::csv
