// The first bytes of a file decide which reader is used.
#include <rlslab/input/formats/open.hpp>

#include <rlslab/input/formats/gzip.hpp>
#include <rlslab/input/formats/mat.hpp>
#include <rlslab/input/sha256.hpp>

namespace rlslab {
namespace {

Columns read_any(ByteSource bytes, DataFile const& file, std::vector<std::string> const& requested) {
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

Columns read_bytes(ByteSource source, DataFile const& file, std::vector<std::string> const& requested) {
    auto const digest = std::make_shared<Sha256>();
    ByteSource const bytes = digested(std::move(source), digest);
    Columns out = read_any(bytes, file, requested);
    std::vector<char> rest(1 << 16);  // what a reader of MATLAB's variables did not need
    while (bytes(rest) > 0) {}
    out.sha256 = digest->hex();
    return out;
}

}  // namespace

Columns read_data(DataFile const& file, std::vector<std::string> const& requested) {
    return read_bytes(bytes_of_file(file.path), file, requested);
}

Columns read_text(std::string_view text, std::string const& file, std::vector<std::string> const& requested) {
    auto const next = [text, at = std::make_shared<std::size_t>(0)](std::span<char> to) {
        std::size_t const count = text.copy(to.data(), to.size(), *at);
        *at += count;
        return count;
    };
    return read_bytes(next, {file}, requested);
}

}  // namespace rlslab
