// From variables to columns, and the messages for variables that are no columns.
#include <rlslab/input/formats/mat_variables.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace rlslab {
namespace {

constexpr std::size_t most_columns = 1000;

std::string_view text_of(MatClass is, bool complex) {
    switch (is) {
        case MatClass::cell: return "a cell array";
        case MatClass::structure: return "a structure";
        case MatClass::object:
        case MatClass::opaque: return "an object";
        case MatClass::function: return "a function";
        case MatClass::text: return "text";
        case MatClass::sparse: return "a sparse matrix";
        default:
            return is < MatClass::binary64 || is > MatClass::opaque ? "something unknown"
                   : complex                                        ? "complex numbers"
                                                                    : "";
    }
}

}  // namespace

MatVariable::MatVariable(std::string called, MatClass is, bool complex, std::vector<std::size_t> const& sizes)
    : name(std::move(called)), why(text_of(is, complex)) {
    if (!why.empty()) return;
    if (sizes.size() != 2) {
        why = fmt::format("an array of {} dimensions", sizes.size());
        return;
    }
    rows = sizes[0] == 1 ? sizes[1] : sizes[0];
    cols = sizes[0] == 1 ? 1 : sizes[1];
    if (rows == 0 || cols == 0) why = "nothing";
    else if (cols > most_columns) why = fmt::format("a matrix of {} columns", cols);
    else if (rows > std::size_t(most_numbers) / (cols + 1)) why = fmt::format("{} x {} numbers", rows, cols);
    if (!why.empty()) rows = cols = 0;
}

void MatVariable::has_fields(std::vector<std::string> const& fields) {
    constexpr std::size_t shown = 8;
    std::string list;
    for (std::size_t i = 0; i < std::min(shown, fields.size()); ++i) list += (i ? ", " : "") + printable(fields[i], 40);
    if (!list.empty())
        why = fmt::format("a structure with the fields {}{}: save('file.mat', '-struct', '{}') makes variables of them",
                          list, fields.size() > shown ? " ..." : "", printable(name));
}

std::string MatVariable::column_name(std::size_t j) const {
    return cols == 1 ? name : fmt::format("{}_{}", name, j + 1);
}

bool MatVariable::is_column(std::size_t j, std::string const& requested) const {
    if (requested == column_name(j)) return true;
    std::string plain = requested;
    std::erase(plain, ' ');
    return plain == fmt::format("{}(:,{})", name, j + 1);
}

std::vector<std::size_t> columns_requested(MatVariable const& variable, std::vector<std::string> const& requested) {
    std::vector<std::size_t> out;
    for (std::size_t j = 0; j < variable.cols; ++j)
        if (std::ranges::any_of(requested, [&](auto const& name) { return variable.is_column(j, name); }))
            out.push_back(j);
    return out;
}

Columns columns_of(std::vector<MatVariable> const& variables, std::string const& file,
                   std::vector<std::string> const& requested) {
    expects(!requested.empty(), "the name of a column at least");
    auto const fail = [&](std::string const& what) { throw InputError(file + ": " + what); };
    if (variables.empty()) fail("expected variables, found none");
    std::vector<std::string> names;
    std::vector<std::vector<double> const*> values;
    for (MatVariable const& v : variables)
        for (std::size_t j = 0; j < v.cols; ++j) {
            names.push_back(v.column_name(j));
            auto const found = v.values.find(j);
            values.push_back(found == v.values.end() ? nullptr : &found->second);
        }
    std::string others;  // variables that are no columns
    for (MatVariable const& v : variables)
        if (!v.why.empty()) others += fmt::format("{}{} is {}", others.empty() ? "" : "; ", printable(v.name), v.why);
    Columns data{.file = file, .names = requested};
    for (std::string const& name : requested) {
        auto const v = std::ranges::find(variables, name, &MatVariable::name);
        std::string const shown = printable(name);
        if (v != variables.end() && !v->why.empty())
            fail(fmt::format("{}: expected a real numeric vector or matrix, found {}", shown, v->why));
        if (v != variables.end() && v->cols > 1)
            fail(fmt::format("{} is a matrix: its columns are called {}_1 ... {}_{}", shown, shown, shown, v->cols));
        std::string called = name;
        for (MatVariable const& of : variables)
            for (std::size_t const j : columns_requested(of, {name})) called = of.column_name(j);
        if (!others.empty() && std::ranges::find(names, called) == names.end())
            fail(fmt::format("no column \"{}\"; {}{}{}", shown, fmt::join(names, ", "),
                             names.empty()       ? ""
                             : names.size() == 1 ? " is one; "
                                                 : " are columns; ",
                             others));
        std::vector<double> const& column = *values[column_called(called, names, true, file, file)];
        for (std::size_t i = 0; i < column.size(); ++i)
            if (std::abs(column[i]) > largest_value)
                fail(fmt::format("{}, row {}: expected 0 or a size up to 2^500 (squares must stay finite), found {}",
                                 shown, i + 1, column[i]));
        data.values.push_back(column);
        std::size_t const rows = data.values.front().size();
        if (column.size() != rows)
            fail(fmt::format("expected columns of equal length, found {} numbers in {} and {} in {}", rows,
                             printable(requested.front()), column.size(), shown));
    }
    data.lines.resize(data.values.front().size());
    std::iota(data.lines.begin(), data.lines.end(), 1L);
    return data;
}

}  // namespace rlslab
