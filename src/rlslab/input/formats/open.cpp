// The first bytes of a file decide which reader is used.
#include <rlslab/input/formats/open.hpp>

#include <rlslab/input/formats/gzip.hpp>
#include <rlslab/input/formats/mat.hpp>

namespace rlslab {

Columns read_data(DataFile const& file, std::vector<std::string> const& requested) {
    ByteSource bytes = bytes_of_file(file.path);
    std::string const name = name_of_file(file.path);
    std::string begin = detail::peek(bytes, mat_begin);
    bool const compressed = begin.starts_with(gzip_begins);
    if (compressed) {
        bytes = unpacked(std::move(bytes), name);
        begin = detail::peek(bytes, mat_begin);
    }
    if (!is_mat(begin)) return CsvFile(std::move(bytes), name, file.format).read(requested);
    if (file.format.separator != 0 || file.format.decimal != 0)
        throw InputError(name + ": a MATLAB file has no separators and decimal marks");
    if (!is_mat73(begin)) return read_mat5(std::move(bytes), name, requested);
    if (compressed || file.path == "-")
        throw InputError(name + ": a MATLAB file of version 7.3 is read from a regular file alone");
    return read_mat73(file.path, requested);
}

}  // namespace rlslab
