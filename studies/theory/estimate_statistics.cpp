// Bias, covariance, efficiency and normality of the least squares estimate, by Monte Carlo in lockstep.
// Longer than 150 lines: eleven claims on one Monte Carlo run.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>
#include "studies/theory/second_order.hpp"

#include <rlslab/variants/ud.hpp>

#include <array>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

using namespace second_order;
constexpr int packs = 128;  // a trial: 1024 records, under a second

System system_named(std::string const& name) { return {name != "impulse_response", name == "coloured" ? 0.7 : 0.0}; }

/// What is added up over the records, for each parameter.
struct Sums {
    double error = 0, square = 0, fourth = 0, crb = 0, inside = 0;
};

void measure(Trial const& trial, TrialOutput& out) {
    System const system = system_named(trial.text("system"));
    Index const d = system.size(), N = Index(trial.number("rows"));
    auto const truth = system.theta();
    std::array<Sums, 5> sums;
    Seed seed = trial.seed({"system", "rows", "batch"});
    for (int pack = 0; pack < packs; ++pack) {
        // So large a prior weighs nothing here: sigma^2 / variance beside N.
        Ud<P> filter(Problem<P>{.size = d, .prior = Prior<P>{.variance = P(0x1p40)}});
        P J(0.0);
        auto const bell = [](Seed& of) { return of.bell(); };
        simulate(system, N, seed, bell, [&](std::vector<P> const& psi, P const& y) {
            Step<P> const step = filter.update(Regressor<P>(psi.data(), d), y);
            J += step.innovation * step.residual;  // docs/theory.md 15
        });
        Vector<P> const theta = filter.theta();
        Matrix<P> const covariance = filter.covariance();
        for (Index i = 0; i < d; ++i)
            for (int lane = 0; lane < 8; ++lane) {
                Sums& s = sums[size_t(i)];
                double const e = theta[i][lane] - truth[size_t(i)], p = covariance(i, i)[lane];
                double const sd = std::sqrt(p * J[lane] / double(N - d));
                s.error += e, s.square += e * e, s.fourth += e * e * e * e, s.crb += sigma * sigma * p,
                    s.inside += std::abs(e) <= 1.96 * sd;
            }
    }
    double const records = 8.0 * packs;
    for (Index i = 0; i < d; ++i) {
        Sums const& s = sums[size_t(i)];
        std::string const name =
            system.recursive ? (i < 2 ? fmt::format("a{}", i + 1) : fmt::format("b{}", i - 2)) : fmt::format("b{}", i);
        out({name, s.error / records, s.square / records, s.fourth / records, s.crb / records, s.inside / records});
    }
}

/// The mean error in standard deviations of one estimate.
double bias_of(Table const& t) {
    double const error = mean("mean_error")(t);
    return error / std::sqrt(mean("mean_square")(t) - error * error);
}
Statistic const bias = Statistic(&bias_of, Estimate::mean).over("batch");
Statistic const size_of_bias = Statistic([](Table const& t) { return std::abs(bias_of(t)); }).over("batch");
/// Kurtosis: 3 for a normal.
Statistic const kurtosis = Statistic([](Table const& t) {
                               double const square = mean("mean_square")(t);
                               return mean("mean_fourth")(t) / (square * square);
                           }).over("batch");
Statistic const inside = mean("inside").as(Estimate::mean).over("batch");

/// The mean square error over sigma^2 (R^-1)_ii / N, the Cramer-Rao bound without regard to the regressors that were
/// drawn.
Statistic efficiency(std::string const& name) {
    System const system = system_named(name);
    using S = Stored<Reference>;
    Matrix<Reference> const inverse = covariance_of({S::Quantity::information, S::Form::plain, second_moments(system)});
    return Statistic(
               [=](Table const& t) {
                   std::string const parameter = std::get<std::string>(t.distinct("parameter").front());
                   Index const i = (parameter[0] == 'b' && system.recursive ? 2 : 0) +
                                   (parameter[1] - (parameter[0] == 'a' ? '1' : '0'));
                   double const bound = sigma * sigma * static_cast<double>(inverse(i, i)) / t.numbers("rows").front();
                   return mean("mean_square")(t) / bound;
               },
               Estimate::mean)
        .over("batch");
}
/// The mean square error over the mean of the filter's own sigma^2 P.
Statistic const of_own_covariance =
    Statistic([](Table const& t) { return mean("mean_square")(t) / mean("bound")(t); }, Estimate::mean).over("batch");

Table longest(Table const& t, std::string const& system) {
    return t.where("system", system).where("rows", greatest("rows")(t));
}

}  // namespace

extern Study const estimate_statistics;
Study const estimate_statistics{
    .name = "estimate_statistics",
    .question = "Is the least squares estimate unbiased, consistent, efficient and normal, as the theory says?",
    .source =
        "docs/theory.md 5 to 8; Söderström & Stoica 1989, ch. 7 (cited, not read); for the bias of autoregressions "
        "Kendall 1954, Marriott & Pope 1954 (cited, not read)",
    .formula =
        R"tex(E\,\hat\theta = \theta \;\text{iff}\; E\,(\Phi^\top\Phi)^{-1}\Phi^\top\xi = 0, \qquad
              \operatorname{cov}\hat\theta \to \frac{\sigma^2}{N}R^{-1} = \text{Cramér-Rao bound})tex",
    .interpretation =
        "A system of second order with past outputs among its regressors, and its finite impulse response without "
        "them, both in white noise; and the first in coloured noise. The impulse response is unbiased at every N. With "
        "past outputs the regressors depend on old noise, so that even in white noise a bias of order 1/N is left: it "
        "is real, and it vanishes against the standard deviation, which falls as the root of N only. In coloured noise "
        "the bias stays whatever N. Efficiency is judged by the bound of the known system, sigma^2 R^-1 / N, not by "
        "the P that the same filter reports.",
    .data = "a system of order 2 and its impulse response, binary white input",
    .factors =
        [](Budget budget) {
            bool const full = budget == Budget::full;
            return std::vector<Factor>{
                {"system", {"impulse_response", "recursive", "coloured"}},
                {"rows", full ? std::vector<Cell>{125.0, 250.0, 500.0, 1000.0} : std::vector<Cell>{62.0, 125.0, 250.0}},
                {"batch", counted(full ? 98 : 11)}};  // 98 of 1024 records: 100 352 of each kind
        },
    .measures = {"parameter", "mean_error", "mean_square", "mean_fourth", "bound", "inside"},
    .measure = measure,
    .plots = {{.title = "Mean square error of an estimate",
               .x = "rows",
               .y = "mean_square",
               .series = "parameter",
               .panel = "system",
               .x_label = "rows N",
               .y_label = "mean square error"},
              {.title = "Mean error of an estimate",
               .x = "rows",
               .y = "mean_error",
               .series = "parameter",
               .panel = "system",
               .log = "x",
               .x_label = "rows N",
               .y_label = "mean error"}},
    .claims =
        {
            {"impulse response: unbiased at every N: less than 0.05 standard deviations of one estimate",
             [](Table const& t) {
                 return within(t.where("system", "impulse_response"), {"parameter", "rows"}, bias, -0.05, 0.05);
             },
             reproduction("docs/theory.md 5")},
            {"with past outputs: a1 = -1.5 is estimated too near to zero at small N, by at least 0.01 standard "
             "deviations of one estimate",
             [](Table const& t) {
                 double const fewest = least("rows")(t);
                 return within(t.where("system", "recursive").where("parameter", "a1").where("rows", fewest), {}, bias,
                               0.01, 1);
             },
             own_result("set before the run")},
            {"with past outputs: the bias is below 0.3 standard deviations of one estimate, at every N",
             [](Table const& t) {
                 return within(t.where("system", "recursive"), {"parameter", "rows"}, bias, -0.3, 0.3);
             },
             own_result("first edition, set after its run")},
            {"consistent: the mean square error falls as 1/N, slope -1.00 +- 0.12",
             [](Table const& t) {
                 return within(t.where("system", {"impulse_response", "recursive"}), {"system", "parameter"},
                               slope("rows", "mean_square").over("batch"), -1.12, -0.88);
             },
             reproduction("docs/theory.md 6")},
            {"efficient: at the largest N the impulse response is within 6 % of sigma^2 / N, the Cramer-Rao bound of "
             "its input",
             [](Table const& t) {
                 return within(longest(t, "impulse_response"), {"parameter"}, efficiency("impulse_response"), 0.94,
                               1.06);
             },
             reproduction("docs/theory.md 7")},
            {"efficient: with past outputs within 6 % of sigma^2 R^-1 / N at the largest N, R from the system's own "
             "responses",
             [](Table const& t) {
                 return within(longest(t, "recursive"), {"parameter"}, efficiency("recursive"), 0.94, 1.06);
             },
             reproduction("docs/theory.md 7")},
            {"the impulse response's mean square error is the mean of the filter's sigma^2 P, to 6 %: so the two are "
             "defined",
             [](Table const& t) {
                 return within(longest(t, "impulse_response"), {"parameter"}, of_own_covariance, 0.94, 1.06);
             },
             verification("docs/theory.md 6")},
            {"normal: at the largest N kurtosis is 3 +- 0.2; a linear function of normal noise, given the input",
             [](Table const& t) { return within(longest(t, "impulse_response"), {"parameter"}, kurtosis, 2.8, 3.2); },
             verification("docs/theory.md 8")},
            {"with past outputs, where theta is a ratio, kurtosis is 3 +- 0.2 at the largest N",
             [](Table const& t) { return within(longest(t, "recursive"), {"parameter"}, kurtosis, 2.8, 3.2); },
             own_result("set before the run")},
            {"intervals: the estimate's own 95 % interval holds the truth 95 +- 1.5 % of the time at the largest N",
             [](Table const& t) {
                 return within(t.where("system", {"impulse_response", "recursive"}).where("rows", greatest("rows")(t)),
                               {"system", "parameter"}, inside, 0.935, 0.965);
             },
             reproduction("docs/theory.md 8")},
            {"coloured noise: a1 and a2 are biased by more than one standard deviation at the largest N, and the "
             "intervals miss the truth more often than not",
             [](Table const& t) {
                 Table const a = longest(t, "coloured").where("parameter", {"a1", "a2"});
                 return labelled("standard deviations", within(a, {"parameter"}, size_of_bias, 1, 1e9)) &&
                        labelled("inside", within(a, {"parameter"}, inside, -INFINITY, 0.5));
             },
             reproduction("docs/theory.md 5")},
        },
};

}  // namespace rlslab::studies
