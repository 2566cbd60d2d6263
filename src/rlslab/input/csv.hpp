// Reads numbers from CSV files of many dialects, in bounded memory. Errors name line and column.
#pragma once

#include <rlslab/core/problem.hpp>
#include <rlslab/input/bytes.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rlslab {

/// Columns of numbers as read; a missing value is NaN.
struct Columns {
    std::string file;                              ///< its name in messages
    bool header = true;                            ///< false: the names are the columns' numbers
    std::vector<std::string> names = {};           ///< in the order of the request
    std::vector<std::vector<double>> values = {};  ///< one per name, of rows() numbers each
    std::vector<long> lines = {};                  ///< rows(): the line of the file on which each row begins, from 1
    std::string sha256 = {};                       ///< of the whole file, as read_data leaves it; otherwise empty
    std::string time = {};                         ///< a column of times; empty: none
    std::vector<double> times = {};                ///< rows() of them
    std::string unread_time = {};                  ///< why `time` is not read, if it is called as one
    Index rows() const { return Index(lines.size()); }
    /// The column of that name. Throws std::invalid_argument when it is not among names.
    std::vector<double> const& operator[](std::string const& name) const;
};

/// Larger magnitudes are refused: a square is then at most 2^1000, and sums of 2^23 squares stay below binary64's
/// 2^1024.
inline constexpr double largest_value = 0x1p500;
/// More numbers are refused (2 GiB): a few compressed bytes may unpack to any amount.
inline constexpr long most_numbers = 1L << 28;

/// The format of a text. 0: found out from the text.
struct CsvFormat {
    char separator = 0;                     ///< ',', ';', '\t', '|', or ' ' for runs of blanks and tabs
    char decimal = 0;                       ///< '.' or ','
    std::vector<std::string> missing = {};  ///< cells that are no values, besides the usual words; case is ignored
};

/// A CSV file; the constructor opens it and reads its first row. The rest of the format is found out:
///   separator   that of a first line "sep=;"; else tab if the first row has one outside quotes, else semicolon, else
///               bar if the next row has as many, else comma, else blanks if the next row has as many cells
///   header      the first row, if any cell is neither missing nor a number ("inf", "1e999" and "1,234,567" are bad
///               numbers); not where all columns are requested by number, and it is text and numbers over text and
///               numbers in the same columns. Where it has not all names that are requested: the comment above it, or
///               the first of the next 100 rows that has them all above a row of equally many cells (a preamble)
///   rows        LF, CRLF or CR; lines of '#', '%', '!' or "//" above the first row and blank lines are skipped, but a
///               blank line between rows of one cell is a missing value; all have equally many cells
///   cells       may be quoted, with quotes in them doubled, and then contain separators and line ends; outer spaces
///               are dropped
///   numbers     decimal; not hexadecimal, infinite, beyond largest_value, or so small as to round to 0
///   decimals    a point or a comma, the same in the columns read. "1,234" may have a mark between thousands instead,
///               and so may "1.234" where a semicolon separates, any cell has a decimal comma, or a column has whole
///               numbers, too: a number of another form, in any column, must show which
///   missing     an empty cell, NA, N/A, #N/A, NaN, null in any case, "." and "?", and the words of the format
/// The name of a column is that in the header; without a header it is the column's number: "1", "2", ... `names` knows
/// the first row alone.
class CsvFile {
public:
    /// Opens path ("-": standard input; it may be a FIFO, because all is read once and in order). Throws InputError
    /// when it cannot be opened or read, is empty, or is no table of text; std::invalid_argument for a format of other
    /// characters.
    explicit CsvFile(std::string const& path, CsvFormat format = {});
    /// The same for any bytes; `file` is their name in messages, and more than `most` numbers are refused.
    CsvFile(ByteSource bytes, std::string file, CsvFormat format = {}, long most = most_numbers);
    CsvFile(CsvFile&&) noexcept;
    CsvFile& operator=(CsvFile&&) noexcept;
    ~CsvFile();

    std::string const& file() const;                ///< its name in messages
    bool has_header() const;                        ///< `read` may find out that there is none
    std::vector<std::string> const& names() const;  ///< one for each column, numbers if there is no header

    /// Reads the columns named in `requested` to the end of the data; other columns may contain anything. May be called
    /// once. Throws InputError for a name that does not exist or is not unique, a cell that is not a number, a row of
    /// another length, a line over 1 MiB, no rows, too many numbers; std::invalid_argument when `requested` is empty or
    /// the file was read before. time: the column of times (time_in), read besides. Empty: the first that is called so,
    /// or else the first of the file, if each of its cells is a time and it is not requested.
    Columns read(std::vector<std::string> const& requested, std::string const& time = "");

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// CsvFile(path, format).read(requested).
Columns read_columns(std::string const& path, std::vector<std::string> const& requested, CsvFormat format = {});

/// The place among `names` of the column `requested`. file, at: the file and the place of its names, for messages.
/// Throws InputError when no column, or more than one, has that name.
std::size_t column_called(std::string const& requested, std::vector<std::string> const& names, bool header,
                          std::string const& file, std::string const& at);

}  // namespace rlslab
