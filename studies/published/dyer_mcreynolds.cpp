// Dyer & McReynolds' measurement problem as Grewal & Andrews sweep it: which form keeps how many digits as the rows
// become parallel.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/breakdown.hpp>

#include <cmath>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

/// H = [1 1 1; 1 1 1 + delta], noise delta^2, P0 = I, with P scaled by delta^-2 so that the noise is 1. All variants in
/// one trial: the published figure divides each error by a number that depends on Carlson's.
void measure(Trial const& trial, TrialOutput& out) {
    double const delta = trial.number("delta");
    Records const records{
        .psi = Eigen::MatrixXd{{1.0, 1.0}, {1.0, 1.0}, {1.0, 1 + delta}}, .y = Vector<double>::Zero(2), .names = {}};
    Problem<double> const problem{.size = 3, .prior = Prior<double>{.variance = 1 / (delta * delta)}};
    CertifiedSolution const exact = std::move(certified(problem, records, {2}).front());
    Matrix<Reference> const P = exact.covariance();
    double const norm = frobenius(P), last = static_cast<double>(P(2, 2));
    auto const run = [&](std::string const& variant) {
        auto filter = trial.entry(variant).make(problem, Seed{1});
        process_rows(*filter, records, 0, 2);
        return filter;
    };
    double const carlson = errors(*run("carlson"), exact).covariance * norm;
    for (Cell const& variant : joined(row_forms(), {"qr_block"})) {
        std::string const& name = std::get<std::string>(variant);
        auto const filter = run(name);
        double const error = errors(*filter, exact).covariance;  // infinite where P cannot be had
        Health const broken = breakdown(*filter, *trial.entry(name).arithmetic);
        out({name, error, error * norm / correctly::hypot(carlson, last), std::string(name_of(broken))});
    }
}

std::vector<std::string> const P_forms = words(covariance_forms());
std::vector<std::string> const factors = words(joined(factor_forms(), {"qr_block"}));
std::vector<std::string> const rows_by_one = words(factor_forms());
Table between(Table const& t, double from, double to) {
    return t.where("delta", [=](double d) { return from * 0.999 <= d && d <= to * 1.001; });  // rounded powers of ten
}
Judgement slopes(Table const& t, std::vector<std::string> const& variants, double from, double to) {
    return within(between(t, 1e-6, 1e-2).where("variant", variants), {"variant"}, slope("delta", "error"), from, to);
}

}  // namespace

extern Study const dyer_mcreynolds;
Study const dyer_mcreynolds{
    .name = "dyer_mcreynolds",
    .question = "How many digits does each form keep of Dyer and McReynolds' problem?",
    .source =
        "Dyer & McReynolds 1969 (cited, not read); Grewal & Andrews (their MATLAB script of the figure was read); "
        "docs/theory.md 54; an earlier experiment (docs/literature.md 3.4)",
    .formula =
        R"tex(H = \begin{pmatrix} 1 & 1 & 1 \\ 1 & 1 & 1 + \delta \end{pmatrix},\ R = \delta^2 I,\ P_0 = I: \qquad
\lVert \hat P - P \rVert_F / \lVert P \rVert_F \approx u / \delta^2 \text{ (P forms)}, \quad
u / \delta \text{ (factor forms)})tex",
    .interpretation =
        "Covariance forms lose two digits a decade and have none left at delta = sqrt(u), Joseph's among them; factor "
        "forms lose one. Below sqrt(u) the covariance forms stand at 0.2, a wrong P that no longer depends on delta; "
        "Joseph's products do not, since s is then all rounding error and nothing bounds A P A'. Joseph's P is also "
        "the first to be indefinite. The reference is exact for the stored 1 + delta and 1 / delta^2: against it ud "
        "and gentleman become better again below 1e-10 (about delta / 4), where the u / delta of docs/literature.md "
        "3.4 is the rounding of 1 + delta, which no filter can undo. The published script adds each squared error to "
        "Carlson's sum in place of its own when it forms ||P||, so its norm is P33 and its errors are plotted 2.5 "
        "times too large; column as_published repeats that.",
    .data = "Dyer and McReynolds' two rows, d = 3",
    .factors =
        [](Budget) {
            return std::vector<Factor>{{"delta", powers(10, -1, -15, 0.125)}};
        },
    .measures = {"variant", "error", "as_published", "outcome"},
    .measure = measure,
    .plots = {{.title = "Covariance forms",
               .x = "delta",
               .y = "error",
               .x_label = "δ",
               .y_label = "relative error of P",
               .where = {{"variant", words(joined(covariance_forms(), {"information"}))}},
               .guides = {{"u/δ²", [](double d) { return 0x1p-53 / (d * d); }}}},
              {.title = "Factor forms",
               .x = "delta",
               .y = "error",
               .x_label = "δ",
               .y_label = "relative error of P",
               .where = {{"variant", factors}},
               .guides = {{"u/δ", [](double d) { return 0x1p-53 / d; }}}}},
    .claims =
        {
            {"P forms: slope of log error against log delta -2.0 +- 0.2 over 1e-2 ... 1e-6",
             [](Table const& t) { return slopes(t, P_forms, -2.2, -1.8); },
             reproduction("set with the earlier experiment, docs/literature.md 3.4")},
            {"factor forms: -1.0 +- 0.2", [](Table const& t) { return slopes(t, factors, -1.2, -0.8); },
             reproduction("set with the earlier experiment, docs/literature.md 3.4")},
            {"factor forms keep an error below 1e-6 at delta = 1e-9, and row by row below 2 u / delta from 1e-1 to "
             "1e-15",
             [](Table const& t) {
                 Judgement const at =
                     within(between(t, 1e-9, 1e-9).where("variant", factors), {"variant"}, greatest("error"), 0, 1e-6);
                 Statistic const in_law = [](Table const& row) {
                     return row.number("error") * row.number("delta") * 0x1p53;
                 };
                 Judgement const law = within(t.where("variant", rows_by_one), {"variant", "delta"}, in_law, 0, 2);
                 return at && labelled("of u / delta", law);
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.4")},
            {"P forms other than Joseph's products saturate at 0.2 +- 0.06: the median over delta = 1e-10 ... 1e-15, "
             "and no error above 0.3",
             [](Table const& t) {
                 std::vector<std::string> const saturating = words(subtracting_forms());
                 Table const small = between(t, 1e-15, 1e-10).where("variant", saturating);
                 Judgement const middle = within(small, {"variant"}, median("error"), 0.14, 0.26);
                 Judgement const most = within(small, {"variant"}, greatest("error"), 0, 0.3);
                 return labelled("median", middle) && labelled("greatest", most);
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.4")},
            {"Joseph's products do not saturate: the largest error below delta = 1e-10 exceeds 1e4",
             [](Table const& t) {
                 return within(between(t, 1e-15, 1e-10).where("variant", "joseph"), {}, greatest("error"), 1e4, 1e300);
             },
             own_result("first edition, set after its run")},
            {"joseph is indefinite at a delta at least 10 times as large as any at which conventional is",
             [](Table const& t) {
                 Table const bad = t.where("outcome", "indefinite");
                 Statistic const first = greatest("delta");
                 double const joseph = first(bad.where("variant", "joseph")),
                              conventional = first(bad.where("variant", "conventional"));
                 return Judgement{joseph >= 10 * conventional, fmt::format("{:.3g} and {:.3g}", joseph, conventional)};
             },
             own_result("first edition, set after its run")},
            {"factor forms are positive definite at every delta",
             [](Table const& t) { return everywhere(t.where("variant", factors), "outcome", "sound"); },
             reproduction("earlier experiment, docs/literature.md 3.4")},
            {"information: slope -2.0 +- 0.2, and not positive definite at any delta of 1e-8 or less",
             [](Table const& t) {
                 Judgement const line = slopes(t, {"information"}, -2.2, -1.8);
                 Table const small = between(t, 1e-15, 1e-8).where("variant", "information");
                 size_t const sound = small.where("outcome", "sound").rows().size();
                 return labelled("slope", line) &&
                        Judgement(sound == 0, fmt::format("{} of {} sound", sound, small.rows().size()));
             },
             own_result("docs/theory.md 50, and 54: delta^2 below u; in place of a band set after its run")},
            {"the published figure's errors are 2.50 +- 0.02 times the relative errors (delta = 1e-2 ... 1e-12)",
             [](Table const& t) {
                 Table const rows = between(t, 1e-12, 1e-2).where("error", [](double e) { return e < 1e300; });
                 Statistic const ratio = [](Table const& row) {
                     return row.number("as_published") / row.number("error");
                 };
                 return within(rows, {"variant", "delta"}, ratio, 2.48, 2.52);
             },
             reproduction("the published script, docs/literature.md 3.4")},
        },
};

}  // namespace rlslab::studies
