// Six records of several kinds; studies/data/README.md has their sources and licences.
#include "src/lab/program/examples.hpp"

#include <rlslab/input/suggestion.hpp>

#include <algorithm>
#include <array>

namespace rlslab::program {

/// The texts of the files in data, by the names of the examples; src/lab/program/CMakeLists.txt writes it.
std::string_view example_text(std::string_view name);

std::span<Example const> examples() {
    static std::array const all{
        Example{"sales",
                "sales and a leading indicator: input and output",
                "Box and Jenkins 1976, series M",
                {.output = "sales", .inputs = {"lead"}, .order = 2, .detrend = true},
                example_text("sales")},
        Example{"longley",
                "employment on six economic figures: nearly collinear",
                "NIST StRD; Longley 1967",
                {.output = "y", .regressors = {"one", "x1", "x2", "x3", "x4", "x5", "x6"}},
                example_text("longley")},
        Example{"filip",
                "a polynomial of degree ten: condition 2e15",
                "NIST StRD; A. Filippelli",
                {.output = "y", .regressors = {"x0", "x1", "x2", "x3", "x4", "x5", "x6", "x7", "x8", "x9", "x10"}},
                example_text("filip")},
        Example{"sunspots",
                "yearly numbers, 1700 to 2008: a series without an input",
                "NOAA, by statsmodels",
                {.output = "number", .regressors = {"number[k-1..k-9]"}, .intercept = true},
                example_text("sunspots")},
        Example{"airquality",
                "ozone on sun, wind and temperature: missing values",
                "Chambers and others, by R",
                {.output = "Ozone", .regressors = {"Solar.R", "Wind", "Temp"}, .intercept = true},
                example_text("airquality")},
        Example{"consumption",
                "consumption and income by quarters: both grow, and lags are nearly collinear",
                "Federal Reserve, by statsmodels",
                {.output = "consumption", .regressors = {"consumption[k-1..k-2]", "income[k..k-2]"}, .intercept = true},
                example_text("consumption")}};
    return all;
}

Example const& example_named(std::string const& name, std::string const& where) {
    std::vector<std::string_view> names;
    for (Example const& example : examples()) names.push_back(example.name);
    expect_one_of(names, name, where, "example");
    return *std::ranges::find(examples(), name, &Example::name);
}

RecordArguments with_example(RecordArguments a) {
    if (a.example.empty()) return a;
    RecordArguments const& model = example_named(a.example, "--example").model;
    if (!a.file.empty()) throw InputError("--example: does not go with FILE");
    if (a.output.empty()) a.output = model.output;
    if (!a.inputs.empty() || !a.regressors.empty()) return a;
    bool const ordered = a.order > 0 || a.na >= 0 || a.nb >= 0;
    a.inputs = model.inputs;
    if (!ordered) a.order = model.order, a.regressors = model.regressors;
    a.intercept = a.intercept || model.intercept, a.detrend = a.detrend || model.detrend;
    return a;
}

}  // namespace rlslab::program
