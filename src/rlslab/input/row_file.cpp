// A file of rows, by POSIX: pread does not use the file's position, which threads would have to share.
#include <rlslab/input/row_file.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace rlslab {

RowFile::RowFile(std::string const& path, Index size) : file_(printable(path, 200)), size_(size), descriptor_(-1) {
    expects(size >= 1 && size < (Index{1} << 48), "1 <= size < 2^48");
    descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe nobody writes to is not waited for
    if (descriptor_ < 0) throw InputError(fmt::format("{}: {}", file_, std::strerror(errno)));
    struct stat about;
    std::string wrong;
    Index const row = (size + 1) * Index(sizeof(double));
    if (fstat(descriptor_, &about) != 0) wrong = std::strerror(errno);
    else if (S_ISDIR(about.st_mode)) wrong = "is a directory";
    else if (!S_ISREG(about.st_mode)) wrong = "is not a regular file";
    else if (about.st_size == 0) wrong = "is empty";
    else if (about.st_size % row != 0)
        wrong = fmt::format("expected rows of {} numbers ({} bytes each), found {} bytes: {} more than whole rows",
                            size + 1, row, about.st_size, about.st_size % row);
    if (!wrong.empty()) {
        close(descriptor_);  // the destructor is not run
        throw InputError(file_ + ": " + wrong);
    }
    rows_ = about.st_size / row;
}

RowFile::~RowFile() { close(descriptor_); }

void RowFile::read(Index first, Eigen::Ref<Matrix<double>> block) const {
    expects(block.rows() == size_ + 1 && block.outerStride() == block.rows(),
            "a contiguous block of (d + 1) x B numbers");
    expects(0 <= first && first + block.cols() <= rows_, "rows that the file has");
    auto* to = reinterpret_cast<char*>(block.data());
    auto left = size_t(block.size()) * sizeof(double);
    auto at = off_t(first * (size_ + 1) * Index(sizeof(double)));
    while (left > 0) {
        ssize_t const got = pread(descriptor_, to, left, at);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw InputError(fmt::format("{}: {}", file_, std::strerror(errno)));
        if (got == 0) throw InputError(file_ + ": became shorter while it was read");
        to += got;
        at += got;
        left -= size_t(got);
    }
}

}  // namespace rlslab
