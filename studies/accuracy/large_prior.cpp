// One row after a large prior: the variance that comes out, and when it is nothing.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

void measure(Trial const& trial, TrialOutput& out) {
    CatalogueEntry const& entry = trial.entry(trial.text("variant"), trial.text("arithmetic"));
    Problem<double> const problem =
        as_stored({.size = 1, .prior = Prior<double>{.variance = trial.number("variance")}}, *entry.arithmetic);
    auto const filter = entry.make(problem, Seed{1});
    filter->update(Vector<double>(Vector<double>::Ones(1)), 1);
    // Exactly P0 / (1 + P0), but for Reference's own 2^-257.
    Reference const P0 = problem.prior->variance, P = covariance_of(filter->stored())(0, 0),
                    error = abs(P * (1 + P0) / P0 - 1);
    out({static_cast<double>(P), static_cast<double>(error), P == 0 ? "zero" : "positive"});
}

std::vector<std::string> const subtracting = words(subtracting_forms());
std::vector<std::string> const others = words(without(row_forms(), joined(subtracting_forms(), {"potter"})));

/// P_1 is 0 exactly from this variance on.
Judgement zero_from(Table const& t, std::string const& arithmetic, double variance) {
    Table const at = t.where("arithmetic", arithmetic).where("variant", subtracting);
    Judgement const a = everywhere(at.where("variance", [=](double v) { return v < variance; }), "outcome", "positive");
    Judgement const b = everywhere(at.where("variance", [=](double v) { return v >= variance; }), "outcome", "zero");
    return labelled(arithmetic + " before", a) && labelled("from there on", b);
}
Table of(Table const& t, std::string const& arithmetic, std::vector<std::string> const& variants) {
    return t.where("arithmetic", arithmetic).where("variant", variants);
}

}  // namespace

extern Study const large_prior;
Study const large_prior{
    .name = "large_prior",
    .question = "How large may the prior variance be before one row leaves nothing of P?",
    .source = "derived (docs/theory.md 41); an earlier experiment (docs/literature.md 3.8)",
    .formula =
        R"tex(P_1 = P_0 - \frac{P_0^2}{1 + P_0} = \frac{P_0}{1 + P_0}, \qquad
              \mathrm{fl}\left(\frac{P_0}{1+P_0}\right) = 1 \text{ for } P_0 \gtrsim 1/u)tex",
    .interpretation =
        "One row psi = 1. The forms that subtract K f from P lose u P0 of the 1 that should remain, and everything "
        "once K rounds to 1: a first P of exactly 0, after which the filter learns no more. joseph_rank_two subtracts "
        "too and is no better. Joseph's products are: their (1 - K)^2 P vanishes but K^2 stays. Factors and P^-1 have "
        "no such place. Potter's form subtracts within the root, loses u sqrt(P0) and more, and is lost to zero or "
        "worse beyond 1/u^2. Doubles allow a 'diffuse' prior of 1e12, floats hardly one of 1e4.",
    .data = "psi = 1, d = 1",
    .factors =
        [](Budget) {
            return std::vector<Factor>{{"arithmetic", {"bfloat16", "binary16", "float", "double"}},
                                       {"variant", row_forms()},
                                       {"variance", powers(10, 0, 20)}};
        },
    .admits =
        [](Trial const& trial) { return trial.text("arithmetic") != "binary16" || trial.number("variance") < 65504; },
    .measures = {"P", "error", "outcome"},
    .measure = measure,
    .plots = {{.title = "Error of P after one row",
               .x = "variance",
               .y = "error",
               .panel = "arithmetic",
               .x_label = "variance of the prior",
               .y_label = "relative error of P"}},
    .claims =
        {
            {"the subtracting forms: P_1 = 0 exactly from P0 = 1e16 on in double and 1e8 in float",
             [](Table const& t) {
                 Judgement const a = zero_from(t, "double", 1e16), b = zero_from(t, "float", 1e8);
                 return a && b;
             },
             reproduction("earlier experiment, docs/literature.md 3.8")},
            {"the same from 1e3 on in bfloat16 and from 1e4 in binary16",
             [](Table const& t) {
                 Judgement const a = zero_from(t, "bfloat16", 1e3), b = zero_from(t, "binary16", 1e4);
                 return a && b;
             },
             own_result("docs/theory.md 41")},
            {"before that their error is u P0 to a factor of 3: at most 3 u P0 + 2 u",
             [](Table const& t) {
                 Table const at = t.where("outcome", "positive")
                                      .where("variant", subtracting)
                                      .where("arithmetic", {"float", "double"});
                 Statistic const worst = [](Table const& rows) {
                     double const u =
                         std::get<std::string>(rows.distinct("arithmetic").front()) == "float" ? 0x1p-24 : 0x1p-53;
                     double most = 0;
                     std::vector<double> const variance = rows.numbers("variance"), error = rows.numbers("error");
                     for (size_t i = 0; i < error.size(); ++i)
                         most = std::max(most, error[i] / (3 * u * variance[i] + 2 * u));
                     return most;
                 };
                 return within(at, {"arithmetic", "variant"}, worst, 0, 1);
             },
             own_result("docs/theory.md 41, in place of a band set after its run")},
            {"joseph and every factor and information form but potter: P_1 to 5 u at every prior up to 1e20",
             [](Table const& t) {
                 Judgement const a = within(of(t, "double", others), {"variant"}, greatest("error"), 0, 5 * 0x1p-53);
                 Judgement const b = within(of(t, "float", others), {"variant"}, greatest("error"), 0, 5 * 0x1p-24);
                 return a && b;
             },
             own_result("first edition, set after its run")},
        },
};

}  // namespace rlslab::studies
