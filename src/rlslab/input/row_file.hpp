// Rows of binary64 numbers in a file of any size. Any part can be read, with memory for that part only.
#pragma once

#include <rlslab/core/input_error.hpp>
#include <rlslab/core/problem.hpp>

#include <string>

namespace rlslab {

/// A file of rows [psi_1 ... psi_d y] of binary64 numbers in the machine's byte order, without header or separators, as
/// `numpy.ndarray.tofile` writes them. A RowSource for fold_all: any number of threads may read at the same time.
class RowFile {
public:
    /// Throws InputError naming the file when it cannot be opened, is a directory or a pipe, holds no row, or does not
    /// hold a whole number of rows; std::invalid_argument unless 1 <= size < 2^48.
    RowFile(std::string const& path, Index size);
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
    Index size_, rows_ = 0;
    int descriptor_;
};

}  // namespace rlslab
