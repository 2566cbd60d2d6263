// Two matrices every author uses: Hilbert's, row by row, and Läuchli's, whose normal equations lose delta^2.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>

#include <cmath>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

/// Hilbert's matrix of 2n x n, entries rounded once, or Läuchli's of (1, 1, 1) and delta I; theta = (1, ..., 1) but for
/// y's rounding.
Records rows_of(std::string const& matrix, double parameter) {
    bool const hilbert = matrix == "hilbert";
    Index const size = hilbert ? Index(parameter) : 3, rows = hilbert ? 2 * size : 4;
    Records out{.psi = Matrix<double>::Zero(size, rows), .y = Vector<double>::Zero(rows), .names = {}};
    for (Index k = 0; k < rows; ++k)
        for (Index i = 0; i < size; ++i) {
            out.psi(i, k) = hilbert ? 1 / double(i + k + 1) : k == 0 ? 1 : k == i + 1 ? parameter : 0;
            out.y[k] += out.psi(i, k);
        }
    return out;
}

void measure(Trial const& trial, TrialOutput& out) {
    CatalogueEntry const& entry = trial.entry(trial.text("variant"));
    Records const records = rows_of(trial.text("matrix"), trial.number("parameter"));
    // A prior variance of 1e20 changes theta by less than binary64 can represent here.
    Problem<double> const problem{.size = records.parameters(), .prior = Prior<double>{.variance = 1e20}};
    auto const filter = entry.make(problem, Seed{1});
    process_rows(*filter, records, 0, records.rows());
    CertifiedSolution const exact = certified(problem, records, {records.rows()}).front();
    double const digits = exact.theta_digits_worst(filter->theta());
    double const worst = digits == digits ? correctly::pow(10, -digits) : INFINITY;
    double const kappa = condition(records, 1);
    out({kappa, worst, worst / (kappa * 0x1p-53), errors(*filter, exact).covariance, worst < 1 ? "solved" : "lost"});
}

std::vector<std::string> const factors = words(factor_forms());
std::vector<std::string> const covariances = words(covariance_forms());
Table of(Table const& t, std::string const& matrix) { return t.where("matrix", matrix); }

}  // namespace

extern Study const hilbert;
Study const hilbert{
    .name = "hilbert",
    .question = "What do the two classical ill-conditioned matrices leave of theta?",
    .source =
        "Läuchli 1961 (cited, not read); Sjö 1992, section 5.2 (first chapter read; its table was not at hand); an "
        "earlier experiment (docs/literature.md 3.6)",
    .formula =
        R"tex(A_{ij} = \frac{1}{i+j-1} \qquad\text{and}\qquad
              A = \begin{pmatrix} 1 & 1 & 1 \\ \delta & & \\ & \delta & \\ & & \delta \end{pmatrix})tex",
    .interpretation =
        "Both are solved in double after a prior of variance 1e20. On Hilbert's matrix every factor form stays within "
        "3 kappa u; the forms that store P still find theta of these nearly consistent rows, but of their P no digit "
        "is left: a prior of 1e20 u is as large as all they know (study large_prior). The normal equations lose theta "
        "where kappa^2 u > 1. Läuchli's rows are harmless to all but the normal equations, which lose delta^2 beside 1 "
        "at the first decade with delta^2 < u. The 5.1 digits at n = 10 in docs/literature.md 3.6, the same for four "
        "variants, are the rounding of y (kappa u = 3e-5), which a reference for the stored data does not charge to "
        "them: here they keep 6.5 and more.",
    .data = "Hilbert's and Läuchli's matrices",
    .factors =
        [](Budget) {
            return std::vector<Factor>{
                {"matrix", {"hilbert", "laeuchli"}},
                {"variant", row_forms()},
                {"parameter", joined({2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0}, powers(10, -1, -12))}};
        },
    .admits = [](Trial const& trial) { return (trial.text("matrix") == "hilbert") == (trial.number("parameter") > 1); },
    .measures = {"kappa", "theta_error", "per_kappa_u", "covariance_error", "outcome"},
    .measure = measure,
    .plots = {{.title = "Hilbert's matrix: the worst component of theta",
               .x = "kappa",
               .y = "theta_error",
               .x_label = "condition number",
               .y_label = "relative error of theta",
               .where = {{"matrix", {"hilbert"}}},
               .guides = {{"kappa u", [](double kappa) { return kappa * 0x1p-53; }}}},
              {.title = "Läuchli's matrix: the worst component of theta",
               .x = "parameter",
               .y = "theta_error",
               .x_label = "delta",
               .y_label = "relative error of theta",
               .where = {{"matrix", {"laeuchli"}}},
               .floor = 1e-20}},
    .claims =
        {
            {"Hilbert, n = 2 ... 10, factor forms: theta to 3 kappa u",
             [](Table const& t) {
                 return within(of(t, "hilbert").where("variant", factors), {"variant"}, greatest("per_kappa_u"), 0, 3);
             },
             own_result("first edition, set after its run")},
            {"Hilbert, n >= 3, a prior of 1e20: no digit of P is right in a form that stores it, 6.5 and more in every "
             "factor form",
             [](Table const& t) {
                 Table const at = of(t, "hilbert").where("parameter", [](double n) { return n >= 3; });
                 Judgement const a =
                     within(at.where("variant", covariances), {"variant"}, least("covariance_error"), 0.1, 1e99);
                 Judgement const b =
                     within(at.where("variant", factors), {"variant"}, greatest("covariance_error"), 0, 3.2e-7);
                 return a && b;
             },
             own_result("first edition, set after its run")},
            {"Hilbert, information: theta is found to n = 7 and lost from n = 8, kappa^2 u = 47, on",
             [](Table const& t) {
                 Table const at = of(t, "hilbert").where("variant", "information");
                 Judgement const a =
                     everywhere(at.where("parameter", [](double n) { return n < 8; }), "outcome", "solved");
                 Judgement const b =
                     everywhere(at.where("parameter", [](double n) { return n >= 8; }), "outcome", "lost");
                 return a && b;
             },
             reproduction("earlier experiment, docs/literature.md 3.6")},
            {"Läuchli, information: lost exactly from delta = 1e-8 on, the first decade with delta^2 < 2^-53",
             [](Table const& t) {
                 Table const at = of(t, "laeuchli").where("variant", "information");
                 Judgement const a =
                     everywhere(at.where("parameter", [](double d) { return d * d >= 0x1p-53; }), "outcome", "solved");
                 Judgement const b =
                     everywhere(at.where("parameter", [](double d) { return d * d < 0x1p-53; }), "outcome", "lost");
                 return a && b;
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.6")},
            {"Läuchli, every other variant: 15 digits of theta at every delta down to 1e-12",
             [](Table const& t) {
                 Table const others = of(t, "laeuchli").where("variant", words(without(row_forms(), {"information"})));
                 return within(others, {"variant"}, greatest("theta_error"), 0, 1e-15);
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.6")},
        },
};

}  // namespace rlslab::studies
