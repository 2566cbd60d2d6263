// The half-power law over records: what a factor and a stored P lose of P in its own metric, foretold from the rows and
// one constant.
#include <rlslab/studies/half_power.hpp>
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>

#include <cmath>

namespace rlslab::studies {
namespace {

constexpr double u = 0x1p-24;
/// The one constant, from `HalfPower.OfNRowsIsNotExceededInFloat`: ud_delta, d = 2 and 5, 60 rows, other seeds.
constexpr double constant = 0.042, half_a_digit = 3.1623, half_a_digit_above = constant * half_a_digit;
constexpr Index samples = 120;

std::vector<Cell> const deltas{"ud_delta", "carlson_delta", "inverse_qr_delta"};

void measure(Trial const& trial, TrialOutput& out) {
    auto const d = Index(trial.number("d"));
    double const lambda = float(trial.number("lambda")), c2 = trial.number("c2");
    Seed seed = trial.seed({"basis", "d", "replicate"});
    Records const records{.psi = half_power_rows(trial.text("basis"), d, trial.number("kappa"), samples, seed),
                          .y = Vector<double>::Zero(samples),
                          .names = {}};
    HalfPowerLaw const law(records.psi, lambda, c2);
    std::map<std::string, double> bounds{{"symmetric", law.symmetric}, {"joseph", law.joseph}, {"ud", law.ud}};
    bounds["ud_delta"] = law.ud_delta;  // of the other two no constant was counted
    for (Cell const& variant : joined(deltas, {"ud", "symmetric", "joseph"})) {
        auto const name = std::get<std::string>(variant);
        auto const filter =
            trial.entry(name, "float")
                .make({.size = d, .forgetting = lambda, .prior = Prior<double>{.variance = c2}}, Seed{1});
        process_rows(*filter, records, 0, records.rows());
        Matrix<double> const P =
            covariance_of(filter->stored()).unaryExpr([](Reference const& x) { return static_cast<double>(x); });
        double const eta = P.allFinite() ? law.eta(P) : INFINITY;
        bool const stored = name == "symmetric" || name == "joseph";
        double const bound = bounds.contains(name) ? bounds.at(name) : undefined<double>();
        out({variant, eta, eta / (u * (stored ? law.whole : law.half)), eta / (u * bound), u * bound});
    }
}

// --- claims ----------------------------------------------------------------------------------------------------------

std::vector<std::string> const cells{"basis", "d", "lambda", "kappa", "c2"};

Selection of(char const* variant) { return where("variant", variant); }
/// The share of cells whose median of this column lies between.
Judge share(Selection const& rows, char const* column, double from, double to, double least, double most = 1) {
    return rows.judged([=](Table const& t) {
        size_t hits = 0, all = 0;
        for (auto const& [name, cell] : t.groups(cells)) {
            double const middle = median(cell.numbers(column));
            hits += from <= middle && middle <= to, ++all;
        }
        return proportion(hits, all, least, most);
    });
}
Judge foretold(char const* variant) {
    return share(of(variant).where("basis", {"rotated", "units", "line"}), "of_law", constant / half_a_digit,
                 half_a_digit_above, 0.9);
}
Judge slope_of_ud_delta(char const* basis, double from, double to) {
    return within(of("ud_delta").where("basis", basis).where("c2", 1048576.0), {"d", "lambda"}, slope("kappa", "eta"),
                  from, to);
}
/// log10 of the error of symmetric over that of ud_delta.
Statistic paid_more(double kappa) {
    Statistic const digits = [](Table const& t) { return correctly::log10(t.number("eta")); };
    Selection const here = where("kappa", kappa);
    return digits.on(here.where("variant", "symmetric")) - digits.on(here.where("variant", "ud_delta"));
}
Basis seen() { return own_result("docs/theory.md 129; before the run, after a trial of other seeds, d = 2, 5, 20"); }

}  // namespace

extern Study const half_power{
    .name = "half_power",
    .question = "Do a factor of P and a stored P lose half a power and a whole power of the correlation of P?",
    .source = "derived (docs/theory.md 128, 129)",
    .formula =
        R"tex(\begin{aligned} \eta &\le c(d)\,u\sum_k\frac{\tau_k}{\sqrt{\mu_k\gamma_k}} \text{ (factors)}, \qquad
\eta \le c(d)\,u\sum_k\frac{\tau_k}{\mu_k\gamma_k} \text{ (P stored)} \\
(1 - \eta)P_N &\le \hat P_N \le (1 + \eta)P_N \end{aligned})tex",
    .interpretation =
        "Expected and not seen: joseph exceeds u sum tau / (mu gamma) in no cell, so that its further factor is in no "
        "median here. Without a start at rest the median error of ud_delta, carlson_delta, inverse_qr_delta and ud, in "
        "the metric of P, is 0.042 u sum tau mu^-1/2 to half a digit in 97 to 100 % of cells (quick and full, seeds 1 "
        "and 2). No bound was exceeded: the largest share is 0.026. Undecided at both seeds: the slopes in kappa of "
        "ud_delta in rotated columns and of symmetric against it, what the prior costs ud_delta, and the claims on all "
        "starts and on 99 % of cells, for which these cells are too few.",
    .data =
        "d = 3, 4, 8, N = 120, float: geometric spectra rotated or in units, a line of an autoregression, a start at "
        "rest; condition 30, 300, 1000; P0 = 16 I to 2^20 I; lambda 1 and 31/32",
    .factors = {{"basis", {"rotated", "units", "line", "start"}},
                {"d", {3.0, 4.0, 8.0}},
                {"lambda", {1.0, 0.96875}},
                {"kappa", {30.0, 300.0, 1000.0}},
                {"c2", {16.0, 1024.0, 1048576.0}},
                {"replicate", counted(40), counted(11)}},
    .measures = {"variant", "eta", "of_law", "of_bound", "bound"},
    .measure = measure,
    .plots = {{.title = "Error in the metric of P, rotated",
               .x = "kappa",
               .y = "eta",
               .x_label = "condition number",
               .where = {{"basis", {"rotated"}}, {"d", {"4"}}, {"lambda", {"1"}}, {"c2", {"1048576"}}}}},
    .claims = {
        // of a bound that is not below 1 the first order says nothing
        {"no error of ud_delta, symmetric or joseph exceeds its proven bound, where that is below 1",
         within(where("variant", {"ud_delta", "symmetric", "joseph"}).where("bound", below(1)), {"variant"},
                greatest("of_bound").as(Estimate::every), 0, 1),
         seen(), 0.97},
        {"ud_delta, without starts at rest: the median of at least nine cells in ten lies within half a digit of "
         "0.042 u sum tau mu^-1/2",
         foretold("ud_delta"), seen(), 0.75},
        {"carlson_delta, likewise, by the same constant", foretold("carlson_delta"), seen(), 0.6},
        {"inverse_qr_delta, likewise", foretold("inverse_qr_delta"), seen(), 0.6},
        {"ud, likewise", foretold("ud"), seen(), 0.6},
        {"ud_delta, starts at rest: the median never exceeds that by half a digit",
         share(of("ud_delta").where("basis", "start"), "of_law", 0, half_a_digit_above, 1), seen(), 0.3},
        {"symmetric: the median never exceeds u sum tau / (mu gamma), starts included: 99 % of cells at least",
         share(of("symmetric"), "of_law", 0, 1, 0.99), seen(), 0.7},
        {"joseph: the median exceeds that in 2 to 40 % of cells: its further factor is needed",
         share(of("joseph"), "of_law", 1, INFINITY, 0.02, 0.4), seen(), 0.35},
        {"ud_delta, rotated, c^2 = 2^20: slope 1.0 +- 0.2 in kappa", slope_of_ud_delta("rotated", 0.8, 1.2), seen(),
         0.6},
        {"ud_delta, units, c^2 = 2^20: slope 0.0 +- 0.15 in kappa", slope_of_ud_delta("units", -0.15, 0.15), seen(),
         0.75},
        {"symmetric, rotated, c^2 = 1024, kappa up to 300: it pays more than ud_delta by a slope of 0.6 to 1.4",
         within(where("basis", "rotated").where("c2", 1024.0), {"d", "lambda"}, paid_more(300) - paid_more(30), 0.6,
                1.4),
         seen(), 0.35},
        {"ud_delta, rotated, kappa = 300: from c^2 = 1024 to 2^20 the error changes by a factor of 1/2 to 2 in the "
         "median: a factor does not pay for the prior",
         within(of("ud_delta").where("basis", "rotated").where("kappa", 300.0), {"d", "lambda"},
                number("eta").on(where("c2", 1048576.0)) / number("eta").on(where("c2", 1024.0)), 0.5, 2),
         seen(), 0.3}}};

}  // namespace rlslab::studies
