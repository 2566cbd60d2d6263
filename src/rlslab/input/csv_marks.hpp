// Which decimal mark a file has, as its numbers show. Internal to the reader of CSV files.
#pragma once

#include <rlslab/input/csv_number.hpp>
#include <rlslab/input/csv_text.hpp>

namespace rlslab::csv {

/// The mark is given, or that of the first number that can be read in one way alone. "1,234" and "1.234" may have a
/// mark between thousands instead: the other numbers decide, also those in columns that are not requested. A program
/// that writes three decimals writes them in every row: "967" and "1.047" in one column are in doubt.
class Marks {
public:
    struct Cell {
        long line;
        std::size_t column;
        std::string text;
    };
    /// A cell and what is wrong with it.
    struct Fault {
        Cell at;
        std::string message;
    };

    explicit Marks(char given) : given_(given != 0), mark_(given) {}
    /// A number that is requested.
    std::optional<Fault> number(Kind kind, long line, std::size_t column, std::string_view text);
    /// All cells of a row.
    void row(Row const& row, long line);
    /// After the last row.
    std::optional<Fault> end(char separator) const;

private:
    bool given_;
    char mark_;                                      // 0: not known yet
    long line_ = 0;                                  // that showed it
    std::optional<Cell> comma_group_, point_group_;  // the first like "1,234" and "1.234"
    std::optional<Cell> comma_, point_;              // the first decimal comma and point in any column
    struct Column {
        std::optional<Cell> whole;  // the first like "967"
        bool group = false;         // one like "1.047"
    };
    std::vector<Column> columns_;

    std::optional<Fault> set_mark(char mark, Cell at);
};

}  // namespace rlslab::csv
