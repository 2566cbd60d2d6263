// Reads a file of columns in any format that the commands accept: CSV, compressed CSV, or MATLAB's.
#pragma once

#include <rlslab/input/csv.hpp>

namespace rlslab {

struct DataFile {
    std::string path;       ///< "-": standard input
    CsvFormat format;       ///< for CSV; 0: found out
    ByteSource begun = {};  ///< its bytes, if some were read before (columns_among)
    DataFile(std::string at = "", CsvFormat as = {}) : path(std::move(at)), format(as) {}
};

/// Those of the words that are names of columns: cells of one of the file's first 100 lines. None of a MATLAB file.
/// `file` then has its bytes from the beginning, also where they can be read but once.
std::vector<std::string> columns_among(std::vector<std::string> const& words, DataFile& file);

/// The columns named in `requested`. The first bytes of the file decide its format, not its name. Its digest is
/// in the answer. time: the column of times (CsvFile::read), which is not looked for in MATLAB's files. Throws
/// InputError.
Columns read_data(DataFile const& file, std::vector<std::string> const& requested, std::string const& time = "");
/// The same of a text in memory; `file`: its name in messages.
Columns read_text(std::string_view text, std::string const& file, std::vector<std::string> const& requested,
                  std::string const& time = "");

}  // namespace rlslab
