// Rows of binary64 numbers in a file of any size, with NumPy's header or without. Any part can be read, with memory for
// that part only.
#pragma once

#include <rlslab/core/input_error.hpp>
#include <rlslab/core/problem.hpp>

#include <optional>
#include <string>

namespace rlslab {

/// A file of rows [psi_1 ... psi_d y] of binary64 numbers in the machine's byte order, without separators: as
/// `numpy.save` writes an array of N x (d + 1) (a .npy file, known by its first bytes), or without a header, as
/// `numpy.ndarray.tofile` does. A RowSource for fold_all: any number of threads may read at the same time. Not mapped
/// into memory: docs/scale.md has the times of both.
class RowFile {
public:
    /// size: d; a .npy file has it in its header. Throws InputError naming the file when it cannot be opened, is a
    /// directory or a pipe, holds no row, or does not hold a whole number of rows; of a .npy file when its numbers are
    /// of another type or not row by row, when it is not an array of N x (d + 1), and when its length is not that of
    /// its header and N rows. std::invalid_argument unless 1 <= size < 2^48.
    explicit RowFile(std::string const& path, std::optional<Index> size = std::nullopt);
    RowFile(RowFile const&) = delete;
    RowFile& operator=(RowFile const&) = delete;
    ~RowFile();

    std::string const& file() const { return file_; }  ///< its name in messages
    Index size() const { return size_; }               ///< d
    Index rows() const { return rows_; }               ///< N

    /// Writes rows first, first + 1, ... to the columns [psi; y] of the (d + 1) x B block, which must be contiguous.
    /// Throws InputError when the disk fails or the file has become shorter; std::invalid_argument beyond the last row.
    void read(Index first, Eigen::Ref<Matrix<double>> block) const;

private:
    std::string file_;
    Index size_ = 0, rows_ = 0, begin_ = 0;  // begin_: where the rows begin, in bytes
    int descriptor_;

    [[noreturn]] void refuse(std::string const& why) const;
    void find_rows(std::optional<Index> size);
    void find_array(Index bytes, std::optional<Index> size);
    void read_bytes(char* to, std::size_t left, Index at) const;
};

}  // namespace rlslab
