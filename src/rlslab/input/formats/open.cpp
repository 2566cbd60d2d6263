// The first bytes of a file decide which reader is used.
#include <rlslab/input/formats/open.hpp>

#include <rlslab/input/csv_cells.hpp>
#include <rlslab/input/csv_text.hpp>
#include <rlslab/input/formats/gzip.hpp>
#include <rlslab/input/formats/mat.hpp>
#include <rlslab/input/sha256.hpp>
#include <rlslab/input/times.hpp>

#include <algorithm>
#include <limits>

namespace rlslab {
namespace {

Columns read_any(ByteSource bytes, DataFile const& file, std::vector<std::string> requested, std::string const& time) {
    std::string const name = name_of_file(file.path);
    std::string begin = detail::peek(bytes, mat_begin);
    bool const compressed = begin.starts_with(gzip_begins);
    if (compressed) {
        bytes = unpacked(std::move(bytes), name);
        begin = detail::peek(bytes, mat_begin);
    }
    if (!is_mat(begin)) return CsvFile(std::move(bytes), name, file.format).read(requested, time);
    if (file.format.separator != 0 || file.format.decimal != 0)
        throw InputError(name + ": a MATLAB file has no separators and decimal marks");
    bool const new_one = !time.empty() && std::ranges::find(requested, time) == requested.end();
    if (new_one) requested.push_back(time);
    if (is_mat73(begin) && (compressed || file.path == "-"))
        throw InputError(name + ": a MATLAB file of version 7.3 is read from a regular file alone");
    Columns out = is_mat73(begin) ? read_mat73(file.path, requested) : read_mat5(std::move(bytes), name, requested);
    for (auto& column : out.values)
        std::ranges::replace_if(
            column, [&](double x) { return csv::is_among(file.format.missing, x); },
            std::numeric_limits<double>::quiet_NaN());
    if (!time.empty()) out.time = time, out.times = out[time], stamps_to_seconds(out);
    if (new_one) out.names.pop_back(), out.values.pop_back();
    return out;
}

ByteSource bytes_of(std::string_view text) {
    return [text, at = std::make_shared<std::size_t>(0)](std::span<char> to) {
        std::size_t const count = text.copy(to.data(), to.size(), *at);
        *at += count;
        return count;
    };
}

Columns read_bytes(ByteSource source, DataFile const& file, std::vector<std::string> const& requested,
                   std::string const& time) {
    auto const digest = std::make_shared<Sha256>();
    ByteSource const bytes = digested(std::move(source), digest);
    Columns out = read_any(bytes, file, requested, time);
    std::vector<char> rest(1 << 16);  // what a reader of MATLAB's variables did not need
    while (bytes(rest) > 0) {}
    out.sha256 = digest->hex();
    return out;
}

}  // namespace

Columns read_data(DataFile const& file, std::vector<std::string> const& requested, std::string const& time) {
    return read_bytes(file.begun ? file.begun : bytes_of_file(file.path), file, requested, time);
}

std::vector<std::string> columns_among(std::vector<std::string> const& words, DataFile& file) {
    constexpr std::size_t looked_at = 1 << 20;
    file.begun = bytes_of_file(file.path);
    std::string const begin = detail::peek(file.begun, looked_at), name = name_of_file(file.path);
    try {
        ByteSource bytes = bytes_of(begin);
        if (begin.starts_with(gzip_begins)) bytes = unpacked(std::move(bytes), name);
        if (!is_mat(detail::peek(bytes, mat_begin))) return csv::cells_among(words, std::move(bytes), name);
    } catch (InputError const&) {  // told, with its place, when the columns are read
    }
    return {};
}

Columns read_text(std::string_view text, std::string const& file, std::vector<std::string> const& requested,
                  std::string const& time) {
    return read_bytes(bytes_of(text), {file}, requested, time);
}

}  // namespace rlslab
