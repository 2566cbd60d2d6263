// The rounding errors of the conventional form: after how many steps their antisymmetric part exceeds P.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/breakdown.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::studies {
namespace {

constexpr Index size = 4;
constexpr int horizon = 60000;

/// ||P - P'||_F / ||P + P'||_F of the bits stored; 0 for factors, which cannot be asymmetric.
double asymmetry(AnyFilter const& filter) {
    auto const stored = filter.stored();
    if (stored.form == Stored<Reference>::Form::factor) return 0;
    Matrix<Reference> const difference = stored.F - stored.F.transpose(), sum = stored.F + stored.F.transpose();
    return frobenius(difference) / frobenius(sum);
}

/// White rows until the filter itself says that it has broken down.
void measure(Trial const& trial, TrialOutput& out) {
    CatalogueEntry const& entry = trial.entry(trial.text("variant"), trial.text("arithmetic"));
    double const lambda = trial.number("lambda"),
                 predicted = correctly::log(entry.arithmetic->unit_roundoff()) / correctly::log(lambda);
    auto const filter =
        entry.make({.size = size, .forgetting = lambda, .prior = Prior<double>{.variance = 1}}, Seed{1});
    Seed seed = trial.seed({"replicate"});
    int const every = std::max(1, int(predicted / 40));
    for (int k = 1; k <= horizon; ++k) {
        Vector<double> psi(size);
        double y = 1e-3 * seed.bell();
        for (double& x : psi) x = seed.bell(), y += x;
        Health const health = filter->update(psi, y).health;
        bool const broken = health != Health::sound;
        if (broken || k == horizon) {
            Health const end = broken ? health : breakdown(*filter, *entry.arithmetic);
            return out({"end", double(k), double(k) / predicted, asymmetry(*filter), std::string(name_of(end))});
        }
        if (k % every == 0 && k <= 4 * predicted)
            out({"course", double(k), double(k) / predicted, asymmetry(*filter), "sound"});
    }
}

Table ends(Table const& t) { return t.where("record", "end"); }

}  // namespace

extern Study const asymmetry_explosion;
Study const asymmetry_explosion{
    .name = "asymmetry_explosion",
    .question = "When does the conventional form's asymmetry destroy it?",
    .source =
        "Verhaegen 1989, Haykin's Tri rule (cited, not read); derived (docs/theory.md 28, law ii; docs/theory.md 37); "
        "an earlier experiment (docs/literature.md 3.2)",
    .formula = R"tex(k_* = \frac{\ln(1/u)}{-\ln \lambda})tex",
    .interpretation =
        "Rows are white and exciting, nothing is disturbed but by rounding. The first rounding error leaves an "
        "asymmetry of order u, which grows as lambda^-k whatever the data; when it reaches the size of P itself gamma "
        "leaves (0, 1]. That is the law's k*, from 0.75 of it up: with lambda near 1 more steps' errors add up, so the "
        "end comes earlier. Computing the row psi'P on its own, mirroring one triangle, or Joseph's products keep the "
        "asymmetry at a few u and last for all 60 000 steps, as do the factor forms. (With lambda = 0.9 P itself "
        "fluctuates by more than the growth over the run, so the rate is claimed from 0.95 on.)",
    .data = "white rows, d = 4",
    .factors =
        [](Budget budget) {
            return std::vector<Factor>{{"arithmetic", {"float", "double"}},
                                       {"variant", joined(covariance_forms(), {"potter", "ud", "inverse_qr"})},
                                       {"lambda", {0.9, 0.95, 0.98, 0.99, 0.995}},
                                       {"replicate", counted(budget == Budget::full ? 20 : 11)}};
        },
    .measures = {"record", "steps", "ratio", "asymmetry", "outcome"},
    .measure = measure,
    .plots = {{.title = "First step that is not sound, conventional form",
               .x = "lambda",
               .y = "steps",
               .series = "arithmetic",
               .log = "y",
               .x_label = "forgetting factor",
               .y_label = "steps",
               .where = {{"record", {"end"}}, {"variant", {"conventional"}}},
               .guides = {{"ln(1/u) / -ln λ, float",
                           [](double l) { return correctly::log(0x1p-24) / correctly::log(l); }},
                          {"double", [](double l) { return correctly::log(0x1p-53) / correctly::log(l); }}}},
              {.title = "Asymmetry of P on the way, λ = 0.99",
               .x = "ratio",
               .y = "asymmetry",
               .panel = "arithmetic",
               .log = "y",
               .x_label = "steps / k*",
               .y_label = "‖P - P'‖ / ‖P + P'‖",
               .where = {{"record", {"course"}},
                         {"lambda", {"0.99"}},
                         {"variant", {"conventional", "conventional_two_sided", "joseph"}}}}},
    .claims =
        {
            {"from P0 = I conventional breaks down at 0.6 to 1.1 of ln(1/u) / -ln lambda, in most runs",
             [](Table const& t) {
                 Table const rows =
                     ends(t).where("variant", "conventional").where("steps", [](double k) { return k < horizon; });
                 if (rows.rows().size() != ends(t).where("variant", "conventional").rows().size())
                     return Judgement{false, "some run survived"};
                 Judgement const low = within(rows, {"arithmetic", "lambda"}, least("ratio"), 0.6, 1.1);
                 Judgement const high = within(rows, {"arithmetic", "lambda"}, greatest("ratio"), 0.6, 1.1);
                 return labelled("least", low) && labelled("greatest", high);
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.2")},
            {"all other forms survive 60 000 steps in most runs, and P is positive definite then (decided exactly)",
             [](Table const& t) {
                 std::vector<std::string> const others{
                     "conventional_two_sided", "symmetric", "joseph", "joseph_rank_two", "potter", "ud", "inverse_qr"};
                 return everywhere(ends(t).where("variant", others), "outcome", "sound");
             },
             reproduction("earlier experiment, docs/literature.md 3.2")},
            {"conventional_two_sided and joseph keep their asymmetry below 16 u at every step looked at, in most runs",
             [](Table const& t) {
                 Table const rows = t.where("variant", {"conventional_two_sided", "joseph"});
                 Statistic const most = greatest("asymmetry");
                 Judgement const in_float =
                     within(rows.where("arithmetic", "float"), {"variant"}, most, 0x1p-30, 0x1p-20);
                 Judgement const in_double =
                     within(rows.where("arithmetic", "double"), {"variant"}, most, 0x1p-60, 0x1p-49);
                 return in_float && in_double;
             },
             own_result("first edition, set after its run")},
            {"symmetric and joseph_rank_two have none at all",
             [](Table const& t) {
                 return everywhere(t.where("variant", {"symmetric", "joseph_rank_two"}), "asymmetry", 0.0,
                                   Estimate::proven);
             },
             verification("the formulas: one triangle is mirrored").by("one triangle is mirrored")},
            {"conventional: the logarithm of its asymmetry grows by -ln lambda a step, to 10 % (lambda >= 0.95, from "
             "0.2 to 0.6 of k*)",
             [](Table const& t) {
                 Table const course = t.where("record", "course").where("variant", "conventional");
                 Table const middle =
                     course.where("lambda", [](double l) { return l > 0.94; }).where("ratio", [](double r) {
                         return 0.2 < r && r < 0.6;
                     });
                 return within(
                     middle, {"arithmetic", "lambda"},
                     [](Table const& rows) {
                         auto const k = rows.numbers("steps"), a = rows.numbers("asymmetry"),
                                    lambda = rows.numbers("lambda");
                         return correctly::log(a.back() / a.front()) / (k.back() - k.front()) /
                                -correctly::log(lambda[0]);
                     },
                     0.9, 1.1);
             },
             own_result("docs/theory.md 37")},
        },
};

}  // namespace rlslab::studies
