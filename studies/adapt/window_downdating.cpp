// Downdating with an alarm: how much worse than a fresh filter a window becomes, how often it is factored anew, and
// what else helps. Longer than 150 lines: two experiments, a search and a slide, and 15 claims.
#include "studies/adapt/windows.hpp"
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace rlslab::studies {
namespace {

constexpr Index d = 4, window = 50, rows = 2000, event = 120;  // the event's row leaves when row 170 comes
constexpr Index steps[] = {100, 150, 172, 180, 240, 300, 500, 900, 1150, 2000};
constexpr double variance = 64;

struct Schedule {
    char const* name;
    Refactoring when;
};
constexpr double never = 1e30;  // also in float
constexpr Schedule schedules[] = {
    {"alarm", {4, 0}}, {"none", {never, 0}}, {"every 100", {never, 100}}, {"every 1000", {never, 1000}}};

Problem<double> const problem{.size = d, .prior = Prior<double>{.variance = variance}};

Records part_of(Records const& all, Index end, Index length) {
    return {.psi = all.psi.middleCols(end - length, length), .y = all.y.segment(end - length, length), .names = {}};
}
double error_of(double digits) { return digits == digits ? correctly::pow(10, -digits) : INFINITY; }

/// The error of P of a fresh filter on these rows, in their order, and the largest over four orders: a single one may
/// be small by luck.
struct Fresh {
    double error, of_orders;
};
Fresh fresh_on(std::string_view variant, std::string_view arithmetic, Records const& kept,
               CertifiedSolution const& exact) {
    Fresh out{0, 0};
    Index const W = kept.rows();
    for (int order = 0; order < 4;
         ++order) {  // as they are, the newest first, the later half first, the later half and it the newest first
        auto const filter = sliding(variant, arithmetic, problem, W, {never, 0});
        for (Index k = 0; k < W; ++k) {
            Index const from = order < 2 ? k : (k + W / 2) % W, at = order % 2 ? W - 1 - from : from;
            filter->update(kept.psi.col(at).data(), kept.y[at]);
        }
        double const error = error_of(exact.covariance_digits(filter->stored()));
        if (order == 0) out.error = error;
        out.of_orders = std::max(out.of_orders, error);
    }
    return out;
}

/// White or ill-conditioned rows, and what enters at row 120: one row, or 10, 10^q times too large.
Records records_of(Trial const& trial) {
    std::string const& model = trial.text("model");
    Seed const seed = trial.seed({"model", "q", "replicate"});
    Records out = white(d, rows, seed, 0.1);
    if (model == "ill") {  // condition 1000: what a column of 1e-3 times white noise beside another gives
        for (Index k = 0; k < rows; ++k) {
            out.y[k] += (1e-3 - 1) * out.psi(1, k) + out.psi(0, k);
            out.psi(1, k) = out.psi(0, k) + 1e-3 * out.psi(1, k);
        }
    }
    double const size = correctly::pow(10, trial.number("q"));
    for (Index k = event; k < event + (model == "burst" ? 10 : 1); ++k) {
        for (double& x : out.psi.col(k)) x *= size;
        out.y[k] *= size;
    }
    return out;
}

void slide(Trial const& trial, TrialOutput& out) {
    std::string const& arithmetic = trial.text("arithmetic");
    Records const records = as_stored(records_of(trial), *trial.entry("qr", arithmetic).arithmetic);
    std::vector<CertifiedSolution> exact;
    for (Index step : steps) exact.push_back(certified(problem, part_of(records, step, window), {window}).front());
    auto variants = windowed_variants();
    variants.emplace_back("corrected");
    for (std::string const& variant : variants) {
        std::vector<Fresh> fresh;
        for (size_t i = 0; i < std::size(steps); ++i)
            fresh.push_back(fresh_on(variant, arithmetic, part_of(records, steps[i], window), exact[i]));
        for (auto const& [name, when] : schedules) {
            if (variant == "corrected" && std::string_view(name) != "none") continue;
            auto const filter = sliding(variant, arithmetic, problem, window, when);
            Index at = 0;
            for (size_t i = 0; i < std::size(steps); ++i) {
                for (; at < steps[i]; ++at) filter->update(records.psi.col(at).data(), records.y[at]);
                double const error = error_of(exact[i].covariance_digits(filter->stored()));
                out({variant, name, double(steps[i]), error, error / fresh[i].error, error / fresh[i].of_orders,
                     filter->predicted(), double(filter->refactored()), 1.0});
            }
        }
    }
}

// --- the search ------------------------------------------------------------------------------------------------------

/// Rows that may be bad for an alarm. Column 0 loses information at each row as column 1 gains it, for `half` rows,
/// then the other way round; so det X need not change. Beside it single rows are larger, and single columns are silent.
struct Recipe {
    double swap;          ///< ln of the size by which columns 0 and 1 change in a row
    double jump, jumps;   ///< log10 of how much larger a row is at most; the share of such rows
    double silence;       ///< share of numbers that are 0
    double half, length;  ///< rows of a half period; rows in the window

    static Recipe drawn(Seed& seed) {
        return {0.5 * seed.uniform() * seed.uniform(), 8 * seed.uniform(),       0.2 * seed.uniform() * seed.uniform(),
                0.5 * seed.uniform() * seed.uniform(), 10 + 90 * seed.uniform(), 10 + 50 * seed.uniform()};
    }
    Recipe near(Seed& seed) const {
        Recipe out = *this, other = drawn(seed);
        for (double Recipe::*x :
             {&Recipe::swap, &Recipe::jump, &Recipe::jumps, &Recipe::silence, &Recipe::half, &Recipe::length})
            out.*x = seed.uniform() < 0.3 ? other.*x : this->*x * (0.8 + 0.4 * seed.uniform());
        out.half = std::max(out.half, 5.0);
        out.length = std::clamp(out.length, 8.0, 80.0);
        return out;
    }
    Records records(Seed seed, Index count) const {
        Records out{.psi = Matrix<double>(d, count), .y = Vector<double>(count), .names = {}};
        double const most = std::min(swap * half, 14.0);  // a swing of information of 1e12
        for (Index k = 0; k < count; ++k) {
            double const phase = double(k) / half - 2 * std::floor(double(k) / half / 2),
                         up = phase < 1 ? phase : 2 - phase;
            double const larger = seed.uniform() < jumps ? correctly::pow(10, jump * seed.uniform()) : 1;
            for (Index i = 0; i < d; ++i) {
                double x = larger * seed.bell();
                if (i == 0) x *= correctly::exp(-most * up);
                if (i == 1) x *= correctly::exp(-most * (1 - up));
                out.psi(i, k) = seed.uniform() < silence ? 0 : x;
            }
            out.y[k] = 0.1 * seed.bell();
            for (Index i = 0; i < d; ++i) out.y[k] += out.psi(i, k);
        }
        return out;
    }
};

/// One line a variant: the worst window that a hill climb over recipes found. A recipe of 24 is drawn, or one near the
/// best so far. Windows of which the fresh filter's P has an error above 0.01 are left out: there is nothing to lose.
void search(Trial const& trial, TrialOutput& out) {
    std::string const& arithmetic = trial.text("arithmetic");
    Seed seed = trial.seed({"model", "arithmetic", "replicate"});
    for (std::string const& variant : windowed_variants()) {
        double worst = 0, literal = 0, tried = 0;
        Recipe best{};
        for (int i = 0; i < (trial.full() ? 24 : 6); ++i) {
            Recipe const recipe = worst > 0 && seed.uniform() < 0.6 ? best.near(seed) : Recipe::drawn(seed);
            Index const W = Index(recipe.length), count = 200;
            Records const records =
                as_stored(recipe.records(Seed{seed.next()}, count), *trial.entry("qr", arithmetic).arithmetic);
            auto const filter = sliding(variant, arithmetic, problem, W, {4, 0});
            for (Index k = 0; k < count; ++k) {
                filter->update(records.psi.col(k).data(), records.y[k]);
                if (k < W || k % 10 != 0) continue;
                Records const kept = part_of(records, k + 1, W);
                CertifiedSolution const exact = certified(problem, kept, {W}).front();
                Fresh const fresh = fresh_on(variant, arithmetic, kept, exact);
                if (!(fresh.of_orders <= 0.01)) continue;
                double const error = error_of(exact.covariance_digits(filter->stored()));
                ++tried;
                literal = std::max(literal, error / fresh.error);
                if (error / fresh.of_orders > worst) worst = error / fresh.of_orders, best = recipe;
            }
        }
        out({variant, "alarm", 200.0, NAN, literal, worst, NAN, NAN, tried});
    }
}

// --- what claims ask -------------------------------------------------------------------------------------------------

std::vector<std::string> const plain{"conventional", "symmetric"},
    factors{"potter", "carlson", "ud", "qr", "gentleman"}, triangular{"carlson", "ud", "qr", "gentleman"};
Table slid(Table const& t, std::string const& schedule) {
    return t.where("model", {"outlier", "burst", "ill"}).where("schedule", schedule);
}
Table between(Table const& t, double from, double to) {
    return t.where("model", "outlier").where("q", [=](double q) { return from <= q && q <= to; });
}
/// The worst of the run over the prediction at the same row.
Statistic of_prediction([](Table const& t) {
    auto const over = t.numbers("over_fresh"), predicted = t.numbers("predicted");
    double sum = 0;
    for (size_t i = 0; i < over.size(); ++i) sum += correctly::log10(over[i] / predicted[i]) / double(over.size());
    return correctly::pow(10, sum);
});

/// The power of the outlier's size that the error goes with.
Statistic const power([](Table const& g) {
    Table logs({"q", "digits"});
    auto const q = g.numbers("q"), error = g.numbers("error");
    for (size_t i = 0; i < q.size(); ++i) logs.add({q[i], correctly::log10(error[i])});
    return linear_slope("q", "digits")(logs);
});

}  // namespace

extern Study const window_downdating;
Study const window_downdating{
    .name = "window_downdating",
    .question = "Is a window with an alarm never worse than ten times a fresh filter?",
    .source = "derived (docs/theory.md 47, 59, 60, 85); Björck, Park & Eldén 1994 (cited, not read)",
    .formula =
        R"tex(V \to \gamma^2 V + 1, \qquad V \to \frac{V + \nu^2}{\alpha^4}, \qquad
              \text{factored anew where } V > 16\,V_0)tex",
    .interpretation =
        "A window of 50 rows over 2000. A row 10^q times too large comes at 120 and leaves at 170. \"Nothing done\" "
        "still factors anew where a removal is refused. Without an alarm what it leaves is kept until the rows are "
        "factored anew (how it grows with q: study sliding_window), so that a schedule bounds how long the damage "
        "lasts and not how large it is. The alarm is the determinant's: it is right where one direction loses "
        "information and the others keep theirs. The search looks for rows where it is not, such as where one "
        "direction gains what another loses, and finds worse windows: ten times is no bound. Corrected semi-normal "
        "equations take q and alpha from the rows that are at hand, and leave nothing of the outlier, for 3 W d a row.",
    .data =
        "white rows, d = 4; the same with condition 1000; one row 10^q times too large, or ten; 24 recipes a seed of "
        "rows that swing, jump and fall silent",
    .factors =
        [](Budget budget) {
            return std::vector<Factor>{{"arithmetic", {"float", "double"}},
                                       {"model", {"outlier", "burst", "ill", "search"}},
                                       {"q", {0.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0}},
                                       {"replicate", counted(budget == Budget::full ? 20 : 11)}};
        },
    .admits =
        [](Trial const& trial) {
            double const q = trial.number("q");
            std::string const& model = trial.text("model");
            return model == "outlier" || (model == "burst" && (q == 2 || q == 4 || q == 6)) || q == 0;
        },
    .measures = {"variant", "schedule", "step", "error", "over_fresh", "over_orders", "predicted", "refactored",
                 "windows"},
    .measure = [](Trial const& trial,
                  TrialOutput& out) { trial.text("model") == "search" ? search(trial, out) : slide(trial, out); },
    .plots =
        {{.title = "Ten rows after the outlier has left, nothing done, double",
          .x = "q",
          .y = "error",
          .log = "y",
          .x_label = "outlier of size 10^q: q",
          .y_label = "relative error of P",
          .where = {{"model", {"outlier"}}, {"arithmetic", {"double"}}, {"schedule", {"none"}}, {"step", {"180"}}},
          .guides = {{"u 10^{2q}", [](double q) { return 0x1p-53 * correctly::pow(10, 2 * q); }},
                     {"u 10^{q}", [](double q) { return 0x1p-53 * correctly::pow(10, q); }}}},
         {.title = "ud in double, one row or ten 10^4 times too large: how long the damage lasts",
          .x = "step",
          .y = "over_fresh",
          .series = "schedule",
          .panel = "model",
          .x_label = "rows seen",
          .y_label = "error of P over a fresh filter's",
          .where = {{"model", {"outlier", "burst"}}, {"arithmetic", {"double"}}, {"variant", {"ud"}}, {"q", {"4"}}}},
         {.title = "What V expects, and what is measured: nothing done, ten rows after the outlier has left, double",
          .x = "predicted",
          .y = "over_fresh",
          .x_label = "sqrt(V / V0)",
          .y_label = "error of P over a fresh filter's",
          .where = {{"model", {"outlier"}}, {"arithmetic", {"double"}}, {"schedule", {"none"}}, {"step", {"180"}}},
          .guides = {{"equal", [](double x) { return x; }}}}},
    .claims =
        {
            {"with its alarm on a window is at most 10 times worse than a fresh filter on the same rows in their "
             "order, at every step looked at, in most runs",
             [](Table const& t) {
                 return within(slid(t, "alarm"), {"arithmetic", "model", "variant"},
                               greatest("over_fresh").as(Estimate::most), 0, 10);
             },
             own_result("set before the run: the aim of the window")},
            {"than the worst of four orders of these rows, triangular forms, in most runs",
             [](Table const& t) {
                 return within(slid(t, "alarm").where("variant", triangular), {"arithmetic", "model", "variant"},
                               greatest("over_orders").as(Estimate::most), 0, 10);
             },
             own_result("the same band; the measure set after a quick run, where lucky fresh filters decided")},
            {"and potter's full root, in most runs",
             [](Table const& t) {
                 return within(slid(t, "alarm").where("variant", "potter"), {"arithmetic", "model"},
                               greatest("over_orders").as(Estimate::most), 0, 10);
             },
             own_result("the same band; the measure set after a quick run, where lucky fresh filters decided")},
            {"and forms that store P, in most runs",
             [](Table const& t) {
                 return within(slid(t, "alarm").where("variant", plain), {"arithmetic", "model", "variant"},
                               greatest("over_orders").as(Estimate::most), 0, 10);
             },
             own_result("the same band; the measure set after a quick run, where lucky fresh filters decided")},
            {"nor does a search over recipes of rows find a window that is, in most runs",
             [](Table const& t) {
                 return within(t.where("model", "search"), {"arithmetic", "variant"},
                               greatest("over_orders").as(Estimate::most), 0, 10);
             },
             own_result("set before the run: the aim of the window")},
            {"white rows, double: it is factored anew every 15 W / (4 d + 2) = 41.7 rows, within 30 %",
             [](Table const& t) {
                 Table const mine =
                     slid(t, "alarm").where("arithmetic", "double").where("q", 0.0).where("model", "outlier");
                 Statistic const interval(
                     [](Table const& g) { return 2000 / g.where("step", 2000.0).number("refactored"); });
                 return within(mine, {"variant"}, interval, 0.7 * 41.7, 1.3 * 41.7);
             },
             own_result("docs/theory.md 85")},
            {"nothing done, double, factor forms, q = 2 ... 6: ten rows after an outlier has left its error is 1/3 to "
             "3 times what sqrt(V / V0) expects",
             [](Table const& t) {
                 Table const mine = slid(between(t, 2, 6), "none").where("arithmetic", "double").where("step", 180.0);
                 return within(mine.where("variant", factors), {"variant"}, of_prediction, 1.0 / 3, 3);
             },
             own_result("docs/theory.md 60, an order-of-magnitude law to a factor of 3")},
            {"and where P is stored, q = 2 and 3",
             [](Table const& t) {
                 Table const mine = slid(between(t, 2, 3), "none").where("arithmetic", "double").where("step", 180.0);
                 return within(mine.where("variant", plain), {"variant"}, of_prediction, 1.0 / 3, 3);
             },
             own_result("docs/theory.md 60, an order-of-magnitude law to a factor of 3")},
            {"a schedule of 100 rows alone, q = 4, double: ten rows after the outlier has left at least 1e4 times a "
             "fresh filter's error",
             [](Table const& t) {
                 Table const mine =
                     slid(between(t, 4, 4), "every 100").where("arithmetic", "double").where("step", 180.0);
                 return within(mine, {"variant"}, median("over_fresh"), 1e4, 1e30);
             },
             own_result("docs/theory.md 47: 10^8 times d / W is 1e7")},
            {"and 40 rows after it was factored anew at row 200 below 10 times",
             [](Table const& t) {
                 Table const mine =
                     slid(between(t, 4, 4), "every 100").where("arithmetic", "double").where("step", 240.0);
                 return within(mine, {"variant"}, median("over_fresh"), 0, 10);
             },
             own_result("set before the run")},
            {"a schedule of 1000 rows keeps the damage: at row 900 at least a tenth of what it was at row 180, factor "
             "forms",
             [](Table const& t) {
                 Table const mine =
                     slid(between(t, 4, 6), "every 1000").where("arithmetic", "double").where("variant", factors);
                 Statistic const kept([](Table const& g) {
                     return median("error")(g.where("step", 900.0)) / median("error")(g.where("step", 180.0));
                 });
                 return within(mine, {"variant"}, kept, 0.1, 10);
             },
             own_result("docs/theory.md 47: lambda = 1")},
            {"corrected semi-normal equations, double: error ~ size^1, slope 1.0 +- 0.3 over q = 2 ... 6",
             [](Table const& t) {
                 Table const mine = slid(between(t, 2, 6), "none").where("arithmetic", "double").where("step", 180.0);
                 return labelled("corrected", within(mine.where("variant", "corrected"), {}, power, 0.7, 1.3)) &&
                        labelled("qr", within(mine.where("variant", "qr"), {}, power, 1.7, 2.3));
             },
             own_result("docs/theory.md 85; 47 for qr")},
            {"nor on any power: slope 0.0 +- 0.1",
             [](Table const& t) {
                 Table const mine = slid(between(t, 2, 6), "none").where("arithmetic", "double").where("step", 180.0);
                 return within(mine.where("variant", "corrected"), {}, power, -0.1, 0.1);
             },
             own_result("docs/theory.md 85 as corrected after a quick run")},
            {"double: never factored anew they stay within 10 times the worst of four orders, in most runs of white "
             "rows and one outlier",
             [](Table const& t) {
                 Table const mine = slid(t, "none")
                                        .where("model", "outlier")
                                        .where("arithmetic", "double")
                                        .where("variant", "corrected");
                 return within(mine, {"q"}, greatest("over_orders").as(Estimate::most), 0, 10);
             },
             own_result("set after a quick run")},
            {"so that of an outlier of 10^6 they leave an error below 1e-8, where qr leaves 1e-6 and more",
             [](Table const& t) {
                 Table const mine = slid(between(t, 6, 6), "none").where("arithmetic", "double").where("step", 180.0);
                 return labelled("corrected",
                                 within(mine.where("variant", "corrected"), {}, median("error"), 0, 1e-8)) &&
                        labelled("qr", within(mine.where("variant", "qr"), {}, median("error"), 1e-6, 1e3));
             },
             own_result("docs/theory.md 85")},
        },
};

}  // namespace rlslab::studies
