// Rows that are rounded stochastically: what that does to the smallest singular value of collinear columns.
#include "studies/definiteness/random_rounding.hpp"
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <cmath>

namespace rlslab::studies {
namespace {

constexpr double prior = 0x1p40;

/// Two columns with the same numbers, each number rounded on its own to p bits; then qr in double, which is exact
/// beside that.
void measure(Trial const& trial, TrialOutput& out) {
    int const p = int(trial.number("digits"));
    bool const nearest = trial.text("rounding") == "nearest";
    auto const filter = trial.entry("qr").make({.size = 2, .prior = Prior<double>{.variance = prior}}, Seed{1});
    Seed data = trial.seed({"replicate"}), seed = trial.seed({"digits", "rows", "replicate"});
    RandomRounding const rule{.digits = p, .random_bits = nearest ? 0 : 53 - p};
    auto const draw = [&] { return seed.next(); };
    double units = 0, largest = 0;  // sum of (unit in the last place)^2, max psi^2
    Vector<double> row(2);
    for (Index k = 0; k < Index(trial.number("rows")); ++k) {
        double const x = data.bell();
        for (double& psi : row) psi = nearest ? round_to_bits(x, 0, p) : round_at_random(x, 0, rule, draw);
        int exponent;
        std::frexp(x, &exponent);
        units += x != 0 ? std::ldexp(1.0, 2 * (exponent - p)) : 0;
        largest = std::max(largest, x * x);
        filter->update(row, 0);
    }
    Matrix<Reference> const P = covariance_of(filter->stored());
    Reference const half = (P(0, 0) + P(1, 1)) / 2, difference = (P(0, 0) - P(1, 1)) / 2;
    double const greatest = static_cast<double>(
                     Reference(half + sqrt(Reference(difference * difference + P(0, 1) * P(0, 1))))),
                 u = std::ldexp(1.0, -p);
    out({u, greatest, greatest * units / 6, greatest * trial.number("rows") * u * u * largest, greatest / prior});
}

Table stochastic(Table const& t) { return t.where("rounding", "stochastic"); }

}  // namespace

extern Study const stochastic_rows;
Study const stochastic_rows{
    .name = "stochastic_rows",
    .question = "Does stochastic rounding of the rows regularise collinear columns?",
    .source =
        "Dexter et al. 2024 (abstract read: it lifts the smallest singular value of a tall matrix); the constant is "
        "derived (docs/theory.md 77)",
    .formula =
        R"tex(\lambda_{\max}(P_N) \approx \frac{6}{\sum_k \mathrm{ulp}(x_k)^2} \le \frac{6}{u^2 \sum_k x_k^2})tex",
    .interpretation =
        "Two equal columns stay equal to nearest, and P keeps the variance of the prior in the direction that they do "
        "not excite. Rounded stochastically they differ by noise, and the variance falls as 1/(N u^2). That is a "
        "regularisation by the data's word length: the filter takes the rounding for information, as it would take "
        "noise in its regressors.",
    .data = "two equal columns of nearly normal numbers",
    .factors =
        [](Budget budget) {
            return std::vector<Factor>{{"rounding", {"nearest", "stochastic"}},
                                       {"digits", {6.0, 8.0, 11.0, 16.0}},
                                       {"rows", budget == Budget::full ? std::vector<Cell>{100.0, 1000.0, 10000.0}
                                                                       : std::vector<Cell>{100.0, 1000.0}},
                                       {"replicate", counted(100)}};
        },
    .measures = {"u", "greatest_P", "of_law", "of_bound", "of_prior"},
    .measure = measure,
    .plots = {{.title = "Largest eigenvalue of P for two equal columns, rows rounded to p bits",
               .x = "u",
               .y = "greatest_P",
               .series = "rows",
               .panel = "rounding",
               .x_label = "unit roundoff",
               .y_label = "largest eigenvalue of P",
               .guides = {{"1/(1000 u²)", [](double u) { return 1 / (1000 * u * u); }}}}},
    .claims =
        {
            {"to nearest the columns stay equal: the largest eigenvalue is that of the prior, to 1e-6",
             [](Table const& t) {
                 return within(t.where("rounding", "nearest"), {"digits", "rows"},
                               mean("of_prior").as(Estimate::proven), 1 - 1e-6, 1 + 1e-6);
             },
             verification("docs/theory.md 77").by("docs/theory.md 77")},
            {"S7: stochastic: it is 6 / (sum of ulp^2), within a factor of 1.25",
             [](Table const& t) {
                 return within(stochastic(t), {"digits", "rows"}, mean("of_law"), 0.8, 1.25);
             },
             own_result("docs/theory.md 77, set before the run")},
            {"S7: so it falls as u^-2 does, exponent -2 +- 0.1",
             [](Table const& t) { return within(stochastic(t), {"rows"}, slope("u", "greatest_P"), -2.1, -1.9); },
             own_result("docs/theory.md 77, set before the run")},
            {"S7: and as 1/N, exponent -1 +- 0.1",
             [](Table const& t) { return within(stochastic(t), {"digits"}, slope("rows", "greatest_P"), -1.1, -0.9); },
             own_result("docs/theory.md 77, set before the run")},
            {"S7: N u^2 max psi^2 times it stays below 100 in most runs",
             [](Table const& t) {
                 return within(stochastic(t), {"digits", "rows"}, mean("of_bound").as(Estimate::most), 0, 100);
             },
             own_result("docs/theory.md 77, set before the run")},
        },
};

}  // namespace rlslab::studies
