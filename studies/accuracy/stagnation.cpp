// Short formats: how far the covariance of a running mean falls before rounding stops it.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <cmath>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

constexpr int rows = 20000;

/// psi = 1 and nothing forgotten: P_k = 1 / (k + 1/P0), so k P should be 1.
void measure(Trial const& trial, TrialOutput& out) {
    CatalogueEntry const& entry = trial.entry(trial.text("variant"), trial.text("arithmetic"));
    Problem<double> const problem =
        as_stored({.size = 1, .prior = Prior<double>{.variance = trial.number("variance")}}, *entry.arithmetic);
    Seed seed = trial.seed({"arithmetic", "variance", "variant", "replicate"});
    auto const filter = entry.make(problem, Seed{seed.next()});
    Vector<double> const one = Vector<double>::Ones(1);
    double reported = 1;  // half an octave apart, and at the end
    for (int k = 1; k <= rows; ++k) {
        filter->update(one, 1);
        if (k < reported && k < rows) continue;
        Matrix<Reference> const P = covariance_of(filter->stored());
        out({double(k), static_cast<double>(P(0, 0)), static_cast<double>(k * P(0, 0))});
        reported = std::max(reported * std::sqrt(2.0), k + 1.0);
    }
}

Table last(Table const& t, std::string const& arithmetic, double variance) {
    return t.where("arithmetic", arithmetic).where("variance", variance).where("rows", double(rows));
}
double mean_rows_P(Table const& t) {
    double sum = 0;
    for (double const x : t.numbers("rows_P")) sum += x / double(t.rows().size());
    return sum;
}
std::vector<std::string> const subtracting{"symmetric", "joseph_rank_two"};

}  // namespace

extern Study const stagnation;
Study const stagnation{
    .name = "stagnation",
    .question = "How small can the variance of a running mean become in a short word?",
    .source =
        "Ardalan 1986 (abstract read: weight updating terminates); derived (docs/theory.md 42); an earlier experiment "
        "(docs/literature.md 3.8)",
    .formula =
        R"tex(P_k = P_{k-1} - \frac{P_{k-1}^2}{1 + P_{k-1}} = P_{k-1} \quad \text{once} \quad
              P^2 < \tfrac12\,\mathrm{ulp}(P) \qquad \text{or} \quad \mathrm{fl}(1 + P) = 1)tex",
    .interpretation =
        "Rounded to nearest, P stops where its decrement is below half a unit in its last place: 2.747e-3 in bfloat16 "
        "for the form that subtracts, 2^-8 for those that take P as a quotient, and all of them pretend for ever to "
        "know the mean no better than after 100 rows. Stochastic rounding has no such place: k P stays near 1 in the "
        "mean. It needs a prior below 1/u, though. From P0 = 1e4 the forms that subtract are at P = 0 after one row, "
        "because K rounds to 1; in bfloat16 stochastic rounding saves few of them. The 54.9 at k = 20000 in "
        "docs/literature.md 3.8 is therefore that of a start below 1/u, as P0 = 100 here, and not of P0 = 1e4. "
        "Potter's form sits between: from 1e4 its first P is off by a factor of 2, and stochastic runs may end at 0.",
    .data = "psi = 1, d = 1",
    .factors =
        [](Budget budget) {
            return std::vector<Factor>{
                {"arithmetic", {"bfloat16", "bfloat16-stochastic", "binary16", "binary16-stochastic"}},
                {"variance", {100.0, 1e4}},
                {"variant",
                 {"symmetric", "joseph", "joseph_rank_two", "potter", "carlson", "ud", "inverse_qr", "qr", "gentleman",
                  "information"}},
                {"replicate", counted(budget == Budget::full ? 100 : 20)}};
        },
    .admits =
        [](Trial const& trial) {
            return trial.number("replicate") == 1 || trial.text("arithmetic").ends_with("stochastic");
        },
    .measures = {"rows", "P", "rows_P"},
    .measure = measure,
    .plots = {{.title = "Rows times variance from P0 = 100, which should be 1",
               .x = "rows",
               .y = "rows_P",
               .panel = "arithmetic",
               .x_label = "rows k",
               .y_label = "k P",
               .where = {{"variance", {"100"}}}}},
    .claims =
        {
            {"bfloat16 from P0 = 100: the subtracting forms freeze at 2.747e-3, k P = 54.9 at k = 20000",
             [](Table const& t) {
                 return within(last(t, "bfloat16", 100).where("variant", subtracting), {"variant"},
                               median("rows_P").as(Estimate::fixed), 54.8, 55.0);
             },
             reproduction("earlier experiment, docs/literature.md 3.8")},
            {"carlson, ud, gentleman and information freeze at 2^-8 in bfloat16 and 2^-11 in binary16, from both "
             "priors, to 0.2 %",
             [](Table const& t) {
                 std::vector<std::string> const forms{"carlson", "ud", "gentleman", "information"};
                 std::vector<Judgement> all;
                 for (double const variance : {100.0, 1e4})
                     for (auto const& [name, bits] : {std::pair<char const*, int>{"bfloat16", 8}, {"binary16", 11}}) {
                         double const level = std::ldexp(1.0, -bits);
                         all.push_back(labelled(fmt::format("{} from {}", name, variance),
                                                within(last(t, name, variance).where("variant", forms), {"variant"},
                                                       median("P").as(Estimate::fixed), 0.998 * level, 1.002 * level)));
                     }
                 return together(all);
             },
             own_result("docs/theory.md 42")},
            {"rounded to nearest no variant comes down to 1 from P0 = 100: k P at k = 20000 is at least k u / sqrt(2) "
             "less a spacing, 54.8 in bfloat16 and 6.9 in binary16",
             [](Table const& t) {
                 Judgement const a =
                     within(last(t, "bfloat16", 100), {"variant"}, median("rows_P").as(Estimate::fixed), 54.8, 300);
                 Judgement const b =
                     within(last(t, "binary16", 100), {"variant"}, median("rows_P").as(Estimate::fixed), 6.9, 40);
                 return a && b;
             },
             own_result("docs/theory.md 42, in place of a band set after its run")},
            {"stochastic rounding from P0 = 100: the median of k P at k = 20000 in 0.8 ... 1.25 for every variant, and "
             "in bfloat16 of symmetric in 0.9 ... 1.1",
             [](Table const& t) {
                 Judgement const a = within(last(t, "bfloat16-stochastic", 100), {"variant"}, mean_rows_P, 0.8, 1.25);
                 Judgement const b = within(last(t, "binary16-stochastic", 100), {"variant"}, mean_rows_P, 0.8, 1.25);
                 Judgement const c = within(last(t, "bfloat16-stochastic", 100).where("variant", "symmetric"), {},
                                            mean_rows_P, 0.9, 1.1);
                 return a && b && c;
             },
             own_result("docs/theory.md 75, to a factor of 1.25; of symmetric first edition, set after its run")},
            {"from P0 = 1e4 > 1/u the subtracting forms are at P = 0 after one row in bfloat16 and binary16, and in "
             "most stochastic runs of bfloat16 too",
             [](Table const& t) {
                 Table const first = t.where("variance", 1e4).where("rows", 1.0).where("variant", subtracting);
                 return within(first.where("arithmetic", {"bfloat16", "binary16"}), {"arithmetic", "variant"},
                               median("P").as(Estimate::fixed), 0, 0) &&
                        within(first.where("arithmetic", "bfloat16-stochastic"), {"variant"}, median("P"), 0, 0);
             },
             own_result("docs/theory.md 41")},
            {"joseph, carlson, ud, inverse_qr, qr, gentleman and information take P0 = 1e4: P = 1 to 1 % after one "
             "row, rounded to nearest",
             [](Table const& t) {
                 Table const first =
                     t.where("variance", 1e4).where("rows", 1.0).where("arithmetic", {"bfloat16", "binary16"});
                 return within(first.where("variant",
                                           {"joseph", "carlson", "ud", "inverse_qr", "qr", "gentleman", "information"}),
                               {"arithmetic", "variant"}, median("P").as(Estimate::fixed), 0.99, 1.01);
             },
             own_result("first edition, set after its run")},
        },
};

}  // namespace rlslab::studies
