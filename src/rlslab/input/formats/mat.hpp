// MATLAB's .mat files: version 5, and version 7.3 by matio.
#pragma once

#include <rlslab/input/csv.hpp>

namespace rlslab {

/// The length of a .mat file's header: a text, a version, and the byte order.
inline constexpr std::size_t mat_begin = 128;
inline bool is_mat(std::string_view begin) {
    if (begin.size() < mat_begin || !begin.starts_with("MATLAB ")) return false;
    return begin.substr(126, 2) == "IM" || begin.substr(126, 2) == "MI";
}
/// Whether it is of version 7.3, which is HDF5.
inline bool is_mat73(std::string_view begin) { return is_mat(begin) && begin[begin[126] == 'I' ? 125 : 124] == 2; }

/// The columns named in `requested` from the variables of a .mat file. A real numeric vector is a column of its own
/// name; a matrix X of at most 1000 columns has the columns X_1, X_2, ... Rows are counted from 1. Throws InputError
/// that names the file and the variable, for a variable of another kind, columns of different lengths, values that
/// CsvFile would refuse, and a damaged file.
Columns read_mat5(ByteSource bytes, std::string const& file, std::vector<std::string> const& requested);
/// The same for version 7.3. Throws InputError also for a file that is not regular, and if the program was built
/// without matio.
Columns read_mat73(std::string const& path, std::vector<std::string> const& requested);

}  // namespace rlslab
