// Reads a file of columns in any format that the commands accept: CSV, compressed CSV, or MATLAB's.
#pragma once

#include <rlslab/input/csv.hpp>

namespace rlslab {

struct DataFile {
    std::string path;  ///< "-": standard input
    CsvFormat format;  ///< for CSV; 0: found out
    DataFile(std::string at = "", CsvFormat as = {}) : path(std::move(at)), format(as) {}
};

/// The columns named in `requested`. The first bytes of the file decide its format, not its name. Its digest is
/// in the answer. time: the column of times (CsvFile::read), which is not looked for in MATLAB's files. Throws
/// InputError.
Columns read_data(DataFile const& file, std::vector<std::string> const& requested, std::string const& time = "");
/// The same of a text in memory; `file`: its name in messages.
Columns read_text(std::string_view text, std::string const& file, std::vector<std::string> const& requested,
                  std::string const& time = "");

}  // namespace rlslab
