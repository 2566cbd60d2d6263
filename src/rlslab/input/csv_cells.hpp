// From cells to numbers and times, and which decimal mark a file has. Internal to the reader of CSV files.
#pragma once

#include <rlslab/input/csv_text.hpp>
#include <rlslab/input/times.hpp>

#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rlslab::csv {

/// What a cell contains. A mark is decimal (`point`, `comma`), or certainly between thousands (`grouped`: "1,234,567",
/// "1,234.5"), or may be either (`point_or_group`, `comma_or_group`: "1.234", "1,234").
enum class Kind { whole, point, point_or_group, comma, comma_or_group, grouped, missing, infinite, out_of_range, text };

struct Reading {
    Kind kind;
    double value = std::numeric_limits<double>::quiet_NaN();  // a mark that may be either read as decimal
};
/// words: what stands for a missing value besides the usual words; "-999" also for "-999.0".
Reading reading_of(std::string_view cell, std::vector<std::string> const& words = {});
/// Whether one of the words is that number.
bool is_among(std::vector<std::string> const& words, double value);
/// "-999.9" where that is the value and two words that follow one another are its halves: -999,9 was written for one
/// word. Empty: it is none.
std::string torn(std::vector<std::string> const& words, double value);

/// Whether the cell has a value or is missing.
bool is_value(Kind kind);
/// "expected a number, found ...", for a cell without a value.
std::string complaint(Kind kind, std::string_view cell);

// Which decimal mark a file has, as its numbers show.

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

/// The cells of a column of times: each is one, and all are written alike.
class TimeCells {
public:
    /// The time in the next cell. Nothing: it is none, and the sentences below say why.
    std::optional<double> read(Reading reading, std::string_view cell, long line, std::size_t column);
    /// Whether a mark of these numbers may stand between thousands, or is not that of the others; `unread` says so.
    bool in_doubt(Marks of_others, char separator);
    bool numbers() const { return written_ == Written::number; }

    std::string expected;  ///< "expected a time ..., found ..."
    std::string unread;    ///< "... is not read as a time ...", of a column that nobody asked for

private:
    Written written_ = Written::missing;
    long line_ = 0;                      // that showed it
    std::map<Kind, Marks::Cell> first_;  // of each kind of number
};

}  // namespace rlslab::csv
