// Long-form tables: one observation a row, columns by name, written as CSV and read back without loss.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rlslab::studies {

/// A number or a word. A number is written in the fewest digits that read back to its bits, or as "nan", "inf", "-inf".
using Cell = std::variant<double, std::string>;
std::string as_text(Cell const& cell);

class Table {
    std::vector<std::string> columns_;
    std::vector<std::vector<Cell>> rows_;

public:
    Table() = default;
    explicit Table(std::vector<std::string> columns) : columns_(std::move(columns)) {}

    std::vector<std::string> const& columns() const { return columns_; }
    std::vector<std::vector<Cell>> const& rows() const { return rows_; }
    bool empty() const { return rows_.empty(); }
    bool has(std::string_view column) const;
    /// Throws std::logic_error if there is no such column.
    size_t index(std::string_view column) const;

    void add(std::vector<Cell> row);
    /// Adds a line of CSV without quotes. A cell that can be read as a number becomes one.
    void add_line(std::string_view line);

    /// The rows whose cell in this column is the value, a number for which `holds` is true, or one of these words.
    Table where(std::string_view column, Cell const& value) const;
    Table where(std::string_view column, std::function<bool(double)> const& holds) const;
    Table where(std::string_view column, std::vector<std::string> const& words) const;

    std::vector<double> numbers(std::string_view column) const;
    /// Each value once, in order of appearance.
    std::vector<Cell> distinct(std::string_view column) const;
    /// The number in this column of a table with one row. Throws std::logic_error for more rows or none.
    double number(std::string_view column) const;

    /// Rows grouped by their cells in these columns, in order of appearance. A group's name is "joseph, lambda 0.98".
    std::vector<std::pair<std::string, Table>> groups(std::vector<std::string> const& by) const;
};

/// Without quotes: throws std::logic_error for a word that would need them.
std::string csv_line(std::vector<Cell> const& row);

}  // namespace rlslab::studies
