// rlslab sweep: a study made at run time, over values of forgetting, prior, arithmetic and model order; its command.
#include "src/lab/compare/score.hpp"
#include "src/lab/program/record_options.hpp"
#include "src/lab/program/study_options.hpp"
#include <rlslab/studies/factors.hpp>

#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/input/suggestion.hpp>
#include <rlslab/input/text.hpp>
#include <rlslab/model/default_prior.hpp>
#include <rlslab/core/files.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

namespace rlslab::program {
using namespace compare;
using namespace report;
using namespace studies;
namespace {

struct Sweep {
    std::vector<FactorValues> vary;
    int order = 0;                              ///< of the model that is given; 0: it has none
    int row_orders = 1;                         ///< the record's, and so many more, less one
    std::function<Records(int order)> records;  ///< of the model of this order; 0: of the one that is given
};

/// What the trials share; they only read it.
struct Given {
    std::map<double, Records> records;                              ///< by model order
    std::map<std::pair<double, double>, Prior<double>> by_default;  ///< by model order and forgetting
    std::vector<std::string> variants;
    std::uint64_t seed;
};

double number_in(std::string const& factor, std::string const& text, char const* expected, bool (*holds)(double)) {
    double value = 0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size() && std::isfinite(value) && holds(value)) return value;
    refuse("--vary {}: expected {}, found \"{}\"", factor, expected, printable(text));
}

Cell value_of(std::string const& factor, std::string const& text) {
    std::string const where = "--vary " + factor;
    if (factor == "arithmetic") return std::string(arithmetic_named(usual_arithmetic(text), where).name);
    if (factor == "forgetting")
        return number_in(factor, text, "numbers in (0, 1]", [](double x) { return 0 < x && x <= 1; });
    if (factor == "order")
        return number_in(factor, text, "whole numbers from 1 to 1000",
                         [](double x) { return 1 <= x && x <= 1000 && x == std::floor(x); });
    if (factor == "prior") {
        if (text == "scaled") return text;
        return number_in(factor, text, "scaled, or a positive number c^2", [](double x) { return 0 < x; });
    }
    std::vector<std::string_view> variants;
    for (CatalogueEntry const* const entry : one_entry_each()) variants.push_back(entry->variant);
    expect_one_of(variants, text, where, "variant");
    return text;
}

/// The factors in the order of sweep_factors, with the values that are varied or the default alone. Variants are none:
/// all share a trial's reference.
std::vector<Factor> factors_of(Sweep const& sweep, std::vector<std::string>& variants) {
    std::vector<Factor> out{{"order", {double(sweep.order)}},
                            {"forgetting", {1.0}},
                            {"prior", {std::string("scaled")}},
                            {"arithmetic", {std::string("float"), std::string("double")}},
                            {"variant", {}}};
    for (auto const& [name, values] : sweep.vary) {
        expect_one_of({std::begin(sweep_factors), std::end(sweep_factors)}, name, "--vary", "factor");
        Factor& factor = *std::ranges::find(out, name, &Factor::name);
        factor.values.clear();
        for (std::string const& text : values) {
            Cell const value = value_of(name, text);
            if (std::ranges::find(factor.values, value) != factor.values.end())
                refuse("--vary {}: {} is there twice", name, as_text(value));
            factor.values.push_back(value);
        }
    }
    for (Cell const& variant : out.back().values) variants.push_back(std::get<std::string>(variant));
    bool any = variants.empty();
    for (Cell const& name : out[3].values)
        for (CatalogueEntry const* const entry : entries_in(arithmetic_named(std::get<std::string>(name), "")))
            any = any || std::ranges::find(variants, entry->variant) != variants.end();
    if (!any) refuse("--vary: expected a variant that exists in one of the arithmetics");
    out.back() = {"row_order", {}};
    for (int i = 1; i <= sweep.row_orders; ++i) out.back().values.emplace_back(double(i));
    return out;
}

/// The rows in the i-th order; empty for the first, the record's.
std::vector<Index> order_of_rows(Index rows, int i, std::uint64_t seed) {
    if (i == 1) return {};
    Seed draws{Seed{seed + std::uint64_t(i)}.next()};
    return shuffled(rows, draws);
}

Prior<double> prior_of(Given const& given, Trial const& trial) {
    Cell const& value = trial.value("prior");
    if (std::holds_alternative<double>(value)) return {.variance = std::get<double>(value)};
    return given.by_default.at({trial.number("order"), trial.number("forgetting")});
}

void measure(Given const& given, Trial const& trial, TrialOutput& out) {
    Records const& records = given.records.at(trial.number("order"));
    double const forgetting = trial.number("forgetting");
    Arithmetic const& arithmetic = arithmetic_named(trial.text("arithmetic"), "arithmetic");
    Problem<double> const problem{
        .size = records.parameters(), .forgetting = forgetting, .prior = prior_of(given, trial)};
    RoundedProblem const rounded = rounded_problem(
        records, problem, arithmetic.round, {order_of_rows(records.rows(), int(trial.number("row_order")), given.seed)},
        std::max(30, int(arithmetic.decimal_digits()) + 15));
    for (CatalogueEntry const* const entry : entries_in(arithmetic)) {
        std::string const variant(entry->variant);
        if (!given.variants.empty() && std::ranges::find(given.variants, variant) == given.variants.end()) continue;
        Result const r = score(*entry, rounded, given.seed);
        double const none = std::nan("");
        auto const median = [&](Spread PerMeasure<Spread>::*of) { return r.spread ? ((*r.spread).*of).median : none; };
        out({variant, double(arithmetic.digits), median(&PerMeasure<Spread>::theta), median(&PerMeasure<Spread>::worst),
             r.spread ? r.worst_low : none, median(&PerMeasure<Spread>::covariance),
             r.breakdown ? double(r.breakdown->step) : none,
             r.breakdown ? std::string(name_of(r.breakdown->kind)) : std::string("none")});
    }
}

/// A picture for each of these with several numbers: digits of the worst component of theta.
std::vector<Plot> plots_of(std::vector<Factor> const& factors) {
    std::vector<Plot> out;
    bool several = false;
    for (Factor const& factor : factors) several = several || (factor.name == "arithmetic" && factor.values.size() > 1);
    auto const add = [&](std::string const& x, std::string const& label, bool log,
                         std::vector<std::pair<std::string, std::vector<std::string>>> const& where = {}) {
        out.push_back({.title = "Digits of the worst component of theta",
                       .x = x,
                       .y = "worst",
                       .panel = several && x != "bits" ? "arithmetic" : "",
                       .log = log ? "x" : "",
                       .x_label = label,
                       .y_label = "digits",
                       .where = where});
    };
    for (Factor const& factor : factors) {
        std::vector<std::string> numbers;  // "scaled" has no place on an axis
        for (Cell const& cell : factor.values)
            if (std::holds_alternative<double>(cell)) numbers.push_back(as_text(cell));
        if (numbers.size() < 2) continue;
        if (factor.name == "forgetting") add("forgetting", "lambda", false);
        if (factor.name == "prior") add("prior", "c^2 of P0", true, {{"prior", numbers}});
        if (factor.name == "order") add("order", "model order", false);
    }
    if (several) add("bits", "bits of the significand", false);
    return out;
}

/// One trial for each combination of order, forgetting, prior, arithmetic and row order; in it every variant, against
/// the certified solution of the problem as that arithmetic stores it, at compare's checkpoints. Other orders of rows
/// only where forgetting = 1: elsewhere the order is part of the problem. Reads the records of all orders at once. The
/// caller names the data in Study::source. Throws InputError for an unknown factor, or a value that it cannot have.
Study study_of(Sweep const& sweep, std::uint64_t seed) {
    auto const given = std::make_shared<Given>();
    std::vector<Factor> const factors = factors_of(sweep, given->variants);
    given->seed = seed;
    for (Cell const& order : factors[0].values) {
        double const value = std::get<double>(order);
        Records const& records = given->records[value] = sweep.records(int(value));
        try {
            least_squares(records, 1);
        } catch (InputError const& refused) {
            throw InputError(factors[0].values.size() == 1 ? refused.what()
                                                           : fmt::format("--vary order={}: {}", value, refused.what()));
        }
        if (std::ranges::find(factors[2].values, Cell(std::string("scaled"))) == factors[2].values.end()) continue;
        for (Cell const& forgetting : factors[1].values) {  // once for all orders of rows; what it refuses, now
            double const lambda = std::get<double>(forgetting);
            given->by_default.insert_or_assign({value, lambda}, default_prior(records, lambda).prior());
        }
    }
    return {
        .name = "sweep",
        .question = "Which variant keeps how many digits on this record, and where does that change?",
        .source = {},
        .formula = {},
        .interpretation =
            "Digits of theta, of its worst component and of P: medians over the checkpoints, against "
            "the certified solution of the problem as the arithmetic stores it; worst_low: nine "
            "tenths of the checkpoints keep more. Other orders of rows where forgetting = 1.",
        .factors = [factors](Budget) { return factors; },
        .admits = [](Trial const& trial) { return trial.number("row_order") == 1 || trial.number("forgetting") == 1; },
        .measures = {"variant", "bits", "theta", "worst", "worst_low", "P", "broken_at", "breakdown"},
        .measure = [given](Trial const& trial, TrialOutput& out) { measure(*given, trial, out); },
        .plots = plots_of(factors),
        .claims = {}};
}

// --- the command -----------------------------------------------------------------------------------------------------

struct SweepArguments : StudyRun {
    RecordArguments record;
    std::vector<std::string> vary;  // "forgetting=0.9,1"
    std::vector<std::string> from;  // folders of parts
    int row_orders = 1;
    SweepArguments() { out = "sweep"; }
};

Sweep sweep_of(SweepArguments const& a, Provenance& run) {
    RecordArguments const given = with_example(a.record);
    Sweep out{.vary = {}, .order = given.order, .row_orders = a.row_orders, .records = {}};
    bool orders = false;
    for (std::string const& text : a.vary) {
        FactorValues const values = factor_values_from(text, "--vary");
        if (std::ranges::find(out.vary, values.name, &FactorValues::name) != out.vary.end())
            refuse("--vary: factor \"{}\" is there twice", printable(values.name));
        orders = orders || values.name == "order";
        out.vary.push_back(values);
    }
    if (orders && (a.record.order || a.record.na >= 0 || a.record.nb >= 0 || !given.regressors.empty()))
        refuse("--vary order: does not go with --order, --na, --nb or --regressors");
    out.records = [given, &run, columns = std::make_shared<std::optional<Columns>>()](int order) {
        RecordArguments record = given;
        if (order > 0) record.order = order;
        bool const first = !columns->has_value();
        Question const question = question_of(record, columns.get());
        if (first)
            for (std::string const& warning : question.model.warnings)
                tell(fmt::format("rlslab: warning: {}\n", warning));
        run.file = question.model.file, run.sha256 = question.sha256, run.rows = question.rows;
        return question.records;
    };
    return out;
}

/// What the parts of a sweep have in common.
std::string run_json(Provenance const& run) {
    nlohmann::ordered_json const out{{"sweep", run.command}, {"sha256", run.sha256}};
    return out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';  // a name need not be UTF-8
}

int run_sweep(SweepArguments& a) {
    a.options.out = a.out;
    a.options.budget = Budget::full;
    if (!a.part.whole()) check_part(a);
    if (!a.part.whole() && !a.from.empty()) refuse("--from: does not go with --part");
    expect_no_other_run(a.out, "verdicts.json", "study");
    Provenance run{.command = this_run(false).command};
    Study study = study_of(sweep_of(a, run), a.options.seed);
    study.source = fmt::format("{}, {} rows, sha256 {}", run.file, run.rows, run.sha256);
    a.options.run = run;
    std::string const text = run_json(run);
    for (std::string const& folder : a.from)
        if (noted_run(folder) != text)
            refuse("--from {}: expected a folder with parts of this sweep", printable(folder, 200));
    if (!a.from.empty()) merge_parts({&study}, a.options, {a.from.begin(), a.from.end()});
    if (!a.part.whole()) return run_one_part({&study}, a, text, "another sweep, of other data, or of studies", ""), 0;
    create_folder(a.options.out / ".trials");
    FolderLock const lock(a.options.out);
    std::vector<Outcome> const outcomes = run_whole({&study}, a);
    if (noted_run(a.out) == text) std::filesystem::remove(a.options.out / ".trials" / "run.json");  // its parts are in
    print(fmt::format("{} trials, {} rows: {out}/sweep.csv, figures, and {out}/report.html\n", outcomes[0].trials,
                      outcomes[0].table.rows().size(), fmt::arg("out", printable(a.out, 200))));
    return 0;
}

}  // namespace

Command sweep_command(CLI::App& app) {
    auto const a = std::make_shared<SweepArguments>();
    CLI::App* const sweeping = app.add_subcommand(
        "sweep",
        "The variants on a record, over variant, forgetting, prior, arithmetic, model order and orders of rows.");
    sweeping->footer(
        "Forgetting in two arithmetics:  rlslab sweep data.csv --input u --output y --order 4 --vary "
        "forgetting=0.9,0.99,1 --vary arithmetic=float,p11 --out sweep\n"
        "The model's order:              rlslab sweep data.csv --input u --output y --vary order=1,2,4,8\n"
        "A record of the program:        rlslab sweep --example longley --vary prior=scaled,1e4,1e8\n"
        "Stopped, and started again by the same command, it goes on where it was.\n\n"
        "Factors of --vary: variant (default all), arithmetic (float,double), forgetting (1), prior (scaled: to the "
        "data, as rlslab compare does; or c^2 of P0 = c^2 I), order (of the ARX model, in place of --order). The "
        "folder gets sweep.csv, a row for each variant and combination, figures, and report.html.\n\n"
        "Exit code: 0 it ran; 2 it could not.");
    define_record(*sweeping, a->record);
    define(*sweeping,
           {OptionRow("--vary", a->vary, "FACTOR=A,B", "values of a factor; may be given for several").repeated(),
            OptionRow("--from", a->from, "DIR",
                      "a folder with parts of this sweep, made with --part and their own --out; may be given for "
                      "several")
                .repeated(),
            {"--row-orders", a->row_orders, "N", whole(1, 10000),
             "so many orders of the rows, the record's first, where forgetting = 1; default 1"}});
    define_run(*sweeping, *a, "of stochastic rounding and of the orders of rows; default 1", "");
    return {sweeping, [a] { return run_sweep(*a); }};
}

}  // namespace rlslab::program
