// Tables are small: selections copy.
#include <rlslab/studies/table.hpp>

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <stdexcept>

namespace rlslab::studies {

std::string as_text(Cell const& cell) {
    if (auto const* const word = std::get_if<std::string>(&cell)) return *word;
    double const number = std::get<double>(cell);
    return number != number ? "nan" : fmt::format("{}", number);
}

bool Table::has(std::string_view column) const { return std::ranges::find(columns_, column) != columns_.end(); }

size_t Table::index(std::string_view column) const {
    auto const found = std::ranges::find(columns_, column);
    if (found == columns_.end()) throw std::logic_error(fmt::format("no column \"{}\" in a table", column));
    return size_t(found - columns_.begin());
}

void Table::add(std::vector<Cell> row) {
    if (row.size() != columns_.size())
        throw std::logic_error(fmt::format("a row of {} cells in a table of {} columns", row.size(), columns_.size()));
    rows_.push_back(std::move(row));
}

void Table::add_line(std::string_view line) {
    std::vector<Cell> row;
    for (size_t from = 0;;) {
        size_t const to = std::min(line.find(',', from), line.size());
        std::string_view const text = line.substr(from, to - from);
        double number = 0;
        auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        if (!text.empty() && error == std::errc() && end == text.data() + text.size()) row.emplace_back(number);
        else row.emplace_back(std::string(text));
        if (to == line.size()) break;
        from = to + 1;
    }
    add(std::move(row));
}

namespace {
template <class Keeps>
Table kept(Table const& table, std::string_view column, Keeps keeps) {
    size_t const at = table.index(column);
    Table out(table.columns());
    for (auto const& row : table.rows())
        if (keeps(row[at])) out.add(row);
    return out;
}
}  // namespace

Table Table::where(std::string_view column, Cell const& value) const {
    return kept(*this, column, [&](Cell const& cell) { return cell == value; });
}
Table Table::where(std::string_view column, std::function<bool(double)> const& holds) const {
    return kept(*this, column, [&](Cell const& cell) {
        auto const* const number = std::get_if<double>(&cell);
        return number && holds(*number);
    });
}
Table Table::where(std::string_view column, std::vector<std::string> const& words) const {
    return kept(*this, column,
                [&](Cell const& cell) { return std::ranges::find(words, as_text(cell)) != words.end(); });
}

std::vector<double> Table::numbers(std::string_view column) const {
    size_t const at = index(column);
    std::vector<double> out;
    for (auto const& row : rows_) {
        auto const* const number = std::get_if<double>(&row[at]);
        if (!number)
            throw std::logic_error(fmt::format("\"{}\" in column \"{}\" is no number", as_text(row[at]), column));
        out.push_back(*number);
    }
    return out;
}

std::vector<Cell> Table::distinct(std::string_view column) const {
    size_t const at = index(column);
    std::vector<Cell> out;
    for (auto const& row : rows_)
        if (std::ranges::find(out, row[at]) == out.end()) out.push_back(row[at]);
    return out;
}

double Table::number(std::string_view column) const {
    if (rows_.size() != 1)
        throw std::logic_error(fmt::format("expected one row for its {1}, found {0}", rows_.size(), column));
    return numbers(column).front();
}

std::vector<std::pair<std::string, Table>> Table::groups(std::vector<std::string> const& by) const {
    std::vector<size_t> at;
    for (std::string const& column : by) at.push_back(index(column));
    std::vector<std::pair<std::string, Table>> out;
    for (auto const& row : rows_) {
        std::string name;
        for (size_t const i : at) {
            bool const word = std::holds_alternative<std::string>(row[i]);
            name += (name.empty() ? "" : ", ") + (word ? "" : columns_[i] + " ") + as_text(row[i]);
        }
        auto found = std::ranges::find(out, name, [](auto const& group) { return group.first; });
        if (found == out.end()) found = out.insert(out.end(), {name, Table(columns_)});
        found->second.add(row);
    }
    return out;
}

std::string csv_line(std::vector<Cell> const& row) {
    std::string out;
    for (size_t i = 0; i < row.size(); ++i) {
        std::string const text = as_text(row[i]);
        if (text.find_first_of(",\"\n\r") != std::string::npos)
            throw std::logic_error(fmt::format("\"{}\" would need quotes in CSV", text));
        out += (i ? "," : "") + text;
    }
    return out;
}

}  // namespace rlslab::studies
