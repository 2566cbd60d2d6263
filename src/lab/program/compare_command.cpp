// rlslab compare: every variant in every arithmetic on a record.
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/digits_answer.hpp"
#include "src/lab/compare/prior_law.hpp"
#include "src/lab/compare/words.hpp"
#include "src/lab/program/record_options.hpp"
#include "src/lab/program/run.hpp"

#include <rlslab/core/files.hpp>
#include <rlslab/input/suggestion.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>

namespace rlslab::program {
using namespace compare;
using namespace report;
namespace {

struct CompareArguments {
    RecordArguments record;
    CompositionArguments composition;
    std::string out;
    std::optional<std::string> code;
    bool json = false, csv = false, all = false;
    CompareOptions options;
};

/// The options that make sense together; throws InputError.
CompareOptions checked_options(CompareArguments const& a) {
    CompareOptions options = a.options;
    options.composition = composition_of(a.composition, options.forgetting);
    if (a.json && a.csv) refuse("--json: does not go with --csv");
    if (a.code) {
        expect_one_of(code_words(), *a.code, "--code", "word");
        if (a.json || a.csv) refuse("--code: does not go with --json or --csv");
        Composition const& c = options.composition;
        if (a.code == "board" && (!c.control.empty() || c.window > 0 || c.policy().rebuilds()))
            refuse("--code board: does not go with --control, --window or --guard rebuild; --guard reset is in it");
    }
    if (options.digits && !options.composition.empty())
        refuse("--digits: does not go with --control, --window or --guard");
    if (options.digits && options.p0) refuse("--digits: does not go with --p0: it chooses the prior");
    if (options.certify && (options.digits || !options.composition.empty()))
        refuse("--certify: does not go with --digits, --control, --window or --guard");
    if (options.digits && a.csv) refuse("--digits: does not go with --csv");
    if (a.all && !options.composition.empty())
        refuse("--all: does not go with --control, --window or --guard, which exist in float and double");
    if (a.all && !options.arithmetics.empty()) refuse("--all: does not go with --arithmetic");
    if (!a.all && options.arithmetics.empty()) options.arithmetics = {"float", "double"};
    return options;
}

/// 0 where some variant is recommended in some arithmetic, or keeps the digits that are wanted, else 1.
int run_compare(CompareArguments const& a) {
    CompareOptions const options = checked_options(a);
    Question question = question_of(with_example(a.record));
    if (a.code == "board" && question.records.parameters() > largest_on_a_board)
        refuse("--code board: expected at most {} parameters, found {}", largest_on_a_board,
               question.records.parameters());
    Comparison comparison = compare::compare(question.records, options, stages_after_a_second());
    for (std::string& doubt : doubts(question.records, options, question.model.regressors, question.in_file))
        question.model.warnings.push_back(std::move(doubt));
    comparison.model = question.model;
    if (options.p0 || a.json || !a.out.empty()) comparison.prior_costs = prior_costs(question.records, comparison);
    comparison.start_costs = start_costs(question.records, comparison);
    comparison.run = this_run(options.timings, question.model.file, question.sha256, question.rows);
    if (options.digits)
        comparison.digits = std::make_shared<DigitsAnswer>(
            digits_answer(question.records, options, question.model, progress_after_a_second("trying priors")));
    if (!a.out.empty()) {
        std::filesystem::path const out = a.out;
        create_folder(a.out);
        replace_file(out / "compare.json", as_json(comparison));
        replace_file(out / "compare.csv", as_csv(comparison));
        if (std::string const paste = code(comparison); !paste.empty()) replace_file(out / "filter.cpp", paste);
        replace_file(out / "compare.html", as_page(comparison));
    }
    if (a.code) {
        std::string const text = code(comparison, *a.code);
        for (std::string const& warning : warnings(comparison)) tell(fmt::format("rlslab: warning: {}\n", warning));
        if (text.empty()) tell("rlslab: no code: nothing is named in float or double; without --code it says why\n");
        print(text);
        return text.empty();
    }
    print(a.json  ? as_json(comparison)
          : a.csv ? as_csv(comparison)
                  : as_table(comparison, colour(), terminal_columns()) +
                        (a.out.empty() ? "" : fmt::format("\n{}/compare.html\n", printable(a.out, 200))));
    if (comparison.digits) return comparison.digits->chosen() ? 0 : 1;
    return std::ranges::all_of(comparison.recommendations, [](Recommendation const& r) { return r.variant.empty(); });
}

}  // namespace

Command compare_command(CLI::App& app) {
    auto const a = std::make_shared<CompareArguments>();
    CLI::App* const comparing =
        app.add_subcommand("compare", "Every variant on a record, in float and double or the arithmetics named.");
    comparing->footer(
        "A record of the program:  rlslab compare --example longley\n"
        "An ARX model of order 4:  rlslab compare data.csv --input u --output y --order 4\n"
        "A plain regression:       rlslab compare data.csv --regressors one,x1,x2 --output y --json\n"
        "Three digits in float:    rlslab compare data.csv --input u --output y --order 4 --arithmetic float --digits "
        "3\n"
        "The last 100 rows:        rlslab compare data.csv --input u --output y --order 4 --window 100\n"
        "Guarded, a random walk:   rlslab compare data.csv --input u --output y --order 4 --control random_walk:1e-4 "
        "--guard reset\n\n"
        "With --control, --window or --guard the digits are those of the composition. A window, or a guard that "
        "changed nothing, is compared with the certified least-squares solution of its rows. A control is compared "
        "with the same recursion in 257 bits, and so is a guard from the row on at which it changed something. "
        "MATLAB's ForgettingFactor is --forgetting, its KalmanFilter random_walk, its finite history --window.\n\n" +
        control_notes() +
        "\nWith --digits N the answer is the first arithmetic that keeps N digits of every parameter: at nine tenths "
        "of the checkpoints, and after the last row of the least-squares solution for the data as given, in every "
        "order of the rows. For that it weakens the prior, and scales columns whose numbers are near the ends of the "
        "arithmetic. The C++ has a guard where the form can have one, and the answer says what it met on this record. "
        "The digits say how well a filter computes, not how well the data determine theta.\n\n"
        "The table has the digits that half of the checkpoints along the record reach, over four draws of the "
        "roundings or more: of theta in norm, of its worst component, of P; against the exact answer for the data as "
        "stored, at most the arithmetic's own. predicted P: a forecast of that column from the rows alone, before any "
        "filter runs, for the named form; at least: the same for forms that store P, except conventional and kalman. "
        "ops: operations a row, with theta; qr_block and the sparse forms take blocks of rows. *: named; !: broke "
        "down, or did in another order of the rows. A breakdown is the first step at which the stored P was not "
        "positive definite (decided exactly) or not finite. The named form never broke down and keeps three digits "
        "(--digits: N) of the worst component at nine tenths of the checkpoints. Of such whose low is within half a "
        "digit of all others', its largest loss is the least: in the median, to the best of each column that never "
        "broke down. Of equals: a factor before P or its inverse, covariance before information, then the fewest "
        "operations. reordered: digits of theta of the named form, and of those shown that another order changes by "
        "half a digit, over three other orders of the rows. Fast forms hold neither P nor R: digits of their "
        "prediction error against the certified theta of the rows before it; their line starts with zeros.\n\n"
        "Exit code: 0 an arithmetic keeps three digits (--digits: N) of every parameter at nine tenths of the "
        "checkpoints; 1 none of those shown does; 2 no answer: wrong input, or it could not be written.");
    CLI::App& c = *comparing;
    CompareOptions& o = a->options;
    define_record(c, a->record);
    define(c, {forgetting_option(o.forgetting),
               prior_option(o.p0, "c^2 of the prior covariance P0 = c^2 I; default: a diagonal P0 scaled to the data"),
               {"--variants", o.variants, "A,B", "only these (rlslab list)"}});
    define_arithmetics(
        c, o.arithmetics,
        "only these (rlslab list; also half, single, fp32, fp64; and p11, N bits, or p8:-126:127[:stochastic|"
        ":toward_zero] with a range of exponents); in this order for --digits; default float,double");
    define(c, {{"--all", a->all, "every arithmetic"},
               {"--digits", o.digits, "D", real("a number from 0.5 to 30", 0.5, 30),
                "the variant and arithmetic that keep D digits of every parameter, 0.5 to 30, and their C++"}});
    define_composition(c, a->composition);
    define(c,
           {seed_option(o.seed, "of stochastic rounding and of the orders of rows; default 1"),
            {"--threads", o.threads, "N", whole(1, 4096), "default: all cores; the results are the same"},
            {"--json", a->json, "JSON instead of the table"},
            {"--code", a->code, "board|c|cpp|python",
             "print the filter alone: C++ for a microcontroller (fixed size, no heap), C on rlslab.h, C++, Python"},
            folder_option(a->out, "folder for compare.html, compare.json, compare.csv and filter.cpp"),
            {"--csv", a->csv, "CSV instead of the table"},
            {"--certify", o.certify, "also what 3 probes of each filter in float and double show of its error of P"}});
    comparing->add_flag_callback(
        "--no-timings", [a] { a->options.timings = false; },
        "leave out nanoseconds, the date and the instruction set: all that differs from run to run");
    return {comparing, [a] { return run_compare(*a); }};
}

int run_compare_alone(int argc, char const* const* argv) {
    CLI::App app{"rlslab compare in float and double alone", "rlslab_demo"};
    app.require_subcommand(1);
    Command const comparing = compare_command(app);
    try {
        set_command({argv + (argc > 0), argv + argc});
        app.parse(argc, argv);
        return comparing.run();
    } catch (CLI::ParseError const& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (std::exception const& error) {
        std::fprintf(stderr, "rlslab_demo: %s\n", error.what());
        return 2;
    }
}

}  // namespace rlslab::program
