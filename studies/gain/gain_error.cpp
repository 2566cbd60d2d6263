// Errors in the gain: what reaches the covariance, to which order, and down to which floor of rounding.
#include "studies/engine/findings.hpp"
#include "studies/engine/scenarios.hpp"

#include <fmt/format.h>

namespace rlslab {
namespace {

constexpr Index size = 5;

/// K_i (1 + eps r_i) at every step, r nearly normal, against the exact P of the same data.
void measure(Trial const& trial, TrialOutput& out) {
    Entry const& entry = trial.entry(trial.text("variant"), trial.text("arithmetic"));
    Problem<double> const problem =
        as_stored({.size = size, .forgetting = trial.number("lambda"), .prior = Prior<double>{.variance = 1}}, *entry.arithmetic);
    Index const rows = trial.full() ? 500 : 100;
    Records const records = as_stored(white(size, rows, trial.seed({})), *entry.arithmetic);
    auto const filter = entry.make(problem, Seed{1});
    Seed seed = trial.seed({"lambda"});
    for (Index k = 0; k < rows; ++k) {
        Vector<double> relative(size);
        for (double& r : relative) r = trial.number("epsilon") * seed.bell();
        filter->update(records.sample(k), records.y[k], relative);
    }
    out({errors(*filter, certified(problem, records, {rows}, 60).front()).covariance});
}

Table in_reference(Table const& t) {
    return t.where("arithmetic", "reference").where("epsilon", [](double e) { return e < 0.02; });
}

}  // namespace

extern Study const gain_error;
Study const gain_error{
    .name = "gain_error",
    .question = "What does an error in the gain do to the covariance?",
    .source =
        "Bucy & Joseph 1968 (cited, not read); the identities are derived (docs/theory.md 16, 17; docs/literature.md 3.1) and hold "
        "exactly in rationals (study gain_identities)",
    .formula =
        R"tex(\text{conventional: } \delta P = -\frac{1}{\lambda}\,\delta K\,\psi^\top P \qquad
              \text{Joseph: } \delta P = \frac{s}{\lambda}\,\delta K\,\delta K^\top)tex",
    .interpretation =
        "Every step's gain is changed by a random vector of relative size epsilon before it updates P. The forms that subtract K "
        "psi'P pass the error on in first order, Joseph's in second; the forms that propagate a factor have no K in the update of "
        "P and take no error (one of the vector that they compute with passes on in first order: docs/theory.md 32, 33). In float "
        "and double the curves end on the floor of each arithmetic's own rounding, and there Joseph's form has no advantage. With "
        "forgetting the conventional form's asymmetry grows as lambda^-k on top (study gain_error_memory).",
    .data = "white rows, d = 5, one draw",
    .factors =
        [](Budget budget) {
            return std::vector<Factor>{{"arithmetic", {"float", "double", "reference"}},
                                       {"lambda", {1.0, 0.98}},
                                       {"variant", covariance_forms()},
                                       {"epsilon", powers(10, -1, -13, budget == Budget::full ? 0.5 : 1)}};
        },
    .measures = {"error"},
    .measure = measure,
    .plots = {{.title = "Error of P after errors in every gain",
               .x = "epsilon",
               .y = "error",
               .panel = "arithmetic",
               .x_label = "relative error of K",
               .y_label = "relative error of P",
               .where = {{"lambda", {"1"}}},
               .guides = {{"ε", [](double e) { return e; }}, {"ε²", [](double e) { return e * e; }}},
               .floor = 1e-30}},
    .claims =
        {
            {"forms that subtract K psi'P: slope 1.00 +- 0.02 over twelve decades",
             [](Table const& t) {
                 return within(in_reference(t).where("variant", {"conventional_two_sided", "symmetric"}), {"variant", "lambda"},
                               slope("epsilon", "error"), 0.98, 1.02);
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.1")},
            {"the same of the conventional form where nothing is forgotten",
             [](Table const& t) {
                 return within(in_reference(t).where("variant", "conventional").where("lambda", 1.0), {}, slope("epsilon", "error"), 0.98,
                               1.02);
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.1")},
            {"with forgetting the conventional form's own asymmetry grows besides: at epsilon = 1e-13 its error is at least 5 times "
             "symmetric's",
             [](Table const& t) {
                 Table const last = in_reference(t).where("lambda", 0.98).where("epsilon", [](double e) { return e < 2e-13; });
                 double const ratio =
                     last.where("variant", "conventional").number("error") / last.where("variant", "symmetric").number("error");
                 return Finding{ratio >= 5, fmt::format("{:.3g} times", ratio)};
             },
             finding("first edition, set after its run")},
            {"Joseph's forms: slope 2.00 +- 0.02 over twelve decades",
             [](Table const& t) {
                 return within(in_reference(t).where("variant", {"joseph", "joseph_rank_two"}), {"variant", "lambda"},
                               slope("epsilon", "error"), 1.98, 2.02);
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.1")},
            {"in double Joseph's form stands on the floor of rounding, below 1e-14, from an error of 1e-8 on",
             [](Table const& t) {
                 Table const small = t.where("arithmetic", "double").where("epsilon", [](double e) { return e < 2e-8; });
                 return within(small.where("variant", {"joseph", "joseph_rank_two"}), {"variant", "lambda"}, greatest("error"), 1e-17,
                               1e-14);
             },
             finding("first edition, set after its run")},
        },
};

}  // namespace rlslab
