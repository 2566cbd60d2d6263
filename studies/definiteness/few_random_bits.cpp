// Stochastic rounding with all bits and with few: how far the covariance of a running mean falls, and where it stops.
#include "studies/definiteness/random_filters.hpp"
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>

#include <cmath>

namespace rlslab::studies {
namespace {

constexpr double sqrt_2 = 1.4142135623730951;

/// psi = 1, nothing forgotten, P0 = 1: P_k = 1/(k + 1). `law` is what 1/P should be, `scaled` the rows over the law's
/// own number of rows.
void measure(Trial const& trial, TrialOutput& out) {
    int const p = int(trial.number("digits")), r = int(trial.number("random_bits"));
    std::string const& rounding = trial.text("rounding");
    double const u = std::ldexp(1.0, -p), two_r = std::ldexp(1.0, r);
    bool const nearest = rounding == "nearest", whole = rounding == "stochastic", truncated = rounding == "truncate";
    RandomRoundingScope const rule(
        {.digits = p,
         .random_bits = nearest ? 0
                        : whole ? 53 - p
                                : r,
         .surplus = rounding == "half" ? RandomRounding::Surplus::half : RandomRounding::Surplus::truncate});
    double const own = truncated ? two_r / (1.44 * u) : sqrt_2 * (rounding == "half" ? two_r : 1) / u;  // rows
    double const rows = std::ceil((truncated ? 4 : whole ? 12 : 3) * own);
    Seed seed = trial.seed({"digits", "random_bits", "rounding", "replicate"});
    auto const filter =
        randomly_rounded("symmetric").make({.size = 1, .prior = Prior<double>{.variance = 1}}, Seed{seed.next()});
    Vector<double> const one = Vector<double>::Ones(1);
    double reported = 1;
    for (double k = 1; k <= rows; ++k) {
        filter->update(one, 1);
        if (k < reported && k < rows) continue;
        // Half an octave apart; behind `own` of a truncated run ten for each `own`, for its rate.
        reported = std::max(k + 1, truncated && k > own ? k + own / 10 : k * sqrt_2);
        double const P = filter->stored_in_double().F(0, 0), scaled = k / own;
        double const law = whole       ? k + 1
                           : truncated ? (scaled < 1 ? k : own * correctly::exp(scaled - 1))
                                       : std::min(k, own);
        out({k, scaled, k == rows ? 1.0 : 0.0, P, 1 / P, (k + 1) * P, 1 / P / law,
             whole ? ((k + 1) * P - 1) / (0.9 * std::sqrt(u)) : 0.0});
    }
}

Table at_the_end(Table const& t, char const* rounding) { return t.where("rounding", rounding).where("last", 1.0); }
Statistic const of_law([](Table const& t) { return t.number("of_law"); });

}  // namespace

extern Study const few_random_bits;
Study const few_random_bits{
    .name = "few_random_bits",
    .question = "Does stochastic rounding keep a running mean awake, and how many random bits does that take?",
    .source =
        "Connolly, Higham & Mary 2021 (abstract read: no stagnation); Fitzgibbon & Felix 2025 (abstract read: few "
        "random bits are biased); the laws are derived (docs/theory.md 75)",
    .formula =
        R"tex(\begin{aligned} \text{to nearest: } & P \to u/\sqrt2 \qquad \text{stochastic: } kP = 1 \pm 0.9\sqrt u \\
              r \text{ bits, rest truncated: } & 1/P \approx k^* e^{k/k^* - 1}, \quad k^* = 2^r/(1.44\,u) \\
              r \text{ bits, half added: } & P \to 2^{-r} u/\sqrt2 \end{aligned})tex",
    .interpretation =
        "To nearest P stops at u/sqrt(2) for every length. Stochastic rounding with all bits has no such place: k P "
        "stays at 1 in the mean, with a standard deviation of 0.9 sqrt(u). With r random bits there is an end again. "
        "If the surplus bits are truncated, P falls too fast from k* = 2^r/(1.44 u) rows on, by e in k* rows: the "
        "filter believes to know the mean ever better and falls asleep. If half of the last random bit is added first, "
        "P freezes as to nearest, 2^r times lower. So few random bits buy r bits of 1/P, and adding half decides "
        "whether the filter ends too careful or asleep.",
    .data = "psi = 1, d = 1, P0 = 1, symmetric",
    .factors =
        [](Budget budget) {
            bool const full = budget == Budget::full;
            return std::vector<Factor>{
                {"digits", full ? std::vector<Cell>{8.0, 11.0, 16.0} : std::vector<Cell>{8.0, 11.0}},
                {"rounding", {"nearest", "stochastic", "truncate", "half"}},
                {"random_bits", {0.0, 1.0, 2.0, 3.0, 4.0, 6.0}},
                {"replicate", counted(1000)}};
        },
    .admits =
        [](Trial const& trial) {
            double const p = trial.number("digits"), r = trial.number("random_bits"), n = trial.number("replicate");
            std::string const& rounding = trial.text("rounding");
            if (rounding == "nearest") return r == 0 && n == 1;
            if (rounding == "stochastic")
                return r == 0 && n <= (p == 16 ? 200 : p == 11 ? (trial.full() ? 1000 : 500) : 1000);
            return r > 0 && p + r <= (trial.full() ? 18 : 13) && n <= (trial.full() ? 100 : 20);
        },
    .measures = {"rows", "scaled", "last", "P", "inverse_P", "rows_P", "of_law", "deviation"},
    .measure = measure,
    .plots = {{.title = "1/P, which should be the number of rows: few random bits, the rest truncated",
               .x = "rows",
               .y = "inverse_P",
               .series = "random_bits",
               .panel = "rounding",
               .x_label = "rows k",
               .y_label = "1/P",
               .where = {{"digits", {"8"}}, {"rounding", {"stochastic", "truncate", "half", "nearest"}}},
               .guides = {{"k", [](double k) { return k; }}}}},
    .claims =
        {
            {"S1: to nearest P freezes at u/sqrt(2), within 1 %, for every p tried",
             [](Table const& t) {
                 return within(at_the_end(t, "nearest"), {"digits"}, of_law.as(Estimate::fixed), 0.99, 1.01);
             },
             own_result("docs/theory.md 75, set before the run")},
            {"S2: stochastic, 17 times as many rows as it takes to freeze: k P is 1 in the mean, within 2 %",
             [](Table const& t) {
                 return within(at_the_end(t, "stochastic"), {"digits"}, mean("rows_P").as(Estimate::mean), 0.98, 1.02);
             },
             own_result("docs/theory.md 75, set before the run")},
            {"S2: and has the standard deviation 0.9 sqrt(u), within a factor of 1.25",
             [](Table const& t) {
                 return within(at_the_end(t, "stochastic"), {"digits"}, root_mean_square("deviation"), 0.8, 1.25);
             },
             own_result("docs/theory.md 75, set before the run")},
            {"S3: r random bits, the rest truncated: at 4 k*, k* = 2^r/(1.44 u), 1/P is k* e^3 within a factor of 3: "
             "the filter falls asleep",
             [](Table const& t) {
                 return within(at_the_end(t, "truncate"), {"digits", "random_bits"}, of_law, 1 / 3.0, 3);
             },
             own_result("docs/theory.md 75, set before the run")},
            {"S3: beyond 2 k* it grows by e in k* rows, within a factor of 1.25",
             [](Table const& t) {
                 Table const late = t.where("rounding", "truncate").where("scaled", [](double s) { return s > 2; });
                 return within(late, {"digits", "random_bits"}, rate("scaled", "inverse_P"), 0.8, 1.25);
             },
             own_result("docs/theory.md 75, set before the run")},
            {"S3: with half of the last random bit added P freezes at 2^-r u/sqrt(2), within 1 %",
             [](Table const& t) {
                 return within(at_the_end(t, "half"), {"digits", "random_bits"}, of_law, 0.99, 1.01);
             },
             own_result("docs/theory.md 75, set before the run")},
        },
};

}  // namespace rlslab::studies
