// Where to start: from c^2 I, or from a batch estimate of the first rows.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/catalogue/breakdown.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::studies {
namespace {

constexpr Index size = 5, rows = 300;
constexpr double kappa = 1000, noise = 1e-4;

/// theta and P after the first `first` rows, exact, rounded once to double: the prior that a batch program would hand
/// over.
Prior<double> from_batch(Problem<double> const& problem, Records const& records, Index first) {
    CertifiedSolution const exact = certified(problem, records, {first}, 40).front();
    Matrix<double> P(size, size);
    Matrix<Reference> const covariance = exact.covariance();
    for (Index j = 0; j < size; ++j)
        for (Index i = 0; i <= j; ++i) P(i, j) = P(j, i) = static_cast<double>(covariance(i, j));
    Vector<double> theta(size);
    for (Index i = 0; i < size; ++i) theta[i] = static_cast<double>(exact.theta()[i]);
    return {.theta = theta, .covariance = P};
}

/// After all rows, against least squares without a prior.
void measure(Trial const& trial, TrialOutput& out) {
    Records const records = graded(size, rows, kappa, trial.seed({"replicate"}), noise);
    Problem<double> const without{.size = size, .forgetting = trial.number("lambda"), .prior = std::nullopt};
    CertifiedSolution const exact = certified(without, records, {rows}).front();
    bool const batch = trial.text("start") == "batch";
    Index const first = batch ? Index(trial.number("amount")) : 0;
    Problem<double> problem = without;
    problem.prior = batch ? from_batch(without, records, first) : Prior<double>{.variance = trial.number("amount")};
    for (Cell const& variant : row_forms()) {
        CatalogueEntry const& entry = trial.entry(std::get<std::string>(variant));
        auto const filter = entry.make(problem, Seed{1});
        process_rows(*filter, records, first, rows);
        Errors const error = errors(*filter, exact);
        Health const status = breakdown(*filter, *entry.arithmetic);
        out({variant, std::string(name_of(status)), error.theta, error.covariance});
    }
}

Table from_prior(Table const& t, double from = 1,
                 double to = 1e40) {  // powers are computed, so the bounds are a little wider
    return t.where("start", "prior").where("amount", [=](double c2) { return from / 1.01 < c2 && c2 < to * 1.01; });
}
/// The least median error from any c^2 I, over the median error from the batch of 2 d rows: what the batch start gains.
Statistic gain(std::string const& column) {
    auto const gained = [column](Table const& t) {
        double least = INFINITY;
        for (auto const& [name, at] : from_prior(t).groups({"amount"}))
            least = std::min(least, median(at.numbers(column)));
        return least / median(t.where("start", "batch").where("amount", 2.0 * size).numbers(column));
    };
    return {gained, Estimate::geometric};
}
/// The error from c^2 = 1e20 over that from the batch of 2 d rows.
Statistic without_batch(std::string const& column) {
    auto const ratio = [column](Table const& t) {
        return median(from_prior(t, 1e20, 1e20).numbers(column)) /
               median(t.where("start", "batch").where("amount", 2.0 * size).numbers(column));
    };
    return {ratio, Estimate::geometric};
}
Judgement as_good(Table const& t, std::vector<std::string> const& variants) {
    Table const of = t.where("variant", variants);
    return labelled("theta", within(of, {"variant", "lambda"}, without_batch("theta"), 0.25, 4)) &&
           labelled("P", within(of, {"variant", "lambda"}, without_batch("covariance"), 0.25, 4));
}
Judgement gains(Table const& t, std::vector<std::string> const& variants, double from, double to) {
    Table const of = t.where("variant", variants);
    Judgement const theta = within(of, {"variant", "lambda"}, gain("theta"), from, to);
    Judgement const P = within(of, {"variant", "lambda"}, gain("covariance"), from, to);
    return labelled("theta", theta) && labelled("P", P);
}
std::vector<std::string> const plain = words(covariance_forms());
std::vector<std::string> const rooted = words(triangular_forms());

}  // namespace

extern Study const initialisation;
Study const initialisation{
    .name = "initialisation",
    .question = "Should RLS start from c^2 I or from a batch estimate?",
    .source = "derived (docs/theory.md 13); the digits are measured here",
    .formula = R"tex(\begin{aligned}&\text{prior: } P_0 = c^2 I,\ \theta_0 = 0\\
&\text{batch of } m \text{ rows: } P_m = \Big(\sum_{k\le m}\lambda^{m-k}\psi_k\psi_k^\top\Big)^{-1},\quad
        \theta_m = P_m \sum_{k\le m}\lambda^{m-k}\psi_k y_k\end{aligned})tex",
    .interpretation =
        "All starts see the same 300 rows of condition 1000, and the target is least squares without a prior. A "
        "start from c^2 I pays the bias for small c^2 and, in the forms that propagate P, rounding for large c^2. A "
        "start from the batch estimate of the first rows, rounded once to double, pays neither: it gives the "
        "covariance forms four to six decades that no c^2 gives them. On these rows triangular, UD and QR forms need "
        "no batch: with c^2 = 1e20 or more they are as good, and a little better, for no rounded P is handed over. A "
        "longer batch helps the covariance forms a little more.",
    .data = "graded rows of condition 1000, d = 5",
    .factors =
        [](Budget budget) {
            return std::vector<Factor>{
                {"lambda", {1.0, 0.99}},
                {"start", {"prior", "batch"}},
                {"amount", joined({1.0 * size, 2.0 * size, 4.0 * size, 10.0 * size, 20.0 * size}, powers(10, 4, 30))},
                {"replicate", counted(budget == Budget::full ? 80 : 15)}};
        },
    .admits =
        [](Trial const& t) { return (t.text("start") == "batch") == (t.number("amount") < 1000); },  // rows, or c^2
    .measures = {"variant", "outcome", "theta", "covariance"},
    .measure = measure,
    .plots = {{.title = "Start from c² I: error of theta after 300 rows",
               .x = "amount",
               .y = "theta",
               .panel = "lambda",
               .x_label = "prior variance c²",
               .y_label = "relative error of theta",
               .where = {{"start", {"prior"}}}},
              {.title = "Start from a batch: error of theta after 300 rows",
               .x = "amount",
               .y = "theta",
               .panel = "lambda",
               .x_label = "rows in the batch",
               .y_label = "relative error of theta",
               .where = {{"start", {"batch"}}}}},
    .claims =
        {
            {"from c^2 I every variant has the same bias, 1/c^2: slope -1.00 +- 0.02 over 1e8 ... 1e11",
             [](Table const& t) {
                 return within(from_prior(t, 1e8, 1e11), {"variant", "lambda"}, slope("amount", "theta"), -1.02, -0.98);
             },
             own_result("docs/theory.md 13")},
            {"covariance forms: a batch of 2d rows gains over the best c^2, at least a digit, in theta and in P",
             [](Table const& t) { return gains(t, plain, 10, INFINITY); }, own_result("set before the run: a digit")},
            {"and so in Potter's form", [](Table const& t) { return gains(t, {"potter"}, 10, INFINITY); },
             own_result("set before the run: a digit")},
            {"triangular, UD and QR forms gain nothing: c^2 = 1e20 has between 1/4 and 4 of the batch start's error",
             [](Table const& t) { return as_good(t, rooted); },
             own_result("set before the run: as of the information form")},
            {"nor does the information form, whose u kappa^2 is that of its solve: between 1/4 and 4",
             [](Table const& t) { return as_good(t, {"information"}); },
             own_result("first edition, set after its run")},
            {"after a batch start every variant ends positive definite in most runs, whatever the length of the batch",
             [](Table const& t) { return everywhere(t.where("start", "batch"), "outcome", "sound"); },
             own_result("first edition, set after its run")},
            {"from c^2 = 1e20 I the conventional form ends indefinite, in most runs",
             [](Table const& t) {
                 return everywhere(from_prior(t, 1e20, 1e20).where("variant", "conventional"), "outcome", "indefinite");
             },
             own_result("first edition, set after its run")},
        },
};

}  // namespace rlslab::studies
