// Numbers out of CSV files as people have them, in bounded memory, with errors that say where.
#pragma once

#include <rlslab/core/problem.hpp>
#include <rlslab/model/bytes.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rlslab {

/// Columns of numbers as read; a missing value is NaN.
struct Columns {
    std::string file;                              ///< for people: what messages call it
    bool header = true;                            ///< false: the names are the columns' numbers
    std::vector<std::string> names = {};           ///< as asked for
    std::vector<std::vector<double>> values = {};  ///< one per name, of rows() numbers each
    std::vector<long> lines = {};                  ///< rows(): the line of the file on which each row begins, from 1
    Index rows() const { return Index(lines.size()); }
    /// The column of that name. Throws std::invalid_argument when it is not among names.
    std::vector<double> const& operator[](std::string const& name) const;
};

/// Values beyond are refused: a square is at most 2^1000, and sums of 2^23 of them stay below binary64's 2^1024.
inline constexpr double largest_value = 0x1p500;
/// A file may be a few bytes that unpack to no end: so many numbers are kept, 2 GiB of them, and no more.
inline constexpr long most_numbers = 1L << 28;

/// How a text is to be read; 0: to be found out.
struct CsvFormat {
    char separator = 0;  ///< ',', ';', '\t', '|', or ' ' for runs of blanks and tabs
    char decimal = 0;    ///< '.' or ','
};

/// A CSV file, opened and its first row read. The format is found out where it is not given:
///   separator   what a first line "sep=;" says; else tab if the first row has one outside quotes, else semicolon, else comma,
///               else blanks if the row below has as many cells as it
///   header      the first row, if any cell is neither missing nor a number ("inf", "1e999" and "1,234,567" are bad numbers)
///   rows        LF or CRLF; blank lines are skipped, and '#' lines above the first row; all have equally many cells
///   cells       may be quoted, quotes in them doubled, and then hold separators and line ends; outer spaces go
///   numbers     decimal; not hexadecimal, infinite, beyond largest_value, or so small as to round to 0
///   decimals    a point, or a comma, in the whole file the same; "1,234" must be told by another number from 1234
///   missing     an empty cell, NA, N/A, #N/A, NaN, null in any case, "." and "?"
/// A column is called by its name in the header, and only so; without a header by its number: "1", "2", ...
class CsvFile {
public:
    /// Opens path ("-": standard input; a FIFO is fine: everything is read once, in order).
    /// Throws InputError when it cannot be opened or read, is empty, or is not text; std::invalid_argument for a format of
    /// other characters.
    explicit CsvFile(std::string const& path, CsvFormat format = {});
    /// The same from other bytes, which messages call `file`; of these, `most` numbers are kept.
    CsvFile(ByteSource bytes, std::string file, CsvFormat format = {}, long most = most_numbers);
    CsvFile(CsvFile&&) noexcept;
    CsvFile& operator=(CsvFile&&) noexcept;
    ~CsvFile();

    std::string const& file() const;  ///< what messages call it
    bool has_header() const;
    std::vector<std::string> const& names() const;  ///< one for each column, numbers if there is no header

    /// Reads the columns asked for, to the end of the data; other columns may hold anything. Once only.
    /// Throws InputError for a name that is not there or not unique, a cell that is no number, a row of another length,
    /// a line over 1 MiB, no rows, too many numbers; std::invalid_argument when nothing is asked for or the file was
    /// read before.
    Columns read(std::vector<std::string> const& asked);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// CsvFile(path, format).read(asked).
Columns read_columns(std::string const& path, std::vector<std::string> const& asked, CsvFormat format = {});

/// Which of a file's columns is called that; `at` is where its names stand, for messages. Throws InputError when none is, or several.
std::size_t column_called(std::string const& asked, std::vector<std::string> const& names, bool header, std::string const& file,
                          std::string const& at);

}  // namespace rlslab
