// Which stored covariances stop being positive definite, and when: decided for exactly the stored bits at every step.
#include "studies/engine/findings.hpp"
#include "studies/engine/scenarios.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/lab/breakdown.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab {
namespace {

constexpr Index size = 4;
constexpr double lambda = 0.99;
/// Sixty memories 1/(1 - lambda): longer than ln(2^53) of them, after which the antisymmetric error of double has grown to 1.
constexpr int horizon = 6000;

struct End {
    int step = horizon + 1;  ///< the first with a P that is not positive definite; one past the run if none is
    std::string how = {};
};

/// Rows of variances 1 ... kappa_P^-1 along fixed random directions. The prior is as wide as the widest direction of P becomes,
/// (1 - lambda) kappa_P, so that neither the start nor a slow growth towards that width decides.
End first_breakdown(Entry const& entry, double kappa_P, Seed data) {
    Problem<double> const problem =
        as_stored({.size = size, .forgetting = lambda, .prior = Prior<double>{.variance = (1 - lambda) * kappa_P}}, *entry.arithmetic);
    Records records = graded(size, horizon, std::sqrt(kappa_P), data);
    constexpr double scale = 64;  // about sqrt(horizon): from singular values of all rows to deviations of one; exact
    records.psi *= scale, records.y *= scale;
    records = as_stored(records, *entry.arithmetic);
    auto const filter = entry.make(problem, Seed{1});
    for (int k = 1; k <= horizon; ++k) {
        filter->update(records.sample(k - 1), records.y[k - 1]);
        if (std::string how = breakdown(*filter, *entry.arithmetic); !how.empty()) return {k, std::move(how)};
    }
    return {};
}

/// Replicates inside: a survival curve is a fraction of them.
void measure(Trial const& trial, TrialOutput& out) {
    int const runs = trial.full() ? 24 : 8;
    Entry const& entry = trial.entry(trial.text("variant"), trial.text("arithmetic"));
    Seed seed = trial.seed({"arithmetic", "hardness"});
    std::vector<double> first;
    double indefinite = 0, nonfinite = 0;
    for (int i = 0; i < runs; ++i) {
        End const end = first_breakdown(entry, trial.number("hardness") / entry.arithmetic->unit_roundoff(), Seed{seed.next()});
        first.push_back(end.step);
        indefinite += end.how == "indefinite";
        nonfinite += end.how == "nonfinite";
    }
    auto const [earliest, latest] = std::ranges::minmax(first);
    for (int i = 0; i <= 38; ++i) {  // from the first step to the last, a tenth of a decade apart
        double const step = std::round(correctly::pow(horizon, i / 38.0));
        double const left = double(std::ranges::count_if(first, [=](double f) { return f > step; }));
        out({step, left / runs, median(first), earliest, latest, indefinite / runs, nonfinite / runs});
    }
}

/// The last row of each curve: the outcome of all runs.
Table ends(Table const& t) { return t.where("step", double(horizon)); }

/// The median first step of one variant over another's, in each arithmetic.
Finding ratio(Table const& t, std::string const& a, std::string const& b, double from, double to) {
    std::string said;
    bool holds = true;
    for (auto const& [name, rows] : ends(t).groups({"arithmetic"})) {
        double const x = rows.where("variant", a).number("first") / rows.where("variant", b).number("first");
        holds = holds && from <= x && x <= to;
        said += fmt::format("{}{:.2g} ({})", said.empty() ? "" : ", ", x, name);
    }
    return {holds && !said.empty(), said};
}

}  // namespace

extern Study const definiteness;
Study const definiteness{
    .name = "definiteness",
    .question = "Which stored covariances stop being positive definite, and when?",
    .source =
        "Bierman 1977, Verhaegen & Van Dooren 1986 (cited, not read): factor forms keep P definite; that Joseph's form does too is "
        "often said and contradicted by docs/literature.md 3.9, 3.10 (why: docs/theory.md 43); the survival curves are measured "
        "here",
    .formula = R"tex(h = \kappa_P\,u, \qquad \text{definite after } k: \quad x^\top P_i\,x > 0 \ \text{ for all } x \neq 0,\ i \le k)tex",
    .interpretation =
        "Each curve is the fraction of runs whose stored P is still positive definite, decided exactly for the bits at every "
        "step. The data have "
        "kappa_P = h/u, so that each arithmetic meets the same difficulty for its length; lambda = 0.99. The factor forms stay "
        "at one in all of "
        "them. The conventional form falls to zero however well conditioned the data, because its antisymmetric error grows as "
        "lambda^-k. Joseph's "
        "form is a sum of two semidefinite terms only before rounding: its triple product rounds by u |I - K psi'|^2 |P|, so in "
        "double it fails within "
        "steps where the symmetric form lasts to the end. Its expansion to O(d^2) does not form that product and fails when "
        "symmetric does.",
    .factors =
        [](Budget) {
            return std::vector<Factor>{
                {"arithmetic", {"bfloat16", "binary16", "float", "double"}}, {"hardness", {0x1p-6, 0.25, 4.0}}, {"variant", row_forms()}};
        },
    .measures = {"step", "definite", "first", "earliest", "latest", "indefinite", "nonfinite"},
    .measure = measure,
    .plots = {{.title = "Runs with a definite P, kappa_P = 1/(4u)",
               .x = "step",
               .y = "definite",
               .panel = "arithmetic",
               .log = "x",
               .y_label = "fraction still definite",
               .where = {{"hardness", {"0.25"}}}},
              {.title = "The same in double, against kappa_P u",
               .x = "step",
               .y = "definite",
               .panel = "hardness",
               .log = "x",
               .y_label = "fraction still definite",
               .where = {{"arithmetic", {"double"}}}}},
    .claims =
        {
            {"factor forms (potter, carlson, ud, inverse_qr, qr, gentleman, extended_qr) stay definite and finite through every run in "
             "every arithmetic, up to kappa_P = 4/u",
             [](Table const& t) {
                 return within(ends(t).where("variant", words(factor_forms())), {"arithmetic", "hardness", "variant"}, least("definite"), 1,
                               1);
             }},
            {"conventional loses it in every run, also where kappa_P is only 1/(64u): by step 2500 at the latest",
             [](Table const& t) {
                 return within(ends(t).where("variant", "conventional"), {"arithmetic", "hardness"}, greatest("latest"), 1, 2500);
             }},
            {"at kappa_P = 4/u every other covariance form and information lose it in at least half of the runs, in every arithmetic",
             [](Table const& t) {
                 return within(
                     ends(t).where("hardness", 4.0).where("variant", words(without(row_forms(), joined(factor_forms(), {"conventional"})))),
                     {"arithmetic", "variant"}, least("indefinite"), 0.5, 1);
             }},
            {"Joseph's broken promise: at kappa_P = 4/u joseph is indefinite in every run, in the median no later than 1.2 times "
             "symmetric's step",
             [](Table const& t) {
                 Table const here = t.where("hardness", 4.0);
                 Finding const all = within(ends(here).where("variant", "joseph"), {"arithmetic"}, least("indefinite"), 1, 1);
                 Finding const earlier = ratio(here, "joseph", "symmetric", 0, 1.2);
                 return Finding{all.holds && earlier.holds, earlier.measured};
             }},
            {"the longer the word, the earlier by comparison: in float and double at kappa_P = 4/u at most 0.3 of symmetric's median step",
             [](Table const& t) {
                 return ratio(t.where("hardness", 4.0).where("arithmetic", {"float", "double"}), "joseph", "symmetric", 0, 0.3);
             }},
            {"in double at kappa_P = 1/(64u) joseph is indefinite in every run by step 400, symmetric and joseph_rank_two in none in all "
             "6000",
             [](Table const& t) {
                 Table const here = ends(t).where("hardness", 0x1p-6).where("arithmetic", "double");
                 Finding const joseph = within(here.where("variant", "joseph"), {}, greatest("latest"), 1, 400);
                 Finding const others = within(here.where("variant", {"symmetric", "joseph_rank_two"}), {}, greatest("indefinite"), 0, 0);
                 return Finding{joseph.holds && others.holds, "the last joseph at step " + joseph.measured +
                                                                  "; of the others "
                                                                  "" +
                                                                  others.measured};
             }},
            {"the expansion joseph_rank_two breaks its promise too, but when symmetric does: median steps at kappa_P = 4/u within a factor "
             "of 4",
             [](Table const& t) { return ratio(t.where("hardness", 4.0), "joseph_rank_two", "symmetric", 0.25, 4); }},
            {"nothing ever breaks down by overflow",
             [](Table const& t) { return within(ends(t), {"arithmetic"}, greatest("nonfinite"), 0, 0); }},
        },
};

}  // namespace rlslab
