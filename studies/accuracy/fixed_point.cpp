// Fixed-point words: how many bits behind the point, before it and in all each variant needs, against memory,
// conditioning, size and scale.
#include "studies/accuracy/fixed_runs.hpp"
#include <rlslab/studies/judgements.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/reference/certified.hpp>

#include <cmath>
#include <map>

namespace rlslab::studies {
namespace {

constexpr double memories = 30;

void measure(Trial const& trial, TrialOutput& out) {
    Index const d = Index(trial.number("d"));
    double const lambda = trial.number("lambda"), down = trial.number("shift");
    Index const rows = Index(std::lround(memories / (1 - lambda)));
    Records records = delay_line(d, rows, trial.number("pole"), trial.seed({"d", "pole", "lambda", "replicate"}));
    records.psi *= std::ldexp(1.0, -int(down));
    records.y *= std::ldexp(1.0, -int(down) - 3);
    Setting setting(
        {.size = d, .forgetting = lambda, .prior = Prior<double>{.variance = std::ldexp(1.0, 2 * int(down))}},
        std::move(records));

    Extremes const x = extremes(setting.problem(), setting.records());
    InDouble in_double(setting.problem());
    for (Index k = 0; k < rows; ++k) in_double.take(setting.records(), k);
    double const digits = certified(setting.problem(), setting.records(), {rows}, 20)
                              .front()
                              .covariance_digits({Stored<Reference>::Quantity::covariance,
                                                  Stored<Reference>::Form::plain, in_double.P.cast<Reference>()});
    bool const first_model = d == 4 && down == 0;
    for (CatalogueEntry const& entry : fixed_point_filters()) {
        Need const need = need_of(entry, setting, FixedRounding::nearest);
        bool const probed =
            down > 0 && (entry.variant == "symmetric" || entry.variant == "ud" || entry.variant == "qr");
        Need const truncated = probed ? need_of(entry, setting, FixedRounding::down) : Need{NAN, NAN};
        CatalogueEntry const* const rounding = down == 0 ? rounding_every_operation(entry.variant) : nullptr;
        Need const rounded = rounding ? need_of(*rounding, setting, FixedRounding::nearest) : Need{NAN, NAN};
        bool const keeps_theta = entry.variant == "symmetric" || entry.variant == "ud";
        double const noise = keeps_theta && trial.number("pole") == 0 ? theta_noise(entry, setting, lambda) : NAN;
        bool const compared = entry.variant == "symmetric" && first_model;
        auto const in_words = [&](int bits) {  // no more bits before the point than it needs
            int const fraction = bits - 1 - (std::isfinite(need.integer) ? int(need.integer) : bits / 2);
            return fraction >= 1 ? run_in(entry, setting, {bits, fraction}) : Run{"no_room"};
        };
        Run const word16 = in_words(16), word32 = in_words(32);
        out({std::string(entry.variant), need.fraction, need.integer, 1 + need.integer + need.fraction, need.below,
             truncated.fraction, rounded.fraction, word16.outcome, word16.error, word32.outcome, word32.error, noise,
             compared ? floating_bits(setting) : NAN, compared ? sufficient_bits(x, lambda) : NAN,
             correctly::log2(1 / (1 - lambda)), correctly::log2(x.least), correctly::log2(x.greatest),
             correctly::log2(x.largest), digits});
    }
}

// --- claims ----------------------------------------------------------------------------------------------------------

std::vector<std::string> const by_data{"variant", "d", "pole", "lambda", "shift"};
std::vector<std::string> const P_forms{"conventional_two_sided", "symmetric", "joseph", "joseph_rank_two"};
std::vector<std::string> const doubly_root{"potter", "carlson", "inverse_qr", "qr", "extended_qr", "qr_block"};

Selection some(std::vector<std::string> const& variants) { return where("variant", variants); }
Selection of_unit_rows(std::vector<std::string> const& variants) {
    return some(variants).where("shift", 0.0).where("d", 4.0);
}
Selection in_unit_interval(std::vector<std::string> const& variants) { return some(variants).where("shift", 3.0); }
Selection const that_survive = where("fraction", [](double bits) { return std::isfinite(bits); });
/// symmetric's mean on rows of variance 1, within a band for each pole of the table.
Judge at_each_pole(std::string const& column, std::map<double, std::pair<double, double>> const& bands) {
    return of_unit_rows({"symmetric"}).each_judged({"pole"}, [=](Table const& rows) {
        auto const [from, to] = bands.at(rows.numbers("pole").front());
        return within(rows, {"lambda"}, mean(column), from, to);
    });
}
/// The mean over seeds of what f says of the rows of one.
Statistic of_each_seed(std::function<double(Table const&)> f) {
    return [=](Table const& t) {
        auto const seeds = t.groups({"replicate"});
        double sum = 0;
        for (auto const& seed : seeds) sum += f(seed.second);
        return sum / double(seeds.size());
    };
}
/// The column less what a law says of the same row.
Statistic less(std::string column, std::function<double(Table const&)> law) {
    return of_each_seed([=](Table const& row) { return row.number(column) - law(row); });
}
/// What rows 2^3 times as large cost symmetric.
Judge costs(std::string const& column, double from, double to) {
    Statistic const bits = number(column),
                    cost = of_each_seed(bits.on(where("shift", 0.0)) - bits.on(where("shift", 3.0)));
    return within(some({"symmetric"}).where("d", 4.0), {"pole", "lambda"}, cost, from, to);
}
Statistic const ends_by_a_zero_pivot{[](Table const& seed) {
                                         return double(seed.where("below", "zero_pivot").rows().size()) /
                                                double(seed.rows().size());
                                     },
                                     Estimate::share};
double memory(Table const& row) { return row.number("log2_memory"); }
/// (1/2) log2 1/(1 - lambda^2).
double half_memory(Table const& row) {
    double const lambda = row.number("lambda");
    return correctly::log2(1 / (1 - lambda * lambda)) / 2;
}
Basis const item_66 = own_result("docs/theory.md 66, set before the run");

}  // namespace

extern Study const fixed_point{
    .name = "fixed_point",
    .question = "How long must a fixed-point word be, and where does its point go?",
    .source =
        "Diniz & Siqueira 1995, Raghunath & Parhi 1997 (abstracts read); ranges and thresholds are derived "
        "(docs/theory.md 65, 66); the sufficient condition is a program's (docs/theory.md 67)",
    .formula =
        R"tex(\begin{aligned} F_{P} &\approx \log_2 \frac{1}{\min_t \lambda_{\min}(P_t)} + \tfrac12\log_2\frac{1}{1-\lambda^2} + 3 \\
              F_{\text{qr}} &\approx \log_2\frac{1}{1-\lambda} + 1 \ldots 4 \qquad
              W = 1 + I + F \end{aligned})tex",
    .interpretation =
        "A run survives when every step is sound, P stays definite, and the last P is within half of the exact one. A "
        "length is needed when it is the first of three in a row that survive: single lengths survive by luck. The "
        "point stands where the record needs it. Overflow is what the filter reports as nonfinite. Rows of variance 1: "
        "the forms that propagate P need log2 1/lambda_min + (1/2) log2 1/(1 - lambda^2) and 0 to 2 bits more behind "
        "the point on coloured rows, one to three fewer than predicted. Exact sums are not the reason: they save less "
        "than one bit. qr needs log2 of the memory and about 1 to 2.5 bits more, whatever the colour. Rows in [-1, 1) "
        "move bits from behind the point to before it, until there are no more behind it than lambda itself takes. "
        "Then the word grows. In 32 bits all survive but conventional and kalman, in which the antisymmetric error "
        "grows as lambda^-k. In 16 bits and rows in [-1, 1) the triangular roots survive everywhere up to lambda = "
        "0.97. gentleman and information do not on coloured rows: P0 = 64 takes seven bits before the point, and 1/P0 "
        "is small behind it. extended_qr needs 17 bits and more there, because it forgets no error. Truncation costs "
        "symmetric three to six bits. ud ends by inaccuracy, or because lambda becomes 1, and seldom by a D that "
        "becomes 0.",
    .data =
        "delay lines of 2, 4, 8 taps, white and with poles 0.9 and 0.99; 30 memories; rows of variance 1 with P0 = I, "
        "and 2^-3 of them, in [-1, 1), with P0 = 64 I; y = psi'theta + noise, theta = 1/8, all |y| < 1",
    .factors = {{"d", {2.0, 4.0, 8.0}, {4.0}},
                {"pole", {0.0, 0.9, 0.99}, {0.0, 0.9}},
                {"lambda", {0.9, 0.97, 0.99, 0.997}, {0.9, 0.97}},
                {"shift", {0.0, 3.0}},
                {"replicate", counted(20), counted(11)}},
    .admits =
        [](Trial const& trial) {
            return trial.number("d") == 4 ||
                   (trial.number("lambda") == 0.97 && trial.number("pole") < 0.95 && trial.number("shift") == 3);
        },
    .measures = {"variant", "fraction", "integer", "word", "below", "fraction_truncated", "fraction_rounded", "in_16",
                 "error_16", "in_32", "error_32", "theta_noise", "floating", "sufficient", "log2_memory",
                 "log2_least_P", "log2_greatest_P", "log2_largest_psi", "reference_digits"},
    .measure = measure,
    .plots = {{.title = "Bits behind the point, rows in [-1, 1)",
               .x = "log2_memory",
               .y = "fraction",
               .panel = "pole",
               .log = "",
               .x_label = "log2 of 1/(1 - lambda)",
               .y_label = "fraction bits needed",
               .where = {{"shift", {"3"}}, {"d", {"4"}}},
               .guides = {{"log2 memory", [](double m) { return m; }}}},
              {.title = "Length of the word, rows in [-1, 1)",
               .x = "log2_memory",
               .y = "word",
               .panel = "pole",
               .log = "",
               .x_label = "log2 of 1/(1 - lambda)",
               .y_label = "bits of the word needed",
               .where = {{"shift", {"3"}}, {"d", {"4"}}},
               .guides = {{"16 bits", [](double) { return 16; }}}}},
    .claims = {
        {"the double that the words are compared with has at least 8 digits of P, in most runs",
         within(all_rows, {}, least("reference_digits"), 8, INFINITY), verification("certified in every trial")},
        {"X1: the sufficient condition of docs/theory.md 67 asks 37 to 47 bits for white rows, 54 to 57 for the "
         "pole 0.9, 69 to 72 for 0.99",
         at_each_pole("sufficient", {{0, {37, 47}}, {0.9, {54, 57}}, {0.99, {69, 72}}}),
         reproduction("earlier evaluation of the formula of docs/theory.md 67")},
        {"X1: of significand symmetric needs 4 to 9 bits for white rows, 8 to 10 for the pole 0.9, 13 to 14 for 0.99",
         at_each_pole("floating", {{0, {4, 9}}, {0.9, {8, 10}}, {0.99, {13, 14}}}),
         own_result("set after a pilot at the quick budget")},
        {"X2: in most runs no variant survives with fewer than log2 1/(1 - lambda) bits behind the point",
         within(that_survive, by_data, less("fraction", memory).as(Estimate::most), 0, 48), item_66},
        {"X2: forms that multiply by the root of lambda need one bit more than that, in most runs",
         within(that_survive.where("variant", doubly_root), by_data, less("fraction", memory).as(Estimate::most), 1,
                48),
         item_66},
        {"X3: forms that propagate P: log2 1/lambda_min + (1/2) log2 1/(1 - lambda^2) + 3 bits behind the point, to 2",
         within(some(P_forms), by_data,
                less("fraction", [](Table const& r) { return -r.number("log2_least_P") + half_memory(r) + 3; }), -2, 2),
         item_66},
        {"X3: rows 2^3 times as large cost symmetric 6 bits behind the point, to 1, and no bit of the word, to 1",
         labelled("behind the point", costs("fraction", 5, 7)) && labelled("word", costs("word", -1, 1)), item_66},
        {"sums that are exact until stored save 0 to 2 bits behind the point against products that are rounded "
         "(symmetric, ud, qr)",
         within(of_unit_rows({"symmetric", "ud", "qr"}), by_data, less("fraction_rounded", number("fraction")), 0, 2),
         own_result("docs/theory.md 65, set before the run")},
        {"X4: qr, rows of variance 1: log2 1/(1 - lambda) + 1 to 4 bits behind the point, whatever the colour",
         within(of_unit_rows({"qr"}), by_data, less("fraction", memory), 1, 4), item_66},
        {"about 8 bits behind the point suffice for qr (lambda up to 0.99, rows of variance 1)",
         within(of_unit_rows({"qr"}).where("lambda", below(0.995)), by_data, mean("fraction"), 0, 8.5),
         reproduction("Raghunath & Parhi 1997 (abstract read)")},
        {"qr, rows of variance 1: at most log2 max |psi_i| + (1/2) log2 1/(1 - lambda) + 2 bits before the point, "
         "in most runs",
         within(of_unit_rows({"qr"}), by_data,
                less("integer",
                     [](Table const& r) { return r.number("log2_largest_psi") + r.number("log2_memory") / 2 + 2; })
                    .as(Estimate::most),
                -48, 0),
         own_result("docs/theory.md 65, set before the run")},
        {"X5: ud, rows of variance 1: 4 to 11 bits behind the point",
         within(of_unit_rows({"ud"}), by_data, mean("fraction"), 4, 11),
         own_result("set after a pilot at the quick budget")},
        {"X5: what ends ud with a bit less is a D that became 0, in at least half of the runs",
         within(some({"ud"}), {}, ends_by_a_zero_pivot, 0.5, 1), own_result("set after a pilot at the quick budget")},
        {"symmetric: the word takes log2 (largest / least eigenvalue of P in the run) + (1/2) log2 1/(1 - "
         "lambda^2) + 4 bits, to 3",
         within(in_unit_interval({"symmetric"}), by_data,
                less("word",
                     [](Table const& r) {
                         return r.number("log2_greatest_P") - r.number("log2_least_P") + half_memory(r) + 4;
                     }),
                -3, 3),
         item_66},
        {"theta's noise from rounding is that of one rounding of K e: within a factor of 1.25 of the law "
         "(symmetric, ud; white rows)",
         within(some({"symmetric", "ud"}).where("pole", 0.0), by_data, of_each_seed(number("theta_noise")), 1 / 1.25,
                1.25),
         item_66},
        {"in words of 32 bits, rows in [-1, 1), every dense variant survives most runs but conventional and kalman",
         everywhere(
             in_unit_interval({"conventional_two_sided", "symmetric", "joseph", "joseph_rank_two", "potter", "carlson",
                               "ud", "inverse_qr", "information", "qr", "gentleman", "extended_qr", "qr_block"}),
             "in_32", "survives"),
         own_result("set after a pilot at the quick budget")},
        {"conventional and kalman survive in no word in most runs: their antisymmetric error grows as lambda^-k",
         within(some({"conventional", "kalman"}), by_data, least("fraction"), INFINITY, INFINITY),
         own_result("docs/theory.md 28, law ii, set before the run")},
        {"in words of 16 bits, rows in [-1, 1), qr survives most runs at lambda = 0.9",
         everywhere(in_unit_interval({"qr"}).where("lambda", 0.9), "in_16", "survives"),
         own_result("set after a pilot at the quick budget")}}};

}  // namespace rlslab::studies
