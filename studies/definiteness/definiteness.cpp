// Which stored covariances stop being positive definite, and when: decided for exactly the stored bits at every step.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/breakdown.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

constexpr Index size = 4;
constexpr double lambda = 0.99;
/// Sixty memories 1/(1 - lambda): longer than ln(2^53) of them, after which the antisymmetric error of double has grown
/// to 1.
constexpr int horizon = 6000;

struct End {
    int step = horizon + 1;  ///< the first with a P that is not positive definite; one past the run if none is
    Health how = Health::sound;
};

/// Rows of variances 1 ... kappa_P^-1 along fixed random directions. The prior is as wide as the widest direction of P
/// becomes, (1 - lambda) kappa_P, so that neither the start nor a slow growth towards that width decides.
End first_breakdown(CatalogueEntry const& entry, double kappa_P, Seed data) {
    Problem<double> const problem =
        as_stored({.size = size, .forgetting = lambda, .prior = Prior<double>{.variance = (1 - lambda) * kappa_P}},
                  *entry.arithmetic);
    Records records = graded(size, horizon, std::sqrt(kappa_P), data);
    constexpr double scale = 64;  // about sqrt(horizon): from singular values of all rows to deviations of one; exact
    records.psi *= scale, records.y *= scale;
    records = as_stored(records, *entry.arithmetic);
    auto const filter = entry.make(problem, Seed{1});
    for (int k = 1; k <= horizon; ++k) {
        filter->update(records.sample(k - 1), records.y[k - 1]);
        if (Health const how = breakdown(*filter, *entry.arithmetic); how != Health::sound) return {k, how};
    }
    return {};
}

/// Replicates inside: a survival curve is a fraction of them.
void measure(Trial const& trial, TrialOutput& out) {
    int const runs = trial.full() ? 50 : 12;
    CatalogueEntry const& entry = trial.entry(trial.text("variant"), trial.text("arithmetic"));
    Seed seed = trial.seed({"arithmetic", "hardness"});
    std::vector<double> first;
    double indefinite = 0, nonfinite = 0;
    for (int i = 0; i < runs; ++i) {
        End const end =
            first_breakdown(entry, trial.number("hardness") / entry.arithmetic->unit_roundoff(), Seed{seed.next()});
        first.push_back(end.step);
        indefinite += end.how == Health::indefinite;
        nonfinite += end.how == Health::nonfinite;
    }
    auto const [earliest, latest] = std::ranges::minmax(first);
    Interval const middle = median_interval(first, claim_risk / 2);  // of two medians whose ratio is asked
    for (int i = 0; i <= 38; ++i) {  // from the first step to the last, a tenth of a decade apart
        double const step = std::round(correctly::pow(horizon, i / 38.0));
        double const left = double(std::ranges::count_if(first, [=](double f) { return f > step; }));
        out({step, left / runs, median(first), earliest, latest, indefinite / runs, nonfinite / runs, middle.low,
             middle.high, double(runs)});
    }
}

/// The last row of each curve: the outcome of all runs.
Selection const ends = where("step", double(horizon)), at_4 = ends.where("hardness", 4.0),
                easy_in_double = ends.where("hardness", 0x1p-6).where("arithmetic", "double");

/// The median first step of one variant over another's, and where it lies: by order statistics of both, to a risk of
/// 0.001.
struct Ratio {
    double point;
    Interval interval;
};
Ratio ratio_of(Table const& t, std::string const& a, std::string const& b) {
    Table const A = t.where("variant", a), B = t.where("variant", b);
    return {A.number("first") / B.number("first"),
            {std::max(0.0, A.number("first_low")) / B.number("first_high"),
             A.number("first_high") / std::max(0.0, B.number("first_low"))}};
}
Judge ratio(std::string const& a, double from, double to) {
    return at_4.judged([=](Table const& t) {
        std::vector<Judgement> all;
        for (auto const& [name, rows] : t.groups({"arithmetic"})) {
            auto const [x, interval] = ratio_of(rows, a, "symmetric");
            std::string const said = fmt::format("{:.2g} [{:.2g}, {:.2g}] ({})", x, interval.low, interval.high, name);
            all.emplace_back(verdict_of(interval, {from, to}), said, claim_risk);
        }
        return together(all);
    });
}
/// joseph's median step over symmetric's falls with the length of the word: in these two it lies below that in those
/// two.
Judgement earlier_in_longer_words(Table const& t) {
    auto const in = [&](char const* arithmetic) {
        return ratio_of(t.where("arithmetic", arithmetic), "joseph", "symmetric");
    };
    Ratio const short_words[]{in("bfloat16"), in("binary16")}, long_words[]{in("float"), in("double")};
    bool below = true, above = false;
    for (Ratio const& l : long_words)
        for (Ratio const& s : short_words) {
            below = below && l.interval.high < s.interval.low;
            above = above || l.interval.low > s.interval.high;
        }
    return {below   ? Verdict::holds
            : above ? Verdict::fails
                    : Verdict::undecided,
            fmt::format("{:.2g} and {:.2g} against {:.2g} and {:.2g}", long_words[0].point, long_words[1].point,
                        short_words[0].point, short_words[1].point),
            4 * claim_risk};
}
/// More than half of all runs do what `share` of those of a row did.
Judge most(Selection const& rows, std::string const& share) {
    return rows.each_judged({"arithmetic", "hardness", "variant"}, [=](Table const& row) {
        double const runs = row.number("runs");
        return proportion(size_t(std::lround(row.number(share) * runs)), size_t(runs), 0.5, 1);
    });
}
/// The step at which the antisymmetric rounding error has grown to 1: ln(1/u) / -ln lambda.
double antisymmetric_law(Table const& rows) {
    std::string const name = std::get<std::string>(rows.distinct("arithmetic").front());
    int const bits = name == "bfloat16" ? 8 : name == "binary16" ? 11 : name == "float" ? 24 : 53;
    return bits * correctly::log(2) / -correctly::log(lambda);
}

}  // namespace

extern Study const definiteness{
    .name = "definiteness",
    .question = "Which stored covariances stop being positive definite, and when?",
    .source =
        "Bierman 1977, Verhaegen & Van Dooren 1986 (cited, not read): factor forms keep P definite; that Joseph's form "
        "does too is often said and contradicted by docs/literature.md 3.9, 3.10 (why: docs/theory.md 43); the "
        "survival curves are measured here",
    .formula =
        R"tex(h = \kappa_P\,u, \qquad \text{definite after } k: \quad
              x^\top P_i\,x > 0 \ \text{ for all } x \neq 0,\ i \le k)tex",
    .interpretation =
        "Each curve is the fraction of runs whose stored P is still positive definite, decided exactly for the bits at "
        "every step. The data have kappa_P = h/u, so that each arithmetic meets the same difficulty for its length; "
        "lambda = 0.99. Triangular, UD and QR forms stay at one in all of them. The conventional form falls to zero "
        "however well conditioned the data, because its antisymmetric error grows as lambda^-k; in "
        "bfloat16 P is lost a little later than the law of small errors says. Joseph's form is a sum "
        "of two semidefinite terms only before rounding: its triple product rounds by u |I - K psi'|^2 |P|, so in "
        "double it fails within steps where the symmetric form lasts to the end. Its expansion to O(d^2) does not form "
        "that product and fails when symmetric does.",
    .data = "graded rows, d = 4, lambda = 0.99",
    .factors = {{"arithmetic", {"bfloat16", "binary16", "float", "double"}},
                {"hardness", {0x1p-6, 0.25, 4.0}},
                {"variant", row_forms()}},
    .measures = {"step", "definite", "first", "earliest", "latest", "indefinite", "nonfinite", "first_low",
                 "first_high", "runs"},
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
    .claims = {
        {"triangular, UD and QR forms (carlson, ud, inverse_qr, qr, gentleman, extended_qr) stay definite and "
         "finite through most runs in every arithmetic, up to kappa_P = 4/u",
         most(ends.where("variant", {"carlson", "ud", "inverse_qr", "qr", "gentleman", "extended_qr"}), "definite"),
         own_result("the claim of the literature on factor forms, docs/literature.md 3.9")},
        {"potter's full root does so too", most(ends.where("variant", "potter"), "definite"),
         own_result("the claim of the literature on factor forms, docs/literature.md 3.9")},
        {"conventional loses it in each of these runs, also where kappa_P is only 1/(64u): by step ln(1/u) / -ln "
         "lambda at the latest, within 10 %",
         within(ends.where("variant", "conventional"), {"arithmetic", "hardness"},
                greatest("latest") / antisymmetric_law, 0, 1.1),
         own_result("docs/theory.md 37")},
        {"at kappa_P = 4/u every other covariance form and information lose it in at least half of the runs, in "
         "every arithmetic",
         most(
             at_4.where("variant", {"conventional_two_sided", "symmetric", "joseph", "joseph_rank_two", "information"}),
             "indefinite"),
         own_result("first edition, set after its run")},
        {"Joseph's broken promise: at kappa_P = 4/u joseph is indefinite in most runs, in the median no later than "
         "symmetric",
         most(at_4.where("variant", "joseph"), "indefinite") && ratio("joseph", 0, 1),
         own_result("set before the run: no later")},
        {"the longer the word, the earlier by comparison: at kappa_P = 4/u joseph's median step is a smaller part "
         "of symmetric's in float and double than in bfloat16 and binary16",
         at_4.judged(earlier_in_longer_words), own_result("set before the run: a smaller part")},
        {"in double at kappa_P = 1/(64u) joseph is indefinite in most runs, symmetric and joseph_rank_two are "
         "definite in most, through all 6000 steps",
         most(easy_in_double.where("variant", "joseph"), "indefinite") &&
             most(easy_in_double.where("variant", {"symmetric", "joseph_rank_two"}), "definite"),
         own_result("set before the run: all or none; restated after it for most runs")},
        {"the expansion joseph_rank_two breaks its promise too, but when symmetric does: median steps at kappa_P = "
         "4/u within a factor of 4",
         ratio("joseph_rank_two", 0.25, 4), own_result("first edition, set after its run")},
        {"nothing breaks down by overflow in these runs", within(ends, {"arithmetic"}, greatest("nonfinite"), 0, 0),
         own_result("first edition, set after its run")}}};

}  // namespace rlslab::studies
