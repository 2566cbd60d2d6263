// The digits that `compare` counts of a composition: against the right problem high, against any other low. Those of
// fast forms.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>
#include "src/lab/compare/composed_score.hpp"
#include "src/lab/compare/score.hpp"
#include "tests/common/composed.hpp"

#include <rlslab/core/input_error.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace rlslab {
using namespace compare;
using namespace report;
namespace {

using namespace composed_laws;

Comparison compared(Records const& records, Composition const& composition, double forgetting = 1,
                    std::vector<std::string> variants = {}, std::optional<double> p0 = {}) {
    return compare::compare(records, {.forgetting = forgetting,
                                      .p0 = p0,
                                      .variants = variants,
                                      .arithmetics = {"float", "double"},
                                      .composition = composition,
                                      .timings = false});
}
/// The least number of digits of theta and P over the checkpoints from row `from` on.
double least_digits(Comparison const& c, Result const& r, Index from = 2 * d) {
    double least = INFINITY;
    for (size_t i = 0; i < r.path.size(); ++i)
        if (c.checkpoints[i] >= from)
            least = std::min({least, r.path[i].theta.value_or(-INFINITY), r.path[i].covariance.value_or(-INFINITY)});
    return least;
}
/// Both compute the same digits, wherever the composition can be.
void expect_same_paths(Comparison const& a, Comparison const& plain) {
    int seen = 0;
    for (size_t i = 0; i < a.results.size(); ++i) {
        Result const &x = a.results[i], &y = plain.results[i];
        if (!x.obstacle.empty()) continue;
        ++seen;
        EXPECT_EQ(x.breakdown.has_value(), y.breakdown.has_value());
        EXPECT_EQ(x.asymmetry, y.asymmetry);
        EXPECT_EQ(x.certified_to, a.rows);
        ASSERT_EQ(x.path.size(), y.path.size());
        for (size_t k = 0; k < x.path.size(); ++k)
            EXPECT_TRUE(x.path[k].theta == y.path[k].theta && x.path[k].covariance == y.path[k].covariance)
                << x.entry->variant << k;
    }
    EXPECT_GE(seen, 20);
}
TEST(ComposedDigits, AreThoseOfTheVariantWhereTheCompositionDoesNothing) {
    Records const records = rows_of(120, 1, 1000, Seed{21});
    for (double forgetting : {1.0, 0.96875}) {
        Comparison const plain = compared(records, {}, forgetting);
        for (Composition const& nothing :
             {Composition{.control = "constant"}, {.guard = "report"}, {.window = 120}, {.window = 1000000}})
            expect_same_paths(compared(records, nothing, forgetting), plain);
    }
}
/// Rows of 1e4 leave the window: it factors anew, after which the prior's age is another.
TEST(ComposedDigits, OfAWindowAreOfItsRows) {
    for (unsigned seed : {31, 32, 33})
        for (double forgetting : {1.0, 0.96875}) {
            Records const records = rows_of(400, 1e4, 220, Seed{seed});
            Comparison const c =
                compared(records, {.window = 40}, forgetting, {"ud", "qr", "carlson", "gentleman"}, 0.5);
            Index refactored = 0;
            for (Result const& r : c.results) {
                double const unit = r.entry->arithmetic->decimal_digits();
                EXPECT_GE(least_digits(c, r), unit - 5)
                    << r.entry->variant << ' ' << r.entry->arithmetic->name << " seed " << seed;
                EXPECT_EQ(r.certified_to, 400);
                refactored += r.happened.back().refactored;
            }
            EXPECT_GT(refactored, 0);
        }
}
/// The same filter against another problem's solution: whole record, a window of one row less, a prior of another age.
TEST(ComposedDigits, OfAWindowFallAgainstAnythingElse) {
    Records const records = rows_of(400, 1e4, 220, Seed{31});
    Problem<double> const problem{.size = d, .forgetting = 0.96875, .prior = Prior<double>{.variance = 0.5}};
    RoundedProblem const stored = rounded_problem(
        records, problem, [](double x) { return x; }, {{}}, 30);
    std::vector<Index> const checkpoints = checkpoints_of(400);
    auto const ud = composed({.window = 40}, "ud", "double", problem);
    CompositionReference right({.window = 40}, stored, 30), whole({}, stored, 30), shorter({.window = 39}, stored, 30);
    double least[4] = {99, 99, 99, 99};
    Index k = 0;
    for (size_t c = 0; c < checkpoints.size(); ++c) {
        for (; k < checkpoints[c]; ++k) ud->update(records.sample(k), records.y[k]);
        Vector<Reference> const theta = ud->theta();
        Index const age = right.age_of_prior(k, ud->counts());
        least[0] = std::min(least[0], right.minimiser(c, age).theta_digits(theta));
        least[1] = std::min(least[1], whole.minimiser(c, age).theta_digits(theta));
        least[2] = std::min(least[2], shorter.minimiser(c, age).theta_digits(theta));
        least[3] = std::min(least[3], right.minimiser(c, std::max<Index>(k, 40) + 7).theta_digits(theta));
    }
    EXPECT_GT(least[0], 10);
    EXPECT_LT(least[1], 2);
    EXPECT_LT(least[2], 5);
    EXPECT_LT(least[3], 6);
}
TEST(ComposedDigits, OfARuleAreOfItsOwnRecursion) {
    std::vector<Composition> const rules{{"fortescue", {0.02, 50, 0.5}},
                                         {"kulhavy", {0.97, 0}},
                                         {"cao_schwartz", {0.97, 0}},
                                         {"ridge", {0.5}},
                                         {"reset", {45, 16}},
                                         {"random_walk", {1e-3}},
                                         {"random_walk", {1e-3}, 0, "report"}};
    for (unsigned seed : {41, 42, 43}) {
        Records const records = rows_of(200, 1, 110, Seed{seed});
        for (Composition const& rule : rules) {
            Comparison const c = compared(records, rule, rule.control == "ridge" ? 0.9375 : 1,
                                          {"ud", "qr", "inverse_qr", "kalman"}, 16.0);
            for (Result const& r : c.results) {
                if (!r.obstacle.empty()) continue;
                EXPECT_GE(least_digits(c, r), r.entry->arithmetic->decimal_digits() - 4)
                    << rule.control << ' ' << r.entry->variant << ' ' << r.entry->arithmetic->name;
                EXPECT_EQ(r.certified_to, 0);
            }
        }
    }
}
TEST(ComposedDigits, OfARuleFallWhereItsNumberIsAnother) {
    Records const records = rows_of(200, 1, 110, Seed{41});
    Problem<double> const problem{.size = d, .prior = Prior<double>{.variance = 16}};
    RoundedProblem const stored = rounded_problem(
        records, problem, [](double x) { return x; }, {{}}, 30);
    CatalogueEntry const& ud = *find_entry("ud");
    CompositionReference right({.control = "kulhavy", .parameters = {0.97, 0}}, stored, 30);
    EXPECT_GE(score_composed(ud, stored, right).spread->theta.low, 12);
    for (double const agreement : right.recursion("ud").agreement)
        EXPECT_GE(agreement, 70);  // ud's and qr's, in 77 digits
    auto const off = composed({.control = "kulhavy", .parameters = {0.9700001, 0}}, "ud", "double", problem);
    for (Index k = 0; k < 200; ++k) off->update(records.sample(k), records.y[k]);
    double error = 0;
    for (Index i = 0; i < d; ++i)
        error = std::max(
            error, std::abs(static_cast<double>(Reference(off->theta()[i] - right.recursion("ud").theta.back()[i]))));
    EXPECT_GT(error, 1e-10);
}
TEST(ComposedDigits, OfAGuardAreOfItsRecursionFromWhereItActs) {
    for (unsigned seed : {51, 52, 53}) {
        Records records = rows_of(300, 1, 1000, Seed{seed});
        records.y[160] += 1e5;  // the guard skips it
        Comparison const c = compared(records, {.guard = "reset"}, 1, {"ud", "qr", "information"});
        for (Result const& r : c.results) {
            EXPECT_EQ(r.happened.back().outliers, 1) << r.entry->variant;
            EXPECT_EQ(r.certified_to, *(std::ranges::upper_bound(c.checkpoints, Index(160)) - 1));
            EXPECT_GE(least_digits(c, r), r.entry->arithmetic->decimal_digits() - 4)
                << r.entry->variant << r.entry->arithmetic->name;
        }
        Comparison const alone = compared(records, {.guard = "report"}, 1, {"ud"});
        EXPECT_GE(alone.results[0].happened.back().outliers, 1);
        EXPECT_EQ(alone.results[0].certified_to, 300) << "nothing was changed";
    }
}
TEST(ComposedDigits, TellWhyAVariantCannot) {
    Records const records = rows_of(60, 1, 1000, Seed{61});
    Comparison const c = compared(records, {.control = "cao_schwartz", .parameters = {0.97, 0}});
    std::set<std::string> can;
    for (Result const& r : c.results)
        if (r.obstacle.empty()) can.emplace(r.entry->variant);
        else EXPECT_TRUE(r.path.empty() && !r.spread && !r.breakdown) << r.entry->variant;
    EXPECT_EQ(can, (std::set<std::string>{"carlson", "carlson_delta", "ud", "ud_delta", "inverse_qr",
                                          "inverse_qr_delta", "information", "qr", "gentleman"}));
    EXPECT_THROW(compared(records, {.control = "cao_schwartz", .parameters = {0.97, 0}}, 1, {"potter", "joseph"}),
                 InputError);
    EXPECT_THROW(compared(records, {.control = "kulhavy", .parameters = {0.97, 0}, .window = 9}), InputError);
}

// --- the table of fast forms: where the regressors are a delay line, and only there ----------------------------------

/// Samples of white noise, the newest first; the first line is full. y is their sum and noise.
Records line_of(Index taps, Index rows, double scale = 1) {
    Seed seed{3};
    Records out{.psi = Matrix<double>(taps, rows), .y = Vector<double>(rows), .names = {}};
    std::vector<double> u;
    for (Index k = 0; k < rows + taps; ++k) u.push_back(scale * seed.bell());
    for (Index i = 0; i < taps; ++i) out.names.push_back("b" + std::to_string(i));
    for (Index k = 0; k < rows; ++k) {
        for (Index i = 0; i < taps; ++i) out.psi(i, k) = u[size_t(k + taps - i)];
        out.y[k] = out.psi.col(k).sum() + 0.1 * scale * seed.bell();
    }
    return out;
}
CompareOptions options(double forgetting = 0.96875) {
    return {.forgetting = forgetting, .variants = {"ud"}, .arithmetics = {"float", "double"}, .timings = false};
}

TEST(FastTable, HasTheDigitsOfTheCertifiedPredictionErrors) {
    for (double const lambda : {0.99, 1.0}) {
        Comparison const c = compare::compare(line_of(5, 200), options(lambda));
        ASSERT_EQ(c.fast.size(), 10u);
        for (FastResult const& r : c.fast) {
            bool const wide = r.arithmetic == "double", lattice = r.form.ends_with("lattice");
            ASSERT_TRUE(r.digits) << r.form;
            EXPECT_GT(*r.digits, lattice ? (wide ? 12 : 3.5) : 0) << r.form << ' ' << r.arithmetic;
            EXPECT_LT(*r.digits, wide ? 16 : 7.3) << r.form;
            if (lattice) {
                EXPECT_FALSE(r.breakdown) << r.form;
            }
        }
        EXPECT_EQ(c.fast.back().operations, 163);
        EXPECT_THAT(as_table(c, false), testing::HasSubstr("fast forms in float"));
        EXPECT_THAT(as_json(c), testing::HasSubstr("fast_forms"));
    }
}
TEST(FastTable, IsAbsentWithoutADelayLine) {
    Records gap = line_of(3, 60), constant = gap, other = gap;
    gap.psi.col(30).swap(gap.psi.col(31));
    constant.psi.row(2).setOnes();
    other.psi(0, 3) += 1;
    EXPECT_TRUE(is_delay_line(line_of(3, 60)));
    for (Records const& records : {gap, constant, other, line_of(1, 60)}) {
        Comparison const c = compare::compare(records, options());
        EXPECT_THAT(c.fast, testing::IsEmpty());
        EXPECT_THAT(as_table(c, false), testing::Not(testing::HasSubstr("fast forms")));
        EXPECT_THAT(as_json(c), testing::Not(testing::HasSubstr("fast_forms")));
    }
}
TEST(FastTable, WhatAnArithmeticCannotHoldIsNoError) {
    for (double const scale : {0x1p-500, 0x1p-70, 0x1p70, 0x1p500}) {
        Comparison const c = compare::compare(line_of(3, 60, scale), options());
        EXPECT_THAT(c.fast, testing::Not(testing::IsEmpty()));
        for (FastResult const& r : c.fast)
            if (r.arithmetic == "double" && r.form == "error_feedback_lattice") {
                EXPECT_GT(r.digits.value_or(0), 12) << scale;
            }
    }
}

}  // namespace
}  // namespace rlslab
