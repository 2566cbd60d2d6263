// rlslab compare: every variant in every arithmetic on a record.
#include "commands.hpp"
#include "compare.hpp"

#include <rlslab/model/regression.hpp>

#include <fmt/format.h>

namespace rlslab {
namespace {

struct CompareArguments {
    std::string file, input, output;
    std::vector<std::string> regressors;
    int order = 0, na = -1, nb = -1, delay = 0;
    bool intercept = false, json = false, csv = false;
    CompareOptions options;
};

/// The records the options describe; reads the file once the options make sense.
Records records_of(CompareArguments const& a) {
    if (a.file.empty()) throw InputError("FILE: expected the name of a file");
    if (a.output.empty()) throw InputError("--output: expected the name of the output column");
    if (!a.regressors.empty()) {
        if (!a.input.empty() || a.order || a.na >= 0 || a.nb >= 0 || a.delay)
            throw InputError("--regressors: does not go with --input, --order, --na, --nb or --delay");
        std::vector<std::string> columns = a.regressors;
        columns.push_back(a.output);
        return linear_records(read_columns(a.file, columns), a.regressors, a.output, a.intercept);
    }
    if (a.input.empty()) throw InputError("--input: expected the name of the input column (or --regressors a,b,c)");
    if (a.order && (a.na >= 0 || a.nb >= 0)) throw InputError("--order: does not go with --na and --nb");
    if (!a.order && (a.na < 0 || a.nb < 0)) throw InputError("--order: expected an order (or --na and --nb)");
    Arx model = a.order ? arx_of_order(a.order) : Arx{.na = a.na, .nb = a.nb};
    model.delay = a.delay;
    model.intercept = a.intercept;
    return arx_records(read_columns(a.file, {a.input, a.output}), a.input, a.output, model);
}

void run_compare(CompareArguments const& a) {
    if (a.json && a.csv) throw InputError("--json: does not go with --csv");
    Comparison const comparison = compare(records_of(a), a.options, progress_after_a_second("comparing"));
    print(a.json ? as_json(comparison) : a.csv ? as_csv(comparison) : as_table(comparison, colour()));
}

}  // namespace

Command compare_command(CLI::App& app) {
    auto const a = std::make_shared<CompareArguments>();
    CLI::App* const comparing = app.add_subcommand("compare", "Every variant in every arithmetic on a record.");
    comparing->footer("An ARX model of order 4:  rlslab compare data.csv --input u --output y --order 4\n"
                      "A plain regression:       rlslab compare data.csv --regressors one,x1,x2 --output y --json");
    comparing->add_option("FILE", a->file, "CSV file (-: standard input); empty, NA, N/A, NaN, null, . and ? are missing values")->required()->type_name("");
    comparing->add_option("--input", a->input, "column of the input u of an ARX model")->type_name("COLUMN");
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
    names("--regressors", a->regressors, "columns of a plain regression, instead of --input and an order");
    comparing->add_flag("--intercept", a->intercept, "a constant regressor besides");
    comparing->add_option("--forgetting", a->options.forgetting, "forgetting factor, in (0, 1]; default 1")
        ->check(real("a number in (0, 1]", [](double x) { return 0 < x && x <= 1; }))->type_name("LAMBDA");
    comparing->add_option("--p0", a->options.p0, "c^2 of the prior covariance P0 = c^2 I; default 2^14 = 16384")
        ->check(real("a positive, finite number", [](double x) { return 0 < x; }))->type_name("C2");
    names("--variants", a->options.variants, "only these (rlslab list)");
    names("--arithmetic", a->options.arithmetics, "only these (rlslab list)");
    comparing->add_option("--seed", a->options.seed, "of stochastic rounding; default 1")
        ->check(whole(0, std::numeric_limits<long>::max()))->type_name("N");
    count("--threads", a->options.threads, 1, 4096, "default: all cores; the results are the same");
    comparing->add_flag("--json", a->json, "JSON instead of the table");
    comparing->add_flag("--csv", a->csv, "CSV instead of the table");
    comparing->add_flag_callback("--no-timings", [a] { a->options.timings = false; },
                                 "leave out nanoseconds, the only column that differs from run to run");
    return {comparing, [a] {
                run_compare(*a);
                return 0;
            }};
}

}  // namespace rlslab
