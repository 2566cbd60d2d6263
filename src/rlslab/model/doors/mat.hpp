// MATLAB's .mat files: of version 5, and, by matio, of version 7.3.
#pragma once

#include <rlslab/model/csv.hpp>

namespace rlslab {

/// A .mat file's first bytes: a text, a version, and which end of a number comes first.
inline constexpr std::size_t mat_begin = 128;
inline bool is_mat(std::string_view begin) {
    if (begin.size() < mat_begin || !begin.starts_with("MATLAB ")) return false;
    return begin.substr(126, 2) == "IM" || begin.substr(126, 2) == "MI";
}
/// Of version 7.3, which is HDF5.
inline bool is_mat73(std::string_view begin) { return is_mat(begin) && begin[begin[126] == 'I' ? 125 : 124] == 2; }

/// The columns asked for out of a .mat file's variables: a real numeric vector is one by its own name, a matrix X of at most
/// 1000 columns is X_1, X_2, ... Rows are counted from 1. Throws InputError that names the file, and the variable, for one that
/// is something else, columns of different lengths, values that CsvFile would refuse, and a damaged file.
Columns read_mat5(ByteSource bytes, std::string const& file, std::vector<std::string> const& asked);
/// The same of version 7.3; also for a file that is not regular, and where the program was built without matio.
Columns read_mat73(std::string const& path, std::vector<std::string> const& asked);

}  // namespace rlslab
