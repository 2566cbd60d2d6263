// Nothing is forgotten: how the errors of theta and P grow with the number of rows.
#include <rlslab/studies/checkpoints.hpp>
#include <rlslab/studies/judgements.hpp>

#include <cmath>

namespace rlslab::studies {
namespace {

constexpr Index size = 4;

/// Errors in units of u after 1, 2, 4 ... rows. The noise is as large as the signal, so that steps K e of a float's
/// theta stay above its resolution to the end: with little noise theta stops, and so does its error.
void measure(Trial const& trial, TrialOutput& out) {
    CatalogueEntry const& entry = trial.entry(trial.text("variant"), trial.text("arithmetic"));
    double const u = entry.arithmetic->unit_roundoff();
    Problem<double> const problem =
        as_stored({.size = size, .prior = Prior<double>{.variance = 128}}, *entry.arithmetic);
    std::vector<Index> steps;
    for (Index k = 1; k <= (trial.full() ? Index{1} << 20 : Index{1} << 14); k *= 2) steps.push_back(k);
    Records const records = as_stored(white(size, steps.back(), trial.seed({"replicate"}), 1.0), *entry.arithmetic);
    auto const filter = entry.make(problem, Seed{1});
    at_each(certified(problem, records, steps), *filter, records, [&](CertifiedSolution const& exact) {
        Errors const error = errors(*filter, exact);
        out({double(exact.step()), error.theta / u, error.covariance / u});
    });
}

std::vector<std::string> const corrected = words(corrected_forms());

/// After the prior is forgotten, which a large one costs the covariance forms tens of u.
constexpr double prior_forgotten = 256;

/// The exponent of the rms over replicates, and over variants where several are in the table.
Statistic growth_of(std::string y) {
    return [y](Table const& t) {
        Table means({"rows", "rms"});
        for (Cell const& k : t.distinct("rows"))
            if (std::get<double>(k) >= prior_forgotten) means.add({k, root_mean_square(y)(t.where("rows", k))});
        return slope("rows", "rms")(means);
    };
}
/// The rms of a column over what it may be at that row.
Statistic over(std::string y, double (*law)(double rows)) {
    return {[=](Table const& at) { return root_mean_square(y)(at) / law(median("rows")(at)); }, Estimate::quadratic};
}
Selection const late = where("rows", at_least(1024));

}  // namespace

extern Study const accuracy_steps{
    .name = "accuracy_steps",
    .question = "How do the errors grow with the number of rows when nothing is forgotten?",
    .source =
        "Ardalan 1986 (abstract read: exponential divergence may occur); A note on the error propagation analysis of "
        "recursive least squares algorithms (abstract read: bounded), which corrects Ljung & Ljung 1985 and Verhaegen "
        "1989; the law is derived (docs/theory.md 38); an earlier experiment (docs/literature.md 3.8)",
    .formula =
        R"tex(\delta\theta_k = (I - K\psi^\top)\,\delta\theta_{k-1} + r_k, \quad |r_k| \sim u\,\|\theta\| \qquad
              \|\delta\theta_N\|_{\mathrm{rms}} = c\,u\,\|\theta\|\sqrt{N/3})tex",
    .interpretation =
        "On white regressors I - K psi' averages to 1 - 1/k, so that N roundings of theta add up to sqrt(N/3) of one, "
        "c as docs/theory.md 38 has it: the root law holds to 10^6 rows in float and double, and nothing grows "
        "exponentially. P does not follow one law. conventional keeps its first asymmetry while P shrinks, which is "
        "linear growth. inverse_qr and carlson drift (study delta_forms): linear in float from 10^3 rows, so "
        "that a run's first part has another slope, and in double from 10^5, where the earlier experiment "
        "(docs/literature.md 3.8) ended. In float beyond 10^5 "
        "rows, N u > 1/100, rows vanish beside what is summed, and the information forms grow faster than the root, "
        "their theta with them. extended_qr's theta is not corrected by its own innovation.",
    .data = "white rows, d = 4, noise as large as the signal",
    .factors = {{"arithmetic", {"float", "double"}}, {"variant", row_forms()}, {"replicate", counted(20)}},
    .measures = {"rows", "theta_error", "covariance_error"},
    .measure = measure,
    .plots = {{.title = "Error of theta",
               .x = "rows",
               .y = "theta_error",
               .panel = "arithmetic",
               .y_label = "relative error of theta / u",
               .guides = {{"0.46 sqrt(N/3)", [](double n) { return 0.46 * std::sqrt(n / 3); }}}},
              {.title = "Error of P",
               .x = "rows",
               .y = "covariance_error",
               .panel = "arithmetic",
               .y_label = "relative error of P / u",
               .guides = {{"N/4", [](double n) { return n / 4; }}}}},
    .claims = {
        {"theta of the forms that correct it: the rms error grows with exponent 0.5 +- 0.1 from 256 rows on, in "
         "float and double",
         within(where("variant", corrected), {"arithmetic"}, growth_of("theta_error"), 0.4, 0.6),
         reproduction("set with the earlier experiment, docs/literature.md 3.8")},
        {"its size from 1024 rows on: c = rms / (u sqrt(N/3)) in 0.25 ... 0.75 at every power of two",
         within(late.where("variant", corrected), {"arithmetic", "rows"},
                over("theta_error", [](double n) { return std::sqrt(n / 3); }), 0.25, 0.75),
         own_result("docs/theory.md 38")},
        {"no exponential growth: from 1024 rows on no theta but the conventional form's is wrong by more than 0.25 N u",
         within(
             late.where("variant", words(joined(corrected_forms(), {"qr", "gentleman", "extended_qr", "information"}))),
             {"arithmetic", "variant", "rows"}, over("theta_error", [](double n) { return n; }), 0, 0.25),
         own_result("first edition, set after its run")},
        {"the conventional form's P: exponent 1.00 +- 0.05 in double",
         within(where("arithmetic", "double").where("variant", "conventional"), {}, growth_of("covariance_error"), 0.95,
                1.05),
         own_result("docs/theory.md 28, law ii")},
        {"inverse_qr's P in float: the drift is linear, exponent 1.0 +- 0.1",
         within(where("arithmetic", "float").where("variant", "inverse_qr"), {}, growth_of("covariance_error"), 0.9,
                1.1),
         own_result("docs/theory.md 45, in place of a band set after its run")},
        {"P in double of the forms without a drift: at most sqrt(N) u from 1024 rows on, but for the constant 2",
         within(late.where("arithmetic", "double")
                    .where("variant", {"conventional_two_sided", "symmetric", "joseph", "joseph_rank_two", "potter",
                                       "ud", "qr", "gentleman", "information"}),
                {"variant", "rows"}, over("covariance_error", [](double n) { return std::sqrt(n); }), 0, 2),
         own_result("first edition, set after its run")}}};

}  // namespace rlslab::studies
