// FILE or example, columns, model: options, and the rows they describe; --control, --window and --guard.
#include "src/lab/program/record_options.hpp"

#include <rlslab/input/constant.hpp>
#include <rlslab/input/counting.hpp>
#include <rlslab/input/times.hpp>
#include <rlslab/model/excitation.hpp>
#include <rlslab/model/lags.hpp>
#include <rlslab/model/regression.hpp>
#include <rlslab/input/suggestion.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace rlslab::program {
using namespace compare;
using namespace report;

void define_record(CLI::App& command, RecordArguments& a) {
    CLI::Option* const file = OptionRow("FILE", a.file, "", file_with_missing_values).required().define(command);
    define_format(command, a.format);
    define(command, {{"--input", a.inputs, "U[,V]", "column of the input u of an ARX model, or several"}});
    CLI::Option* const output =
        OptionRow("--output", a.output, "COLUMN", "column of the output y").required().define(command);
    command
        .add_option_function<std::string>(
            "--example",
            [&a, file, output](std::string const& name) {
                a.example = name;
                file->required(false), output->required(false);  // these are checked behind this
            },
            "in place of FILE a record of the program, with a model of its own (rlslab example)")
        ->check(named("the name of an example"))
        ->type_name("EXAMPLE");
    auto const one_for_all = [check = whole(0, 1000000)](std::string& text) {
        return text.find(',') == text.npos ? check(text)
                                           : "expected one number for all inputs; delays of each are lags: "
                                             "--regressors y[k-1],u[k-3],v[k-1]";
    };
    define(command,
           {{"--order", a.order, "N", whole(1, 1000), "ARX order: na = nb = N"},
            {"--na", a.na, "N", whole(0, 1000), "past outputs in the ARX model"},
            {"--nb", a.nb, "N", whole(0, 1000), "past inputs besides the first, u[k-delay] ... u[k-delay-nb]"},
            {"--delay", a.delay, "N", CLI::Validator(one_for_all, ""), "samples from input to output"},
            {"--regressors", a.regressors, "A,B",
             "columns of a plain regression, or with lags: y[k-1],u[k-3..k-5]; instead of --input and an order, "
             "whose past outputs have a minus: these have none"},
            {"--intercept", a.intercept, "a constant regressor besides"},
            {"--detrend", a.detrend, "take the mean off each column first"},
            time_option(a.time)});
}

std::string usual_arithmetic(std::string name) {
    static constexpr std::pair<std::string_view, char const*> others[] = {
        {"half", "binary16"},    {"single", "float"},  {"fp32", "float"},   {"f32", "float"},
        {"binary32", "float"},   {"fp64", "double"},   {"f64", "double"},   {"binary64", "double"},
        {"float16", "binary16"}, {"fp16", "binary16"}, {"f16", "binary16"}, {"bf16", "bfloat16"}};
    auto const known = std::ranges::find(others, name, &std::pair<std::string_view, char const*>::first);
    return known == std::end(others) ? std::move(name) : known->second;
}

void define_arithmetics(CLI::App& command, std::vector<std::string>& into, char const* help) {
    OptionRow("--arithmetic", into, "A,B", help)
        .define(command)
        ->transform(CLI::Validator([](std::string& name) { return name = usual_arithmetic(name), std::string(); }, ""));
}

namespace {

/// Takes the mean of what is there off each column.
std::vector<std::pair<std::string, double>> subtract_means(Columns& columns) {
    std::vector<std::pair<std::string, double>> out;
    for (size_t j = 0; j < columns.names.size(); ++j) {
        std::vector<double>& x = columns.values[j];
        double sum = 0, there = 0;
        for (double const v : x)
            if (!std::isnan(v)) sum += v, ++there;
        double const mean = constant_value(x).value_or(there > 0 ? sum / there : 0);
        for (double& v : x) v -= mean;
        out.emplace_back(printable(columns.names[j]), mean);
    }
    return out;
}

/// What the options describe: a regression on columns with lags, or where there are none an ARX model.
struct Model {
    std::vector<std::string> columns;  ///< to be read, each once
    std::vector<Lagged> lagged;
    Arx arx;

    void read(std::string const& column) {
        if (std::ranges::find(columns, column) == columns.end()) columns.push_back(column);
    }
};

Model regression_of(RecordArguments const& a) {
    if (!a.inputs.empty() || a.order || a.na >= 0 || a.nb >= 0 || a.delay)
        refuse("--regressors: does not go with --input, --order, --na, --nb or --delay");
    Model out{.columns = {}, .lagged = lagged_of("--regressors", a.regressors, a.output), .arx = {}};
    for (Lagged const& r : out.lagged) out.read(r.column);
    return out;
}

Model arx_of(RecordArguments const& a) {
    if (a.inputs.empty()) {
        int const na = std::max(a.order, a.na);
        std::string const to = na > 1 ? fmt::format("..k-{}", na) : "";
        refuse("--input: expected the name of the input column, or several (or --regressors {})",
               na > 0 ? fmt::format("'{}[k-1{}]'", printable(a.output), to) : "a,b,c");
    }
    if (a.order && (a.na >= 0 || a.nb >= 0)) refuse("--order: does not go with --na and --nb");
    if (!a.order && (a.na < 0 || a.nb < 0)) refuse("--order: expected an order (or --na and --nb)");
    Model out{.columns = {}, .lagged = {}, .arx = a.order ? arx_of_order(a.order) : Arx{.na = a.na, .nb = a.nb}};
    out.arx.delay = a.delay;
    out.arx.intercept = a.intercept;
    out.arx.inputs = int(a.inputs.size());
    for (std::string const& input : a.inputs) {
        if (std::ranges::count(a.inputs, input) > 1) refuse("--input: column \"{}\" is named twice", printable(input));
        if (input == a.output) refuse("--input: column \"{}\" is both input and output", printable(input));
        out.read(input);
    }
    return out;
}

Model model_of(RecordArguments const& a) {
    if (a.file.empty() && a.example.empty()) refuse("FILE: expected the name of a file");
    if (a.output.empty()) refuse("--output: expected the name of the output column");
    Model out = a.regressors.empty() ? arx_of(a) : regression_of(a);
    out.read(a.output);
    return out;
}

Records records_of(Columns const& data, RecordArguments const& a, Model const& model, std::vector<Index>& rows) {
    if (!model.lagged.empty()) return lagged_records(data, model.lagged, a.output, a.intercept, &rows);
    std::vector<std::span<double const>> inputs;
    for (std::string const& input : a.inputs) inputs.emplace_back(data[input]);
    return arx_records(inputs, a.inputs, data[a.output], model.arx, data.file, &rows);
}

Columns columns_of(RecordArguments const& a, DataFile const& file, std::vector<std::string> const& names) {
    if (a.example.empty()) return read_data(file, names, a.time);
    return read_text(example_named(a.example, "--example").text, a.example + ".csv", names, a.time);
}

/// What a parameter multiplies: a column with a lag, or 1.
struct Multiplied {
    std::string column;  ///< "": 1
    int lag = 0;
    bool negative = false;
};
/// In the order of the records' columns.
std::vector<Multiplied> multiplied(RecordArguments const& a, Model const& model) {
    std::vector<Multiplied> out;
    if (!model.lagged.empty()) {
        if (a.intercept) out.push_back({});
        for (Lagged const& r : model.lagged) out.push_back({r.column, r.lag});
        return out;
    }
    for (int i = 1; i <= model.arx.na; ++i) out.push_back({a.output, i, true});
    for (std::string const& input : a.inputs)
        for (int i = 0; i <= model.arx.nb; ++i) out.push_back({input, model.arx.delay + i});
    if (a.intercept) out.push_back({});
    return out;
}

/// "-sales[k-1]", "lead[k]", "1".
std::string text_of(Multiplied const& m, bool header) {
    if (m.column.empty()) return "1";
    return (m.negative ? "-" : "") + rlslab::text_of({header ? m.column : "column " + m.column, m.lag});
}

Index longest_lag(Model const& model) {
    Index out = model.lagged.empty() ? model.arx.presample() : 0;
    for (Lagged const& r : model.lagged) out = std::max<Index>(out, r.lag);
    return out;
}

/// Of the numbers as they stand in the file; computed ones may carry some dozens of roundings.
double resolution_in(std::vector<double> known) {
    std::erase_if(known, [](double v) { return std::isnan(v); });
    return known.empty() ? 0 : resolution_of(known, 0x1p-46);
}

}  // namespace

std::vector<std::string> names_before_lags(std::vector<std::string> words, std::vector<std::string> const& columns) {
    for (std::string& word : words)
        if (word.ends_with(']') && std::ranges::find(columns, word) != columns.end()) word += "[k]";
    return words;
}
std::vector<std::string> names_before_lags(std::vector<std::string> words, DataFile& file) {
    bool const brackets = std::ranges::any_of(words, [](std::string const& word) { return word.ends_with(']'); });
    std::vector<std::string> const columns = brackets ? columns_among(words, file) : std::vector<std::string>();
    return names_before_lags(std::move(words), columns);
}

Question question_of(RecordArguments a, std::optional<Columns>* kept) {
    DataFile file{a.file, a.format};
    bool const known = kept && *kept;
    if (known) a.regressors = names_before_lags(a.regressors, (*kept)->names);
    else if (!a.file.empty()) a.regressors = names_before_lags(a.regressors, file);
    Model const model = model_of(a);
    expect_times_apart(a.time, a.output, a.inputs);
    Columns data = known ? **kept : columns_of(a, file, model.columns);
    if (kept && !*kept) *kept = data;
    Question out;
    out.model.file = printable(data.file, 200);
    out.sha256 = data.sha256, out.rows = data.rows();
    std::vector<std::string> regressors = model.columns;
    std::erase(regressors, a.output);
    out.model.warnings = counting_warnings(data, regressors);
    Index const longest = longest_lag(model);
    if (auto const sentence = a.time.empty() && longest > 0 ? sentence_on_times(data) : std::nullopt)
        out.model.warnings.push_back(*sentence);
    if (!a.time.empty()) data = in_order_of_time(std::move(data), std::max<Index>(1000, longest));
    std::map<std::string, double> resolution{{"", 0}};
    for (size_t j = 0; j < data.names.size(); ++j) resolution[data.names[j]] = resolution_in(data.values[j]);
    if (a.detrend) out.model.means = subtract_means(data);
    out.model.output = text_of({a.output}, data.header);
    for (Multiplied const& m : multiplied(a, model)) {
        out.model.regressors.push_back(text_of(m, data.header));
        out.in_file.resolution.push_back(resolution[m.column]);
    }
    out.records = records_of(data, a, model, out.in_file.rows);
    out.records.file = a.example.empty() ? out.model.file : "--example " + a.example;
    out.in_file.order = out.records.presample - model.arx.delay;
    out.in_file.lines = std::move(data.lines);
    return out;
}

// --- six records of several kinds; studies/data/README.md has their sources and licences -----------------------------

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
    if (!a.file.empty()) refuse("--example: does not go with FILE");
    if (a.output.empty()) a.output = model.output;
    if (!a.inputs.empty() || !a.regressors.empty()) return a;
    bool const ordered = a.order > 0 || a.na >= 0 || a.nb >= 0;
    a.inputs = model.inputs;
    if (!ordered) a.order = model.order, a.regressors = model.regressors;
    a.intercept = a.intercept || model.intercept, a.detrend = a.detrend || model.detrend;
    return a;
}

// --- --control NAME:NUMBER:NUMBER, --window ROWS, --guard POLICY -----------------------------------------------------

namespace {

/// "fortescue[:VARIANCE[:MEMORY[:LEAST]]]"; what must be given stands without brackets.
std::string usage(Control const& control) {
    std::string out(control.name), end;
    for (ControlParameter const& p : control.parameters) {
        bool const required = p.range.otherwise == RuleDefault::none;
        out += fmt::format("{}:{}", required ? "" : "[", p.name);
        if (!required) end += ']';
    }
    return out + end;
}

size_t numbers_needed(Control const& control) {
    size_t n = 0;
    for (size_t i = 0; i < control.parameters.size(); ++i)
        if (control.parameters[i].range.otherwise == RuleDefault::none) n = i + 1;
    return n;
}

double number_of(Control const& control, ControlParameter const& p, std::string const& text) {
    double x = 0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
    auto const& [least, most, positive, otherwise, inverted] = p.range;
    bool const fits = least <= x && x <= most && !(positive && x == least) && (!p.whole || x == std::floor(x));
    if (error != std::errc() || end != text.data() + text.size() || !fits)
        refuse("--control {}: {}: expected a {} {} {}{}{}, found \"{}\"", control.name, p.name,
               p.whole ? "whole number" : "number", positive ? "above" : "from", least,
               most < 1e300 ? fmt::format(" to {}", most) : "",
               error == std::errc::result_out_of_range ? " that double can hold" : "", printable(text));
    return x;
}

}  // namespace

void define_composition(CLI::App& command, CompositionArguments& a) {
    std::vector<std::string> names;
    for (Control const& control : controls()) names.push_back(usage(control));
    std::vector<std::string> policies;
    for (NamedPolicy const& policy : guard_policies) policies.push_back(fmt::format("{} {}", policy.name, policy.what));
    define(command, {{"--control", a.control, "NAME", named("the name of a control"),
                      fmt::format("a rule of forgetting around the variant: {}", fmt::join(names, ", "))},
                     {"--window", a.window, "N", whole(1, 1000000000),
                      "an estimate from the last N rows: older ones are removed"},
                     {"--guard", a.guard, "POLICY", named("the name of a guard"),
                      fmt::format("a guard around the variant, which skips rows that are not finite: {}",
                                  fmt::join(policies, "; "))}});
}

std::string control_notes() {
    std::string out = "Controls, which are rules of forgetting:\n";
    for (Control const& control : controls()) {
        std::vector<std::string> starts;
        for (ControlParameter const& parameter : control.parameters)
            if (!std::isnan(parameter.start)) starts.push_back(fmt::format("{} {}", parameter.name, parameter.start));
        out += fmt::format("  {}:  {}{}\n", usage(control), control.what,
                           starts.empty() ? "" : fmt::format("; default {}", fmt::join(starts, ", ")));
    }
    return out;
}

Composition composition_of(CompositionArguments const& a, double forgetting) {
    Composition out{.window = a.window, .guard = a.guard};
    if (!a.guard.empty()) expect_one_of(guard_names(), a.guard, "--guard", "policy");
    if (!a.control.empty()) {
        size_t colon = std::min(a.control.find(':'), a.control.size());
        out.control = a.control.substr(0, colon);
        std::vector<std::string_view> known;
        for (Control const& control : controls()) known.push_back(control.name);
        expect_one_of(known, out.control, "--control", "control");
        Control const& control = control_named(out.control);
        std::vector<std::string> texts;
        while (colon < a.control.size()) {
            size_t const next = std::min(a.control.find(':', colon + 1), a.control.size());
            texts.push_back(a.control.substr(colon + 1, next - colon - 1));
            colon = next;
        }
        if (texts.size() > control.parameters.size() || texts.size() < numbers_needed(control))
            refuse("--control: expected {}, found \"{}\"", usage(control), printable(a.control));
        for (size_t i = 0; i < control.parameters.size(); ++i)
            out.parameters.push_back(i < texts.size() ? number_of(control, control.parameters[i], texts[i])
                                                      : control.parameters[i].start);
        if (control.below_one && forgetting == 1)
            refuse("--control {}: expected --forgetting below 1: without it nothing wears the prior down",
                   control.name);
    }
    if (std::string const why = contradiction(out); !why.empty())
        refuse("{}{}{}do not go together: {}", a.control.empty() ? "" : "--control ", a.window > 0 ? "--window " : "",
               a.guard.empty() ? "" : "--guard ", why);
    return out;
}

}  // namespace rlslab::program
