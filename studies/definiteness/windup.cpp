// No excitation with forgetting: P grows without bound in directions without data. How each form behaves.
// Longer than 150 lines: nine claims on one run.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/breakdown.hpp>

#include <cmath>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

/// The same psi in every row, until P breaks down, but at most 2.5 times as long as P stays in the arithmetic's range:
/// the root of P stays in range twice as long, and that of its inverse a little longer, because of the subnormal
/// numbers.
void measure(Trial const& trial, TrialOutput& out) {
    CatalogueEntry const& entry = trial.entry(trial.text("variant"), trial.text("arithmetic"));
    Arithmetic const& arithmetic = *entry.arithmetic;
    Problem<double> const problem =
        as_stored({.size = 3, .forgetting = trial.number("lambda"), .prior = Prior<double>{.variance = 1}}, arithmetic);
    std::vector<double> psi{1, 0.7, -0.3};
    double square = 0;
    for (double& x : psi) x = arithmetic.round(x), square += x * x;
    double const lambda = problem.forgetting, rate = -correctly::log(lambda);
    double const indefinite_law = correctly::log((1 - lambda) / (arithmetic.unit_roundoff() * square)) / rate;
    double const overflow_law = (arithmetic.max_exp + 1) * correctly::log(2) / rate;
    auto const filter = entry.make(problem, Seed{1});
    Health outcome = Health::sound;
    int step = 0;
    while (outcome == Health::sound && step < 2.5 * overflow_law) {
        filter->update(psi, 1);
        outcome = breakdown(*filter, arithmetic);
        ++step;
    }
    Matrix<Reference> const P = covariance_of(filter->stored());
    double largest = INFINITY;  // where an infinity ended the run
    if (outcome != Health::nonfinite) largest = static_cast<double>(log2(abs(P(0, 0)) + abs(P(1, 1)) + abs(P(2, 2))));
    out({1 / (1 - trial.number("lambda")), double(step), std::string(name_of(outcome)), step / indefinite_law,
         step / overflow_law, largest / arithmetic.digits});
}

Judgement none(Table const& t, std::string const& outcome) {
    size_t const found = t.where("outcome", outcome).rows().size();
    return {!t.empty() && found == 0, fmt::format("{} of {} are {}", found, t.rows().size(), outcome)};
}

std::vector<std::string> const triangles = words(triangular_forms());

}  // namespace

extern Study const windup;
Study const windup{
    .name = "windup",
    .question = "What does forgetting do while nothing excites the parameters?",
    .source =
        "laws derived (docs/theory.md 40); numbers of an earlier experiment (docs/literature.md 3.10), measured again "
        "here with definiteness decided exactly",
    .formula =
        R"tex(\begin{aligned} k^* &= \ln\frac{1-\lambda}{u P_0 |\psi|^2} \Big/ (-\ln\lambda) && \text{P indefinite} \\
               k_{\max} &= \ln(\text{largest number}) \Big/ (-\ln\lambda) && \text{P too large} \end{aligned})tex",
    .interpretation =
        "The regressor never changes, psi = (1, 0.7, -0.3). P falls to (1 - lambda)/|psi|^2 along psi and grows as "
        "lambda^-k across it. Once u times the large part exceeds the small one, a P stored plainly is indefinite: "
        "Joseph's form at about k* or before, the symmetric forms a little later. Factors hold numbers whose squares "
        "are so far apart, and go on. UD alone follows the exact P to the end of the arithmetic's range; the other "
        "roots of P grow no further than about u^-2 (presumably because the rounding of psi'S then passes for "
        "excitation): sound, and far too small. Potter's full root has no triangle to protect it there and may become "
        "exactly singular. Where information survives, the roundings of its decayed part happened to fall on the good "
        "side.",
    .data = "one constant row, d = 3",
    .factors =
        [](Budget) {
            return std::vector<Factor>{
                {"arithmetic", {"float", "double"}}, {"lambda", {0.9, 0.95, 0.98, 0.99}}, {"variant", row_forms()}};
        },
    .measures = {"memory", "step", "outcome", "of_indefinite_law", "of_overflow_law", "growth"},
    .measure = measure,
    .plots = {{.title = "First step without a definite P",
               .x = "memory",
               .y = "step",
               .panel = "arithmetic",
               .x_label = "1/(1 - lambda)",
               .y_label = "first step",
               .where = {{"outcome", {"indefinite", "nonfinite"}}}},
              {.title = "The same, over the law of indefiniteness",
               .x = "memory",
               .y = "of_indefinite_law",
               .panel = "arithmetic",
               .log = "x",
               .x_label = "1/(1 - lambda)",
               .y_label = "first step / k*",
               .where = {{"variant", words(covariance_forms())}},
               .guides = {{"k*", [](double) { return 1.0; }}}}},
    .claims =
        {
            {"every covariance form becomes indefinite",
             [](Table const& t) {
                 return everywhere(t.where("variant", words(covariance_forms())), "outcome", "indefinite");
             },
             reproduction("earlier experiment, docs/literature.md 3.10")},
            {"in double symmetric and joseph do so at 0.8 to 1.25 of k*",
             [](Table const& t) {
                 return within(t.where("arithmetic", "double").where("variant", {"symmetric", "joseph"}),
                               {"variant", "lambda"}, median("of_indefinite_law"), 0.8, 1.25);
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.10")},
            {"in float at 0.75 to 1.35 of k*",
             [](Table const& t) {
                 return within(t.where("arithmetic", "float").where("variant", {"symmetric", "joseph"}),
                               {"variant", "lambda"}, median("of_indefinite_law"), 0.75, 1.35);
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.10")},
            {"Joseph's form no later than the symmetric one: at 0.6 to 1 of its step",
             [](Table const& t) {
                 return within(
                     t.where("variant", {"symmetric", "joseph"}), {"arithmetic", "lambda"},
                     [](Table const& g) {
                         return g.where("variant", "joseph").number("step") /
                                g.where("variant", "symmetric").number("step");
                     },
                     0.6, 1);
             },
             own_result("first edition, set after its run")},
            {"triangular factor forms are never indefinite, to 2.5 times the step at which the exact P overflows",
             [](Table const& t) { return none(t.where("variant", triangles), "indefinite"); },
             reproduction("earlier experiment, docs/literature.md 3.10")},
            {"ud overflows within 0.2 % of the law",
             [](Table const& t) {
                 Judgement const overflow = everywhere(t.where("variant", "ud"), "outcome", "nonfinite");
                 Judgement const when = within(t.where("variant", "ud"), {"arithmetic", "lambda"},
                                               median("of_overflow_law"), 0.998, 1.002);
                 return overflow && when;
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.10")},
            {"no other form overflows",
             [](Table const& t) {
                 return none(t.where("variant", {"potter", "carlson", "inverse_qr", "qr", "gentleman", "extended_qr"}),
                             "nonfinite");
             },
             own_result("first edition, set after its run")},
            {"the other roots of P stop growing: P settles between u^-1.5 and u^-2.2",
             [](Table const& t) {
                 return within(t.where("variant", {"carlson", "inverse_qr"}), {"arithmetic", "lambda", "variant"},
                               median("growth"), 1.5, 2.2);
             },
             own_result("first edition, set after its run")},
            {"potter is lost at none of these, or only by an exactly singular root after P has grown to u^-1.5",
             [](Table const& t) {
                 Table const potter = t.where("variant", "potter");
                 Judgement const found = within(potter, {"arithmetic", "lambda"}, median("growth"), 1.5, 2.2);
                 return labelled(fmt::format("{} of {} singular, P at u^-x, x",
                                             potter.where("outcome", "indefinite").rows().size(), potter.rows().size()),
                                 found);
             },
             own_result("first edition, set after its run")},
        },
};

}  // namespace rlslab::studies
