// Errors in every gain: of which order what reaches the covariance is, over twelve decades, and on which floor of
// rounding it ends.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

namespace rlslab::studies {
namespace {

constexpr Index size = 5;

/// At every step K_i (1 + eps r_i), in the sweeps wherever the running gain is used, r nearly normal; against the exact
/// P of the same data. The same rows and the same r at every eps: what differs along a line is eps alone.
void measure(Trial const& trial, TrialOutput& out) {
    CatalogueEntry const& entry = trial.entry(trial.text("variant"), trial.text("arithmetic"));
    Problem<double> const problem = as_stored(
        {.size = size, .forgetting = trial.number("lambda"), .prior = Prior<double>{.variance = 1}}, *entry.arithmetic);
    Index const rows = trial.full() ? 300 : 100;
    Records const records = as_stored(white(size, rows, trial.seed({"replicate"})), *entry.arithmetic);
    CertifiedSolution const exact = std::move(certified(problem, records, {rows}, 60).front());
    for (int n = 1; n <= 13; n += trial.full() ? 1 : 2) {
        double const epsilon = std::get<double>(powers(10, -n, -n).front());
        auto const filter = entry.make(problem, Seed{1});
        Seed seed = trial.seed({"lambda", "replicate"});
        for (Index k = 0; k < rows; ++k) {
            Vector<double> relative(size);
            for (double& r : relative) r = epsilon * seed.bell();
            filter->update(records.sample(k), records.y[k], relative);
        }
        out({epsilon, errors(*filter, exact).covariance});
    }
}

std::vector<std::string> const one_gain{"conventional_two_sided", "symmetric"}, growing{"conventional", "kalman"},
    factors{"potter", "carlson", "ud", "inverse_qr", "extended_qr"}, josephs{"joseph", "joseph_rank_two"};

/// Where an error of every gain is small, and far above the rounding of 257 bits.
Judge order(std::vector<std::string> const& variants, double from, double to,
            Selection const& rows = where("epsilon", below(0.02))) {
    return within(rows.where("arithmetic", "reference").where("variant", variants), {"variant", "lambda"},
                  slope("epsilon", "error"), from, to);
}

}  // namespace

extern Study const gain_error{
    .name = "gain_error",
    .question = "What does an error in the gain do to the covariance?",
    .source =
        "Bucy & Joseph 1968 (cited, not read); the laws of one step are derived (docs/theory.md 16, 17, 32, 33) and "
        "exact (tests/variants/gain_laws.cpp)",
    .formula =
        R"tex(\begin{aligned} \text{where } P \text{ is stored and } K\psi^\top P \text{ subtracted: } & \delta P = O(\delta K) \\
              \text{Joseph's forms: } & \delta P = O(\delta K^2) \\
              \text{where a factor is stored: } & \delta P = O(\delta v), \quad
              v \text{ what plays the gain} \end{aligned})tex",
    .interpretation =
        "At every step the vector that plays the gain in the update of P is wrong by a random relative error of size "
        "epsilon: K where P is stored, v = S f in Potter's form, the running gain in the sweeps. All pass it on in "
        "first order but Joseph's forms, which pass it on in second. The forms that propagate a factor are no "
        "exception: they keep definiteness (study gain_error_definiteness), not P. They see nothing of an "
        "error only in the K that they report and do not use. In float and double the lines end on the floor of each "
        "arithmetic's own rounding, and there Joseph's form has no advantage. With forgetting the conventional form's "
        "asymmetry grows as lambda^-k on top (docs/theory.md 28), and without it as the number of steps "
        "(docs/theory.md 36): beyond epsilon N of about 1 it has broken down. How large these errors are: study "
        "gain_error_size.",
    .data = "white rows, d = 5",
    .factors = {{"arithmetic", {"float", "double", "reference"}},
                {"lambda", {1.0, 0.98}},
                {"variant", gain_forms()},
                {"replicate", counted(20), counted(15)}},
    .measures = {"epsilon", "error"},
    .measure = measure,
    .plots = {{.title = "Error of P after errors in every gain",
               .x = "epsilon",
               .y = "error",
               .panel = "arithmetic",
               .x_label = "relative error of the gain",
               .y_label = "relative error of P",
               .where = {{"lambda", {"1"}}},
               .guides = {{"ε", [](double e) { return e; }}, {"ε²", [](double e) { return e * e; }}},
               .floor = 1e-30}},
    .claims = {
        {"forms that propagate a factor, v or the running gain in error: slope 1.00 +- 0.01 over twelve decades",
         order(factors, 0.99, 1.01), own_result("derived beforehand: docs/theory.md 32, 33 (G1)")},
        {"forms that subtract K psi'P and keep P symmetric, or compute psi'P apart: slope 1.00 +- 0.01",
         order(one_gain, 0.99, 1.01), own_result("derived beforehand: docs/theory.md 16")},
        {"conventional and kalman, where nothing is forgotten and epsilon N stays below 0.1: slope 1.00 +- 0.01",
         order(growing, 0.99, 1.01, where("lambda", 1.0).where("epsilon", below(2e-4))),
         own_result("derived beforehand: docs/theory.md 16, 36")},
        {"with forgetting the conventional form's own asymmetry grows besides: at epsilon = 1e-13 its error is at "
         "least 5 times symmetric's",
         within(where("arithmetic", "reference").where("lambda", 0.98).where("epsilon", below(2e-13)), {},
                ratio_of_errors("conventional", "symmetric"), 5, 1e6),
         own_result("first edition, set after its run (docs/theory.md 28, law ii)")},
        {"Joseph's forms: slope 2.00 +- 0.01 over twelve decades", order(josephs, 1.99, 2.01),
         own_result("derived beforehand: docs/theory.md 17")},
        {"in double Joseph's form stands on the floor of rounding, below 1e-14, from an error of 1e-8 on, in most runs",
         within(where("arithmetic", "double").where("epsilon", below(2e-8)).where("variant", josephs),
                {"variant", "lambda"}, greatest("error"), 1e-17, 1e-14),
         own_result("first edition, set after its run")}}};

}  // namespace rlslab::studies
