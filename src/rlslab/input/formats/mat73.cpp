// Version 7.3, by matio. The kind of a variable is read first; its numbers are read only for the columns that are
// needed.
#include <rlslab/input/formats/mat.hpp>
#include <rlslab/input/formats/mat_variables.hpp>

#include <filesystem>
#include <matio.h>

namespace rlslab {
namespace {

struct Close {
    void operator()(mat_t* file) const { Mat_Close(file); }
    void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, Close>;

template <class T>
double number(void const* data, std::size_t i) {
    return double(static_cast<T const*>(data)[i]);
}

/// How the numbers of a type are read; null where they are none.
double (*reading(matio_types type))(void const*, std::size_t) {
    switch (type) {
        case MAT_T_DOUBLE: return number<double>;
        case MAT_T_SINGLE: return number<float>;
        case MAT_T_INT8: return number<std::int8_t>;
        case MAT_T_UINT8: return number<std::uint8_t>;
        case MAT_T_INT16: return number<std::int16_t>;
        case MAT_T_UINT16: return number<std::uint16_t>;
        case MAT_T_INT32: return number<std::int32_t>;
        case MAT_T_UINT32: return number<std::uint32_t>;
        case MAT_T_INT64: return number<std::int64_t>;
        case MAT_T_UINT64: return number<std::uint64_t>;
        default: return nullptr;
    }
}

}  // namespace

Columns read_mat73(std::string const& path, std::vector<std::string> const& requested) {
    std::string const file = name_of_file(path);
    auto const fail = [&](std::string const& what) { throw InputError(file + ": " + what); };
    Mat_LogInitFunc("rlslab", [](int, char*) {});  // matio's own would print, and abort
    if (!std::filesystem::is_regular_file(path)) fail("a MATLAB file of version 7.3 is read from a regular file alone");
    std::unique_ptr<mat_t, Close> const mat(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
    if (!mat)
        fail("a MATLAB file of version 7.3 that matio cannot open: damaged, or matio has no HDF5 (save it with -v7)");
    std::string const ended =
        " that ends with a zero (h5py: attrs.create('MATLAB_class', numpy.bytes_('double'), dtype='S8') writes it)";
    std::vector<MatVariable> variables;
    while (Variable const v{Mat_VarReadNextInfo(mat.get())}) {
        std::vector<std::size_t> sizes;
        for (int i = 0; v->dims && i < v->rank; ++i) sizes.push_back(v->dims[i]);
        variables.emplace_back(v->name ? v->name : "", MatClass(v->class_type), v->isComplex != 0, sizes);
        if (v->class_type == MAT_C_EMPTY) variables.back().why = "no MATLAB_class" + ended;
        if (v->class_type != MAT_C_STRUCT) continue;
        std::vector<std::string> fields;
        char* const* const names = Mat_VarGetStructFieldnames(v.get());
        for (unsigned i = 0; names && i < Mat_VarGetNumberOfFields(v.get()); ++i) fields.emplace_back(names[i]);
        variables.back().has_fields(fields);
    }
    if (variables.empty()) fail("expected variables, found none with a MATLAB_class" + ended);
    for (MatVariable& variable : variables) {
        auto const requested_columns = columns_requested(variable, requested);
        if (requested_columns.empty()) continue;
        Variable const v{Mat_VarRead(mat.get(), variable.name.c_str())};
        auto const read = v ? reading(v->data_type) : nullptr;
        if (!read || !v->data || v->data_size < 1 ||
            v->nbytes / std::size_t(v->data_size) < variable.rows * variable.cols)
            fail(printable(variable.name) + ": its numbers cannot be read: the file is damaged");
        for (std::size_t const j : requested_columns)
            for (std::size_t i = 0; i < variable.rows; ++i)
                variable.values[j].push_back(read(v->data, j * variable.rows + i));
    }
    return columns_of(variables, file, requested);
}

}  // namespace rlslab
