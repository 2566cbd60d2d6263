// A table of numbers in text, and regression rows made from its columns.
#pragma once

#include "docs/site/live/measures.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace rlslab::live {

/// A CSV file as people drop it. Unlike the program's reader (input/csv.hpp) it needs neither exceptions nor fmt nor
/// from_chars of doubles, which Debian's emscripten lacks, and reads fewer dialects:
///   separator   tab if the first row has one outside quotes, else semicolon, else comma, else blanks
///   header      the first row, if it has a cell that is neither missing nor a number
///   numbers     decimal, with a comma in place of the point where no comma separates; magnitudes up to 2^500
///   missing     an empty cell, NA, N/A, NaN, null in any case, "." and "?"
///   skipped     blank lines, lines that begin with '#', a byte order mark
struct Table {
    struct Column {
        std::string name;
        std::vector<double> numbers;  ///< NaN: missing
        long missing = 0;
        long not_a_number = 0;  ///< the first line with something else: the column is of no use; 0: none
    };
    std::vector<Column> columns;
    std::string error;  ///< why there is none, in one line; empty: it was read
    long rows() const { return columns.empty() ? 0 : long(columns[0].numbers.size()); }
};
inline constexpr long most_rows = 20'000;  ///< of a table; later ones are left out
Table read_table(std::string_view text);

/// y[k] on past outputs y[k-1] ... y[k-past], each input u[k] ... u[k-delays], and 1.
struct Model {
    size_t output = 0;
    std::vector<size_t> inputs;
    int past = 0, delays = 0;
    bool constant = false;
};
/// Columns and output are divided by powers of two, so that their root mean squares are near 1: no digit changes, and
/// theta_i = scaled theta_i y_scale / scales_i.
struct Rows {
    std::vector<std::string> names;  ///< d: "u[k-1]", "u", "1"
    std::vector<double> psi, y;      ///< d numbers for each row
    std::vector<double> scales;
    double y_scale = 1;
    long skipped = 0;   ///< for a missing value
    std::string error;  ///< why there are none; empty: there are
    int d() const { return int(names.size()); }
    long rows() const { return long(y.size()); }
};
Rows rows_of(Table const& table, Model const& model);

}  // namespace rlslab::live
