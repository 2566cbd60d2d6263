// From a .mat file's variables, of either version, to columns.
#pragma once

#include <rlslab/model/csv.hpp>

#include <map>

namespace rlslab {

/// Classes of variables as the file's format numbers them.
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

/// A variable: some columns of numbers, or why it has none.
struct MatVariable {
    std::string name, why = {};
    std::size_t rows = 0, cols = 0;
    std::map<std::size_t, std::vector<double>> values = {};  ///< those of its columns that were asked for

    MatVariable(std::string called, MatClass is, bool complex, std::vector<std::size_t> const& sizes);
    std::string column_name(std::size_t j) const;
};

/// Those of the columns that are called as asked.
std::vector<std::size_t> columns_asked(MatVariable const& variable, std::vector<std::string> const& asked);

/// The columns asked for, once the variables are known and have the values asked of them.
Columns columns_of(std::vector<MatVariable> const& variables, std::string const& file, std::vector<std::string> const& asked);

}  // namespace rlslab
