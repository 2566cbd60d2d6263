// Bias, covariance, efficiency and normality of the least squares estimate, by Monte Carlo in lockstep.
#include "studies/engine/findings.hpp"
#include "studies/engine/scenarios.hpp"

#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/variants/ud.hpp>

#include <array>
#include <fmt/format.h>

namespace rlslab {
namespace {

using P = Pack<double, 8>;
constexpr double sigma = 0.5;
constexpr int packs = 128;  // a trial: 1024 records, under a second

/// y_k + a_1 y_{k-1} + a_2 y_{k-2} = b_0 u_k + b_1 u_{k-1} + b_2 u_{k-2} + xi_k; without a: a finite impulse response.
struct System {
    bool recursive;
    double colour;  // xi_k = colour xi_{k-1} + white
    Index size() const { return recursive ? 5 : 3; }
    std::array<double, 5> theta() const { return recursive ? std::array{-1.5, 0.7, 1.0, 0.5, -0.3} : std::array{1.0, 0.5, -0.3, 0.0, 0.0}; }
};
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
        std::vector<P> psi(5, P(0.0));
        P y1(0.0), y2(0.0), u1(0.0), u2(0.0), xi(0.0), J(0.0);
        constexpr Index burn_in = 50;  // until the system has forgotten its rest: 0.84^50
        for (Index k = -burn_in; k < N; ++k) {
            std::array<double, 8> input, noise;
            for (double& x : input) x = seed.next() >> 63 ? 1.0 : -1.0;
            for (double& x : noise) x = sigma * seed.bell();
            P const u(input), white(noise);
            xi = P(system.colour) * xi + white;
            size_t next = 0;
            if (system.recursive) psi[next++] = -y1, psi[next++] = -y2;
            psi[next++] = u, psi[next++] = u1, psi[next++] = u2;
            P y = xi;
            for (size_t i = 0; i < size_t(d); ++i) y += psi[i] * P(truth[i]);
            if (k >= 0) {
                Step<P> const step = filter.update(Regressor<P>(psi.data(), d), y);
                J += step.innovation * step.residual;  // docs/theory.md 15
            }
            y2 = y1, y1 = y, u2 = u1, u1 = u;
        }
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
        std::string const name = system.recursive ? (i < 2 ? fmt::format("a{}", i + 1) : fmt::format("b{}", i - 2)) : fmt::format("b{}", i);
        out({name, s.error / records, s.square / records, s.fourth / records, s.crb / records, s.inside / records});
    }
}

double mean(Table const& t, std::string const& column) {
    double sum = 0;
    for (double const x : t.numbers(column)) sum += x / double(t.rows().size());
    return sum;
}
double records_of(Table const& t) { return 8.0 * packs * double(t.rows().size()); }

/// The mean error in its own standard deviations: normal of variance 1 where there is no bias.
double bias_z(Table const& t) { return mean(t, "mean_error") / std::sqrt(mean(t, "mean_square") / records_of(t)); }
/// The bias in standard deviations of one estimate.
double bias(Table const& t) {
    double const error = mean(t, "mean_error");
    return std::abs(error) / std::sqrt(mean(t, "mean_square") - error * error);
}
/// Covariance over the Cramer-Rao bound, in units of what scatters: a sample variance of normal numbers has sd sqrt(2 / n).
double efficiency_z(Table const& t) { return (mean(t, "mean_square") / mean(t, "bound") - 1) / std::sqrt(2 / records_of(t)); }
double efficiency(Table const& t) { return mean(t, "mean_square") / mean(t, "bound"); }
/// Kurtosis: 3 for a normal, its estimate scatters by sqrt(24 / n).
double kurtosis_z(Table const& t) {
    double const square = mean(t, "mean_square");
    return (mean(t, "mean_fourth") / (square * square) - 3) / std::sqrt(24 / records_of(t));
}

Table longest(Table const& t, std::string const& system) { return t.where("system", system).where("rows", greatest("rows")(t)); }

}  // namespace

extern Study const estimate_statistics;
Study const estimate_statistics{
    .name = "estimate_statistics",
    .question = "Is the least squares estimate unbiased, consistent, efficient and normal, as the theory says?",
    .source =
        "docs/theory.md 5 to 8; Söderström & Stoica 1989, ch. 7 (cited, not read); for the bias of autoregressions Kendall 1954, "
        "Marriott & Pope 1954 (cited, not read)",
    .formula =
        R"tex(E\,\hat\theta = \theta \;\text{iff}\; E\,(\Phi^\top\Phi)^{-1}\Phi^\top\xi = 0, \qquad
              \operatorname{cov}\hat\theta \to \frac{\sigma^2}{N}R^{-1} = \text{Cramér-Rao bound})tex",
    .interpretation =
        "A system of second order with past outputs among its regressors, and its finite impulse response without them, both in white "
        "noise; and "
        "the first in coloured noise. The impulse response is unbiased at every N. With past outputs the regressors depend on old noise, "
        "so that "
        "even in white noise a bias of order 1/N is left: it is real, and it vanishes against the standard deviation, which falls as "
        "the root of N only. In coloured noise the bias stays whatever N. Each test's false-alarm probability is that of |z| > 4.5: 7e-6.",
    .factors =
        [](Budget budget) {
            bool const full = budget == Budget::full;
            return std::vector<Factor>{
                {"system", {"impulse_response", "recursive", "coloured"}},
                {"rows", full ? std::vector<Cell>{125.0, 250.0, 500.0, 1000.0} : std::vector<Cell>{62.0, 125.0, 250.0}},
                {"batch", counted(full ? 98 : 8)}};  // 98 of 1024 records: 100 352 of each kind
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
            {"impulse response: unbiased at every N, |z| < 4.5",
             [](Table const& t) {
                 return within(t.where("system", "impulse_response"), {"parameter", "rows"}, bias_z, -4.5, 4.5);
             }},
            {"with past outputs: the bias is there at small N, and above 4.5 of its standard deviations for a1",
             [](Table const& t) {
                 double const fewest = least("rows")(t);
                 Table const a1 = t.where("system", "recursive").where("parameter", "a1").where("rows", fewest);
                 double const z = bias_z(a1);
                 return Finding{std::abs(z) > 4.5, fmt::format("z = {:.3g}, {:.3g} of a standard deviation of one estimate", z, bias(a1))};
             },
             {Kind::finding, "docs/theory.md 5; Kendall 1954 (cited, not read)"}},
            {"with past outputs: it is below 0.3 standard deviations of one estimate, at every N",
             [](Table const& t) {
                 return within(t.where("system", "recursive"), {"parameter", "rows"}, bias, 0, 0.3);
             }},
            {"consistent: the mean square error falls as 1/N, slope -1.00 +- 0.12",
             [](Table const& t) {
                 return within(t.where("system", {"impulse_response", "recursive"}), {"system", "parameter"}, slope("rows", "mean_square"),
                               -1.12, -0.88);
             }},
            {"efficient: at the largest N the impulse response meets the Cramer-Rao bound, |z| < 4.5",
             [](Table const& t) { return within(longest(t, "impulse_response"), {"parameter"}, efficiency_z, -4.5, 4.5); }},
            {"efficient: with past outputs within 6 % of the bound at the largest N",
             [](Table const& t) { return within(longest(t, "recursive"), {"parameter"}, efficiency, 0.94, 1.06); }},
            {"normal: at the largest N kurtosis is 3, |z| < 4.5",
             [](Table const& t) { return within(longest(t, "impulse_response"), {"parameter"}, kurtosis_z, -4.5, 4.5); }},
            {"intervals: the estimate's own 95 % interval holds the truth 95 +- 1.5 % of the time at the largest N",
             [](Table const& t) {
                 return within(
                     t.where("system", {"impulse_response", "recursive"}).where("rows", greatest("rows")(t)), {"system", "parameter"},
                     [](Table const& g) { return mean(g, "inside"); }, 0.935, 0.965);
             }},
            {"coloured noise: a1 and a2 are biased by more than one standard deviation at the largest N, and the intervals miss the truth "
             "more often than not",
             [](Table const& t) {
                 Table const a = longest(t, "coloured").where("parameter", {"a1", "a2"});
                 Finding const far = within(a, {"parameter"}, bias, 1, 1e9),
                               miss = within(
                                   a, {"parameter"}, [](Table const& g) { return mean(g, "inside"); }, 0, 0.5);
                 return labelled("standard deviations", far) && labelled("inside", miss);
             },
             {Kind::finding, "docs/theory.md 5"}},
        },
};

}  // namespace rlslab
