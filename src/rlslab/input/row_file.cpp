// A file of rows, by POSIX: pread does not use the file's position, which threads would have to share.
#include <rlslab/input/row_file.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>
#include <utility>

namespace rlslab {
namespace {

constexpr std::string_view numpy = "\x93NUMPY";  // as a number it is below 2e-309: no other file of rows begins so
constexpr std::string_view type = std::endian::native == std::endian::little ? "'descr':'<f8'" : "'descr':'>f8'";

/// Rows and columns of an array, from the header of its .npy file; nothing unless it is of binary64 numbers, row by
/// row, with two dimensions.
std::optional<std::pair<Index, Index>> shape_of(std::string header) {
    auto const digit = [](char c) { return c >= '0' && c <= '9'; };
    for (size_t i = 1, j; (i = header.find(' ', i)) != header.npos; i = j) {  // "1 2" is not 12
        j = std::min(header.find_first_not_of(' ', i), header.size());
        if (digit(header[i - 1]) && j < header.size() && digit(header[j])) return std::nullopt;
    }
    std::erase(header, ' ');
    for (char const* name : {"'descr':", "'fortran_order':", "'shape':"})
        if (header.find(name) != header.rfind(name)) return std::nullopt;  // Python takes the last, a reader the first
    constexpr std::string_view key = "'shape':(";
    size_t const at = header.find(key);
    if (header.find(type) == header.npos || header.find("'fortran_order':False") == header.npos || at == header.npos)
        return std::nullopt;
    Index rows = 0, columns = 0;
    char const* const end = header.c_str() + header.size();  // a zero, which ends both numbers
    auto const first = std::from_chars(header.c_str() + at + key.size(), end, rows);
    if (first.ec != std::errc() || *first.ptr != ',') return std::nullopt;
    auto const second = std::from_chars(first.ptr + 1, end, columns);
    if (second.ec != std::errc() || *second.ptr != ')') return std::nullopt;
    return std::pair(rows, columns);
}

}  // namespace

RowFile::RowFile(std::string const& path, std::optional<Index> size) : file_(printable(path, 200)), descriptor_(-1) {
    expects(!size || (*size >= 1 && *size < (Index{1} << 48)), "1 <= size < 2^48");
    descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe nobody writes to is not waited for
    if (descriptor_ < 0) throw InputError(fmt::format("{}: {}", file_, std::strerror(errno)));
    try {
        find_rows(size);
    } catch (...) {
        close(descriptor_);  // the destructor is not run
        throw;
    }
}

RowFile::~RowFile() { close(descriptor_); }

void RowFile::refuse(std::string const& why) const { throw InputError(file_ + ": " + why); }

/// Sets size_, rows_ and begin_.
void RowFile::find_rows(std::optional<Index> size) {
    struct stat about;
    if (fstat(descriptor_, &about) != 0) refuse(std::strerror(errno));
    if (S_ISDIR(about.st_mode)) refuse("is a directory");
    if (!S_ISREG(about.st_mode)) refuse("is not a regular file");
    if (about.st_size == 0) refuse("is empty");
    Index const bytes = about.st_size;
    char first[numpy.size()] = {};
    read_bytes(first, size_t(std::min<Index>(bytes, sizeof first)), 0);
    if (std::string_view(first, sizeof first) == numpy) return find_array(bytes, size);
    if (!size) refuse("is no .npy file: the number of parameters has to be given");
    size_ = *size;
    Index const row = (size_ + 1) * Index(sizeof(double));
    rows_ = bytes / row;
    if (bytes % row != 0)
        refuse(fmt::format("expected rows of {} numbers ({} bytes each), found {} bytes: {} more than whole rows",
                           size_ + 1, row, bytes, bytes % row));
}

/// The same for a .npy file: after its name two bytes for the format's version, then the length of the text (two bytes
/// in version 1, later four, the lowest first), the text, and the numbers.
void RowFile::find_array(Index bytes, std::optional<Index> size) {
    unsigned char first[12] = {};
    read_bytes(reinterpret_cast<char*>(first), size_t(std::min<Index>(bytes, sizeof first)), 0);
    if (bytes < 10) refuse("ends within its header");
    int const version = first[numpy.size()];
    if (version < 1 || version > 3) refuse(fmt::format("expected version 1, 2 or 3 of .npy, found {}", version));
    Index const text = version == 1 ? 10 : 12;
    for (Index i = text; i-- > 8;) begin_ = begin_ << 8 | first[i];
    std::string header(size_t(std::min<Index>(begin_, 4096)), ' ');  // a header of ours is shorter
    begin_ += text;
    if (bytes < begin_) refuse("ends within its header");
    read_bytes(header.data(), header.size(), text);
    auto const shape = shape_of(header);
    if (!shape)
        refuse("expected float64 in this machine's byte order, row by row (C order), two dimensions, found " +
               printable(header.substr(0, header.find_last_not_of(" \n") + 1), 200));
    auto const [rows, columns] = *shape;
    if (size ? columns != *size + 1 : columns < 2)
        refuse(fmt::format("expected {} columns, found {} x {}", size ? std::to_string(*size + 1) : "at least 2", rows,
                           columns));
    if (rows < 1) refuse("has no rows");
    Index const left = bytes - begin_, numbers = left / Index(sizeof(double));
    if (left % Index(sizeof(double)) != 0 || numbers % columns != 0 || numbers / columns != rows)
        refuse(fmt::format("expected {} rows of {} numbers of 8 bytes, found {} bytes", rows, columns, left));
    size_ = columns - 1;
    rows_ = rows;
}

void RowFile::read(Index first, Eigen::Ref<Matrix<double>> block) const {
    expects(block.rows() == size_ + 1 && block.outerStride() == block.rows(),
            "a contiguous block of (d + 1) x B numbers");
    expects(0 <= first && first + block.cols() <= rows_, "rows that the file has");
    read_bytes(reinterpret_cast<char*>(block.data()), size_t(block.size()) * sizeof(double),
               begin_ + first * (size_ + 1) * Index(sizeof(double)));
}

void RowFile::read_bytes(char* to, std::size_t left, Index at) const {
    while (left > 0) {
        ssize_t const got = pread(descriptor_, to, left, off_t(at));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) refuse(std::strerror(errno));
        if (got == 0) refuse("became shorter while it was read");
        to += got;
        at += got;
        left -= size_t(got);
    }
}

}  // namespace rlslab
