// Bierman's two parameters: an accurate first measurement, a nearly parallel second one, and a variance below zero.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/catalogue/breakdown.hpp>

#include <cmath>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

/// psi = (1, eps), (1, 1) with unit noise and P0 = I / eps^2; eps = 2^-k or 1.0737 2^-k, as 1e-9 is, in the bits of the
/// arithmetic.
void measure(Trial const& trial, TrialOutput& out) {
    CatalogueEntry const& entry = trial.entry(trial.text("variant"), trial.text("arithmetic"));
    double const odd = 1e-9 * 0x1p30, k = trial.number("power");
    double const eps = entry.arithmetic->round(std::ldexp(trial.text("eps") == "2^-k" ? 1.0 : odd, -int(k)));
    Problem<double> const problem =
        as_stored({.size = 2, .prior = Prior<double>{.variance = 1 / (eps * eps)}}, *entry.arithmetic);
    Records const records{.psi = Eigen::MatrixXd{{1.0, 1.0}, {eps, 1.0}}, .y = Vector<double>::Zero(2), .names = {}};
    auto const filter = entry.make(problem, Seed{1});
    process_rows(*filter, records, 0, 2);
    double const u = entry.arithmetic->unit_roundoff(),
                 error = errors(*filter, certified(problem, records, {2}).front()).covariance;
    Health const broken = breakdown(*filter, *entry.arithmetic);
    double const variance = static_cast<double>(covariance_of(filter->stored())(0, 0));
    out({eps, error, error / u, error * eps / u, variance,
         variance < 0   ? "negative"
         : variance > 0 ? "positive"
                        : "zero",
         std::string(name_of(broken)), entry.arithmetic->round(1 + eps * eps) == 1 ? "lost" : "seen"});
}

std::vector<std::string> const triangular = words(triangular_forms());
Selection of(char const* arithmetic, char const* eps, char const* variant) {
    return where("variant", variant).where("arithmetic", arithmetic).where("eps", eps);
}

/// The variance is positive up to 2^-last and negative from there on.
Judge flips(char const* arithmetic, double last, std::vector<std::string> const& variants) {
    Selection const rows = where("arithmetic", arithmetic).where("eps", "2^-k").where("variant", variants);
    return labelled("up to it", everywhere(rows.where("power", at_most(last)), "sign", "positive")) &&
           labelled("beyond", everywhere(rows.where("power", above(last)), "sign", "negative"));
}
Judgement variances_of_the_flip(Table const& rows) {
    double const before = rows.where("power", 26.0).number("variance"),
                 after = rows.where("power", 27.0).number("variance");
    bool const holds = std::abs(before - 1.0000000298) < 1e-10 && std::abs(after + 1.0000000149) < 1e-10;
    return {holds, fmt::format("{:.11g}, {:.11g}", before, after)};
}
Judgement products_lose_digits(Table const& rows) {
    double const near = rows.where("power", 30.0).number("error_u"), far = rows.where("power", 47.0).number("error_u");
    return {near <= 30 && far >= 1e11, fmt::format("{:.3g} u, {:.3g} u", near, far)};
}
std::vector<std::string> const others{"conventional_two_sided", "symmetric", "joseph_rank_two"};

}  // namespace

extern Study const bierman{
    .name = "bierman",
    .question = "At which epsilon does a variance turn negative in Bierman's example?",
    .source =
        "Bierman 1977, ch. V (cited, not read); Tapley, Schutz & Born (abstract read); the example: docs/theory.md 54; "
        "an earlier experiment (docs/literature.md 3.3)",
    .formula = R"tex(\psi_1 = (1, \varepsilon),\ \psi_2 = (1, 1),\ P_0 = \varepsilon^{-2} I: \quad
P_2 = \frac{1}{\beta} \begin{pmatrix} 1 + 2 \varepsilon^2 & -1 - \varepsilon \\
-1 - \varepsilon & 2 + \varepsilon^2 \end{pmatrix}, \quad
\beta = 1 - 2 \varepsilon + 4 \varepsilon^2 + 2 \varepsilon^4)tex",
    .interpretation =
        "Where 1 + eps^2 rounds to 1 the first row leaves a P of rank one, and the second turns the first variance of "
        "the conventional forms from +1 to -1, in one step of epsilon. So does joseph_rank_two, which equals Joseph's "
        "form in exact arithmetic: what protects is the evaluation as products, not the formula. Those products keep "
        "30 u at every power of two, where many of the roundings are exact; at other epsilon only down to about 1e-10 "
        "in double, and below that they lose digits too (1e12 u at 8e-15). Potter's error is u / eps, and below 4 eps "
        "beyond its jump, where eps^2 is lost, at powers of two only. The other factor forms, and here even the normal "
        "equations, stay within 8 u.",
    .data = "Bierman's two rows",
    .factors = {{"arithmetic", {"float", "double"}},
                {"eps", {"2^-k", "1.07 2^-k"}},
                {"variant", row_forms()},
                {"power", counted(48)}},
    .admits =
        [](Trial const& trial) { return trial.number("power") <= (trial.text("arithmetic") == "float" ? 22 : 48); },
    .measures = {"epsilon", "error", "error_u", "error_u_eps", "variance", "sign", "outcome", "square"},
    .measure = measure,
    .plots = {{.title = "Error of P after the two rows, ε = 2^-k",
               .x = "epsilon",
               .y = "error",
               .panel = "arithmetic",
               .x_label = "ε",
               .y_label = "relative error of P",
               .where = {{"eps", {"2^-k"}}},
               .guides = {{"4ε", [](double e) { return 4 * e; }}},
               .floor = 1e-20},
              {.title = "The same with ε = 1.07 2^-k",
               .x = "epsilon",
               .y = "error",
               .panel = "arithmetic",
               .x_label = "ε",
               .y_label = "relative error of P",
               .where = {{"eps", {"1.07 2^-k"}}}},
              {.title = "First variance of P",
               .x = "epsilon",
               .y = "variance",
               .panel = "arithmetic",
               .log = "x",
               .x_label = "ε",
               .y_label = "computed variance (exactly about 1 + 2ε)",
               .where = {{"eps", {"2^-k"}}, {"variant", {"conventional", "symmetric", "joseph"}}}}},
    .claims = {
        {"double: conventional's first variance is positive up to eps = 2^-26 and negative from 2^-27 on",
         flips("double", 26, {"conventional"}), reproduction("earlier experiment, docs/literature.md 3.3")},
        {"float: positive up to eps = 2^-11 and negative from 2^-12 on", flips("float", 11, {"conventional"}),
         reproduction("earlier experiment, docs/literature.md 3.3")},
        {"conventional_two_sided, symmetric and joseph_rank_two flip at the same epsilon",
         labelled("double", flips("double", 26, others)) && labelled("float", flips("float", 11, others)),
         own_result("first edition, set after its run")},
        {"at eps = 2^-26 the conventional variance is 1.0000000298 and at 2^-27 it is -1.0000000149, to 1e-10 as "
         "in docs/literature.md 3.3",
         of("double", "2^-k", "conventional").judged(variances_of_the_flip),
         reproduction("earlier experiment, docs/literature.md 3.3")},
        {"joseph by products, power of two: error below 30 u at every eps, and never indefinite",
         within(where("variant", "joseph").where("eps", "2^-k"), {"arithmetic"}, greatest("error_u"), 0, 30) &&
             everywhere(where("variant", "joseph"), "outcome", "sound"),
         reproduction("set with the earlier experiment, docs/literature.md 3.3")},
        {"otherwise below 30 u at 1e-9 (double), but no longer at 1e-14: 1e11 u or more",
         of("double", "1.07 2^-k", "joseph").judged(products_lose_digits),
         own_result("first edition, set after its run")},
        {"ud, carlson, inverse_qr, qr, gentleman, extended_qr: error below 30 u at every eps of either kind",
         within(where("variant", triangular), {"variant", "arithmetic"}, greatest("error_u"), 0, 30),
         reproduction("set with the earlier experiment, docs/literature.md 3.3")},
        {"potter: error below 4 eps at powers of two beyond the flip (docs/literature.md 3.3 has 2 eps at 2^-30)",
         within(where("variant", "potter").where("eps", "2^-k").where("square", "lost"), {"arithmetic", "power"},
                number("error") / number("epsilon"), 0, 4),
         reproduction("set with the earlier experiment, docs/literature.md 3.3")},
        {"potter: error u / eps, to a factor of 3: below 3 u / eps at every eps of either kind",
         within(where("variant", "potter"), {"arithmetic", "eps"}, greatest("error_u_eps"), 0, 3),
         own_result("docs/theory.md 44, in place of a band set after its run")}}};

}  // namespace rlslab::studies
