// A file of columns in any form that the commands read: CSV, the same compressed, or MATLAB's.
#pragma once

#include <rlslab/model/csv.hpp>

namespace rlslab {

struct DataFile {
    std::string path;  ///< "-": standard input
    CsvFormat format;  ///< as far as it is given
    DataFile(std::string at = "", CsvFormat as = {}) : path(std::move(at)), format(as) {}
};

/// The columns asked for; what the file is, its first bytes say, not its name. Throws InputError.
Columns read_data(DataFile const& file, std::vector<std::string> const& asked);

}  // namespace rlslab
