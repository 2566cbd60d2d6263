// rlslab compare: every variant in every arithmetic on a record.
#include "compare/answer.hpp"
#include "compare/compare.hpp"
#include "program/commands.hpp"

#include <rlslab/core/files.hpp>
#include <rlslab/model/doors/open.hpp>
#include <rlslab/model/lags.hpp>
#include <rlslab/model/regression.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace rlslab {
namespace {

struct CompareArguments {
    CsvFormat format;
    std::string file, output, out;
    std::vector<std::string> inputs, regressors;
    int order = 0, na = -1, nb = -1, delay = 0;
    bool intercept = false, detrend = false, json = false, csv = false, all = false;
    CompareOptions options;
};

/// Records, and what their parameters multiply.
struct Question {
    Records records;
    ModelText model;
};

/// Takes the mean of what is there off each column.
std::vector<std::pair<std::string, double>> take_means(Columns& columns) {
    std::vector<std::pair<std::string, double>> out;
    for (size_t j = 0; j < columns.names.size(); ++j) {
        std::vector<double>& x = columns.values[j];
        double sum = 0, there = 0;
        for (double const v : x)
            if (!std::isnan(v)) sum += v, ++there;
        double const mean = there > 0 ? sum / there : 0;
        for (double& v : x) v -= mean;
        out.emplace_back(printable(columns.names[j]), mean);
    }
    return out;
}

/// The records the options describe; reads the file once the options make sense.
Question question_of(CompareArguments const& a) {
    if (a.file.empty()) throw InputError("FILE: expected the name of a file");
    if (a.output.empty()) throw InputError("--output: expected the name of the output column");
    std::vector<std::string> columns;
    std::vector<Lagged> lagged;
    auto const add = [&](std::string const& name) {
        if (std::ranges::find(columns, name) == columns.end()) columns.push_back(name);
    };
    if (!a.regressors.empty()) {
        if (!a.inputs.empty() || a.order || a.na >= 0 || a.nb >= 0 || a.delay)
            throw InputError("--regressors: does not go with --input, --order, --na, --nb or --delay");
        lagged = lagged_of("--regressors", a.regressors, a.output);
        for (Lagged const& r : lagged) add(r.column);
    } else {
        if (a.inputs.empty()) throw InputError("--input: expected the name of the input column, or several (or --regressors a,b,c)");
        if (a.order && (a.na >= 0 || a.nb >= 0)) throw InputError("--order: does not go with --na and --nb");
        if (!a.order && (a.na < 0 || a.nb < 0)) throw InputError("--order: expected an order (or --na and --nb)");
        for (std::string const& input : a.inputs) {
            if (std::ranges::count(a.inputs, input) > 1)
                throw InputError(fmt::format("--input: column \"{}\" is named twice", printable(input)));
            if (input == a.output) throw InputError(fmt::format("--input: column \"{}\" is both input and output", printable(input)));
            add(input);
        }
    }
    add(a.output);
    Columns data = read_data({a.file, a.format}, columns);
    Question out;
    out.model.file = printable(data.file, 200);
    if (a.detrend) out.model.means = take_means(data);
    auto const named = [&](std::string const& column) { return data.header ? column : "column " + column; };
    out.model.output = text_of({named(a.output), 0});
    if (!lagged.empty()) {
        out.records = lagged_records(data, lagged, a.output, a.intercept);
        if (a.intercept) out.model.regressors.push_back("1");
        for (Lagged const& r : lagged)
            out.model.regressors.push_back((r.column == a.output ? "-" : "") + text_of({named(r.column), r.lag}));
        return out;
    }
    Arx model = a.order ? arx_of_order(a.order) : Arx{.na = a.na, .nb = a.nb};
    model.delay = a.delay;
    model.intercept = a.intercept;
    model.inputs = int(a.inputs.size());
    std::vector<std::span<double const>> inputs;
    for (std::string const& input : a.inputs) inputs.emplace_back(data[input]);
    out.records = arx_records(inputs, a.inputs, data[a.output], model, data.file);
    for (int i = 1; i <= model.na; ++i) out.model.regressors.push_back("-" + text_of({named(a.output), i}));
    for (std::string const& input : a.inputs)
        for (int i = 0; i <= model.nb; ++i) out.model.regressors.push_back(text_of({named(input), model.delay + i}));
    if (model.intercept) out.model.regressors.push_back("1");
    return out;
}

/// 0 where some variant is recommended, else 1.
int run_compare(CompareArguments const& a) {
    if (a.json && a.csv) throw InputError("--json: does not go with --csv");
    CompareOptions options = a.options;
    if (a.all && !options.arithmetics.empty()) throw InputError("--all: does not go with --arithmetic");
    if (!a.all && options.arithmetics.empty()) options.arithmetics = {"float", "double"};
    Question const question = question_of(a);
    Comparison comparison = compare(question.records, options, progress_after_a_second("comparing"));
    comparison.model = question.model;
    if (!a.out.empty()) {
        std::filesystem::path const out = a.out;
        create_folder(a.out);
        replace_file(out / "compare.json", as_json(comparison));
        replace_file(out / "compare.csv", as_csv(comparison));
        if (std::string const paste = code(comparison); !paste.empty()) replace_file(out / "filter.cpp", paste);
        replace_file(out / "compare.html", as_page(comparison));
    }
    print(a.json  ? as_json(comparison)
          : a.csv ? as_csv(comparison)
                  : as_table(comparison, colour()) + (a.out.empty() ? "" : fmt::format("\n{}/compare.html\n", a.out)));
    return std::ranges::all_of(comparison.recommendations, [](Recommendation const& r) { return r.variant.empty(); });
}

}  // namespace

Command compare_command(CLI::App& app) {
    auto const a = std::make_shared<CompareArguments>();
    CLI::App* const comparing = app.add_subcommand("compare", "Every variant in every arithmetic on a record.");
    comparing->footer(
        "An ARX model of order 4:  rlslab compare data.csv --input u --output y --order 4\n"
        "A plain regression:       rlslab compare data.csv --regressors one,x1,x2 --output y --json");
    comparing
        ->add_option("FILE", a->file,
                     "CSV file (-: standard input), plain or by gzip, or MATLAB's; empty, NA, N/A, NaN, null, . and ? are missing values")
        ->required()
        ->type_name("");
    take_format(*comparing, a->format);
    comparing->add_option("--input", a->inputs, "column of the input u of an ARX model, or several")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("U[,V]");
    comparing->add_option("--output", a->output, "column of the output y")->required()->type_name("COLUMN");
    auto const count = [&](char const* name, int& into, long least, long most, char const* help) {
        CLI::Option* const option = comparing->add_option(name, into, help)->check(whole(least, most));
        option->type_name("N");
    };
    count("--order", a->order, 1, 1000, "ARX order: na = nb = N");
    count("--na", a->na, 0, 1000, "past outputs in the ARX model");
    count("--nb", a->nb, 0, 1000, "past inputs besides the first, u[k-delay] ... u[k-delay-nb]");
    count("--delay", a->delay, 0, 1000000, "samples from input to output");
    auto const names = [&](char const* name, std::vector<std::string>& into, char const* help) {
        // One word each: a list must not swallow FILE behind it.
        comparing->add_option(name, into, help)->delimiter(',')->allow_extra_args(false)->type_name("A,B");
    };
    names("--regressors", a->regressors,
          "columns of a plain regression, or with lags: y[k-1],u[k-3..k-5]; instead of --input and an order");
    comparing->add_flag("--intercept", a->intercept, "a constant regressor besides");
    comparing->add_flag("--detrend", a->detrend, "take the mean off each column first");
    take_forgetting(*comparing, a->options.forgetting);
    comparing->add_option("--p0", a->options.p0, "c^2 of the prior covariance P0 = c^2 I; default: a diagonal P0 scaled to the data")
        ->check(real("a positive, finite number", [](double x) { return 0 < x; }))
        ->type_name("C2");
    names("--variants", a->options.variants, "only these (rlslab list)");
    names("--arithmetic", a->options.arithmetics, "only these (rlslab list); default float,double");
    comparing->add_flag("--all", a->all, "every arithmetic");
    comparing->add_option("--seed", a->options.seed, "of stochastic rounding and of the orders of rows; default 1")
        ->check(whole(0, std::numeric_limits<long>::max()))
        ->type_name("N");
    count("--threads", a->options.threads, 1, 4096, "default: all cores; the results are the same");
    comparing->add_flag("--json", a->json, "JSON instead of the table");
    comparing->add_option("--out", a->out, "folder for compare.html, compare.json, compare.csv and filter.cpp")
        ->check(named("the name of a folder"))
        ->type_name("DIR");
    comparing->add_flag("--csv", a->csv, "CSV instead of the table");
    comparing->add_flag_callback(
        "--no-timings", [a] { a->options.timings = false; }, "leave out nanoseconds, the only column that differs from run to run");
    return {comparing, [a] {
                a->inputs = unquoted(a->inputs), a->regressors = unquoted(a->regressors);
                return run_compare(*a);
            }};
}

}  // namespace rlslab
