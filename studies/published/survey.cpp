// What `rlslab compare` shows of real records: which form keeps how many digits, which breaks down, and whether the one
// that compare names is within half a digit of the best.
#include "studies/published/naming.hpp"
#include "studies/published/data.hpp"

#include <rlslab/studies/judgements.hpp>

#include <cmath>

namespace rlslab::studies {
namespace {

using namespace compare;
using namespace survey_data;

/// The forms of the survey's first run: the claims that were registered before it are about these.
std::vector<std::string> const plain{"conventional",    "conventional_two_sided",
                                     "symmetric",       "joseph",
                                     "joseph_rank_two", "kalman",
                                     "information",     "potter",
                                     "carlson",         "ud",
                                     "inverse_qr",      "qr",
                                     "gentleman",       "extended_qr"};
std::vector<std::string> const deltas{"ud_delta", "carlson_delta", "inverse_qr_delta"};
std::vector<std::string> surveyed() {
    std::vector<std::string> out = plain;
    out.insert(out.end(), deltas.begin(), deltas.end());
    return out;
}
std::vector<std::string> const words_compared{"bfloat16", "binary16", "float", "double"}, long_words{"float", "double"};

std::optional<Comparison> compared(Records const& records, Trial const& trial) {
    CompareOptions options{.forgetting = trial.number("lambda"),
                           .variants = surveyed(),
                           .arithmetics = words_compared,
                           .seed = trial.seed({"record"}).state,
                           .threads = 1,
                           .timings = false};
    if (Cell const& prior = trial.value("prior"); std::holds_alternative<double>(prior))
        options.p0 = std::get<double>(prior);
    if (!naming::determine_theta(records, options.forgetting)) return {};
    return compare::compare(records, options);
}

std::string named_in(std::optional<Comparison> const& comparison, std::string const& word) {
    if (comparison)
        for (Recommendation const& r : comparison->recommendations)
            if (r.arithmetic == word) return r.variant;
    return "";
}

void measure(Trial const& trial, TrialOutput& out) {
    Records const natural = records_of(trial.text("record")),
                  records = trial.text("units") == "natural" ? natural : scaled(natural);
    std::optional<Comparison> const all = compared(records, trial), half = compared(first_half(records), trial);
    if (!all) return;
    for (std::string const& word : words_compared) {
        std::vector<Result const*> single, sound;
        for (Result const& r : all->results)
            if (r.entry->arithmetic->name == word && takes_single_rows(r)) {
                single.push_back(&r);
                if (is_sound(r)) sound.push_back(&r);
            }
        std::string const named = named_in(all, word), by_half = named_in(half, word);
        for (Result const* const r : single) {
            double const none = std::nan("");
            auto const middle = [&](Spread PerMeasure<Spread>::*of) {
                return r->spread ? ((*r->spread).*of).median : none;
            };
            std::string const variant(r->entry->variant);
            out({word, variant, middle(&PerMeasure<Spread>::theta), middle(&PerMeasure<Spread>::worst),
                 middle(&PerMeasure<Spread>::covariance), is_sound(*r) ? loss_of(*r, sound).digits : double(INFINITY),
                 r->runs ? double(r->broken) / r->runs : 1.0, r->breakdown ? double(r->breakdown->step) : none,
                 double(variant == named), double(variant == by_half)});
        }
    }
}

bool is_positive(double x) { return x > 0; }
/// Losses are tenths and their medians twentieths: without the rounding of differences, forms that tie differ by 0.
double in_twentieths(double x) { return naming::in_parts(x, 20); }
bool is_half_a_digit(double x) { return in_twentieths(x) <= 0.5; }
bool is_a_digit(double x) { return in_twentieths(x) <= 1; }
/// The share of rows for which it holds, over the records.
Statistic of_records(char const* column, bool (*holds)(double), Estimate estimate = Estimate::share) {
    return naming::share(column, holds, "record", estimate);
}
Statistic const breaks_down = of_records("broken", is_positive), hits = of_records("loss", is_half_a_digit);

Selection in(std::vector<std::string> const& some_words) { return where("word", some_words); }
Selection const short_word = in({"binary16"}).where("units", "natural").where("prior", Prior<double>{}.variance);
Statistic const loss = median("loss").over("record");

/// The share of a record's cells for which it holds, a cell of each value in these columns.
Statistic share_of_cells(std::vector<std::string> const& by, bool (*holds)(Table const& cell)) {
    return share_of_groups(by, holds).over("record");
}
bool all_keep_6_digits(Table const& cell) { return least("worst")(cell) >= 6; }
bool all_break_down(Table const& cell) { return least("broken")(cell) > 0; }
bool some_is_named(Table const& cell) { return greatest("named")(cell) > 0; }
Judge names_one(std::string const& word, double least_share) {
    return labelled(
        word, within(in({word}), {}, share_of_cells({"units", "prior", "lambda"}, some_is_named), least_share, 1));
}
/// What compare names by the first half over ud always: in which share of the cells more it is within half a digit.
Statistic const gain_over_ud(
    [](Table const& of) {
        double more = 0, judged = 0;
        for (auto const& [name, cell] : of.groups({"units", "prior", "lambda"})) {
            Table const named = cell.where("named_by_half", 1.0);
            if (named.empty()) continue;
            more += is_half_a_digit(named.number("loss")), ++judged;
            more -= is_half_a_digit(cell.where("variant", "ud").number("loss"));
        }
        return judged > 0 ? more / judged : 0;
    },
    Estimate::mean);
Statistic const gain_by_scaling([](Table const& of) {
    double const scaled = median("worst")(of.where("units", "scaled")),
                 natural = median("worst")(of.where("units", "natural"));
    return scaled == natural ? 0.0 : scaled - natural;
});

/// Judges the median over records of what a form loses more than another, each record's the median over its cells.
Judge loses_more(std::string const& variant, std::string const& than, double from, double to) {
    Statistic const more([=](Table const& of) {
        double const own = median("loss")(of.where("variant", variant)),
                     other = median("loss")(of.where("variant", than));
        return own == other ? 0.0 : in_twentieths(own - other);
    });
    return labelled(variant,
                    within(in(long_words).where("variant", {variant, than}), {"word"}, more.over("record"), from, to));
}
Judge no_other_loses_less() {
    std::vector<Judge> parts;
    for (std::string const& other : plain)
        if (other != "ud") parts.push_back(loses_more(other, "ud", 0, INFINITY));
    return together(parts);
}

/// The delta forms joined after the first run; these bands were committed before a run that had them.
constexpr char const* with_deltas = "set before a run with the delta forms";
std::vector<std::string> const factored{"potter", "carlson", "ud", "inverse_qr", "qr", "gentleman", "extended_qr"};
Plot loss_of_each(std::string const& units_in_words, std::string const& units) {
    return {.title = "Loss of each form, " + units_in_words,
            .x = "prior",
            .y = "loss",
            .panel = "word",
            .log = "x",
            .x_label = "prior variance c²",
            .y_label = "digits lost to the best",
            .where = {{"units", {units}}, {"prior", {"100", "16384", "1e+08"}}, {"word", long_words}}};
}

}  // namespace

extern Study const survey{
    .name = "survey",
    .question =
        "On real records, which form keeps how many digits, who breaks down, and is what compare names the best?",
    .source = "studies/data/survey: data sets of R, statsmodels, scikit-learn and NIST; the rules of docs/compare.md",
    .formula =
        R"tex(\text{loss}_v = \max_m (\max_w \text{digits}_m(w) - \text{digits}_m(v)),\quad m = \theta, \theta_{\text{worst}}, P)tex",
    .interpretation =
        "A cell is a record in its units or scaled, with a prior, lambda and a word. Digits are medians over "
        "checkpoints and, where lambda = 1, four orders of rows, as compare counts them. A form that broke down has an "
        "infinite loss. What compare names is judged twice: named by the whole record, and named by its first half and "
        "judged on the whole. Intervals are over records; they speak of records like these, under these rules. The "
        "first 18 claims were registered for the fourteen plain forms, before the delta forms joined.",
    .data = "a third of the 326 records of studies/data/survey, each at most 200 rows; at the quick budget five",
    .factors =
        [](Budget budget) {
            std::vector<Cell> records;
            std::vector<std::string> const all = used();
            for (size_t i = 0; i < all.size(); ++i)
                if (budget == Budget::full ? i % 3 == 0 : in_program(all[i]) && all[i] != "NIST.filip")
                    records.emplace_back(all[i]);
            return std::vector<Factor>{{"record", records},
                                       {"units", {"natural", "scaled"}},
                                       {"prior", {1e2, Prior<double>{}.variance, 1e8, "proposed"}},
                                       {"lambda", {1.0, 0.99}}};
        },
    .measures = {"word", "variant", "theta", "worst", "P", "loss", "broken", "broken_at", "named", "named_by_half"},
    .measure = measure,
    .plots = {loss_of_each("natural units", "natural"), loss_of_each("scaled", "scaled")},
    .claims = {
        {"float, natural units: conventional loses definiteness in 30 to 80 % of a record's cells",
         within(in({"float"}).where("variant", "conventional").where("units", "natural"), {}, breaks_down, 0.3, 0.8),
         own_result("set before the run")},
        {"float, scaled: in 5 to 50 %",
         within(in({"float"}).where("variant", "conventional").where("units", "scaled"), {}, breaks_down, 0.05, 0.5),
         own_result("set before the run")},
        {"double: in at most 10 %", within(in({"double"}).where("variant", "conventional"), {}, breaks_down, 0, 0.1),
         own_result("set before the run")},
        {"factor forms, float and double: most records have no cell with a breakdown, for each form",
         within(in(long_words).where("variant", factored), {"variant", "word"}, greatest("broken").over("record"), 0,
                0),
         own_result("docs/theory.md 34; set before the run")},
        {"float and double: the median loss of ud is at most 0.5 digits",
         within(in(long_words).where("variant", "ud"), {"word"}, loss, 0, 0.5), own_result("set before the run")},
        {"and of carlson, qr, gentleman and inverse_qr 0.2 to 1.5",
         within(in(long_words).where("variant", {"carlson", "qr", "gentleman", "inverse_qr"}), {"variant", "word"},
                loss, 0.2, 1.5),
         own_result("set before the run")},
        {"no other form has a median loss below that of ud", no_other_loses_less(), own_result("set before the run")},
        {"double, the proposed prior: symmetric loses 0.3 to 2.5 digits in the median",
         within(in({"double"}).where("prior", "proposed").where("variant", "symmetric"), {"units"}, loss, 0.3, 2.5),
         own_result("set before the run")},
        {"c^2 = 1e8, natural units: it loses 3 digits or more in double",
         within(in({"double"}).where("units", "natural").where("prior", 1e8).where("variant", "symmetric"), {}, loss, 3,
                INFINITY),
         own_result("set before the run")},
        {"double, the proposed prior: in at least 60 % of cells every form keeps 6 digits of the worst component",
         within(in({"double"}).where("prior", "proposed").where("variant", plain), {},
                share_of_cells({"units", "lambda"}, all_keep_6_digits), 0.6, 1),
         own_result("set before the run")},
        {"binary16, natural units, C++'s default prior: every form breaks down in 30 to 90 % of cells",
         within(short_word.where("variant", plain), {}, share_of_cells({"lambda"}, all_break_down), 0.3, 0.9),
         own_result("set before the run")},
        {"compare names a form in at least 75 % of cells in double and 30 % in float",
         names_one("double", 0.75) && names_one("float", 0.3), own_result("set before the run")},
        {"what compare names loses at most half a digit in at least 95 % of these records' cells",
         within(in(long_words).where("named", 1.0), {"word"}, of_records("loss", is_half_a_digit, Estimate::fixed),
                0.95, 1),
         own_result("the survey's goal; set before the run")},
        {"named by the first half: at most half a digit in at least 70 % of cells of the whole",
         within(in(long_words).where("named_by_half", 1.0), {"word"}, hits, 0.7, 1), own_result("set before the run")},
        {"and at most one digit in at least 90 % of these records' cells",
         within(in(long_words).where("named_by_half", 1.0), {"word"}, of_records("loss", is_a_digit, Estimate::fixed),
                0.9, 1),
         own_result("set before the run")},
        {"and it breaks down in at most 2 % of them",
         within(in(long_words).where("named_by_half", 1.0), {"word"},
                of_records("broken", is_positive, Estimate::fixed), 0, 0.02),
         own_result("set before the run")},
        {"where the first half names a form, it is within half a digit not less often than ud always: by -3 to 30 %",
         within(in(long_words), {"word"}, gain_over_ud.over("record"), -0.03, 0.3), own_result("set before the run")},
        {"float, c^2 = 1e8: scaled columns give symmetric one digit of the worst component or more",
         within(in({"float"}).where("prior", 1e8).where("variant", "symmetric"), {}, gain_by_scaling.over("record"), 1,
                INFINITY),
         own_result("set before the run")},
        {"float and double: the median loss of ud_delta is at most 0.4 digits, and -0.3 to 0.1 more than that of ud",
         labelled("loss", within(in(long_words).where("variant", "ud_delta"), {"word"}, loss, 0, 0.4)) &&
             loses_more("ud_delta", "ud", -0.3, 0.1),
         own_result(with_deltas)},
        {"carlson_delta and inverse_qr_delta lose 0 to 0.4 digits less than carlson and inverse_qr",
         loses_more("carlson_delta", "carlson", -0.4, 0) && loses_more("inverse_qr_delta", "inverse_qr", -0.4, 0),
         own_result(with_deltas)},
        {"delta forms, float and double: most records have no cell with a breakdown, for each form",
         within(in(long_words).where("variant", deltas), {"variant", "word"}, greatest("broken").over("record"), 0, 0),
         own_result(with_deltas)},
        {"binary16, natural units, C++'s default prior: each delta form breaks down in 60 to 100 % of a record's cells",
         within(short_word.where("variant", deltas), {"variant"}, breaks_down, 0.6, 1), own_result(with_deltas)}}};

}  // namespace rlslab::studies
