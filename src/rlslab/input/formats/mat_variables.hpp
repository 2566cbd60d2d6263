// From the variables of a .mat file, of either version, to columns.
#pragma once

#include <rlslab/input/csv.hpp>

#include <map>

namespace rlslab {

/// Classes of variables, with the numbers that the file format gives them.
enum class MatClass {
    cell = 1,
    structure,
    object,
    text,
    sparse,
    binary64,
    binary32,
    int8,
    uint8,
    int16,
    uint16,
    int32,
    uint32,
    int64,
    uint64,
    function,
    opaque
};

/// A variable: some columns of numbers, or the reason (`why`) for having none.
struct MatVariable {
    std::string name, why = {};
    std::size_t rows = 0, cols = 0;
    std::map<std::size_t, std::vector<double>> values = {};  ///< those of its columns that are needed

    MatVariable(std::string called, MatClass is, bool complex, std::vector<std::size_t> const& sizes);
    /// Of a structure: its fields, for messages.
    void has_fields(std::vector<std::string> const& fields);
    std::string column_name(std::size_t j) const;  ///< "x_2", or "x" if it is the only one
    /// Whether `requested` is that name, or "x(:,2)".
    bool is_column(std::size_t j, std::string const& requested) const;
};

/// The numbers of those columns of the variable that are requested.
std::vector<std::size_t> columns_requested(MatVariable const& variable, std::vector<std::string> const& requested);

/// The columns named in `requested`, from variables that hold their values. Throws InputError as read_mat5.
Columns columns_of(std::vector<MatVariable> const& variables, std::string const& file,
                   std::vector<std::string> const& requested);

}  // namespace rlslab
