// The rules of the recommendation, each from both sides of its margin.
#include "tests/common/message.hpp"
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/recommend.hpp"
#include "src/lab/compare/score.hpp"
#include "src/lab/compare/words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <set>

namespace rlslab {
using namespace compare;
using namespace report;
namespace {

using testing::HasSubstr;

/// Results of variants that do not exist.
struct Made {
    Arithmetic arithmetic{"double", 53, -1022, 1023, false, nullptr};
    std::deque<CatalogueEntry> entries{};
    std::deque<Result> results{};

    Result& add(char const* name, Spread theta, Spread worst, Spread P, bool factor = true,
                char const* propagates = "covariance", long operations = 100) {
        entries.push_back({name, &arithmetic, false, 1, propagates, false, Family{}, nullptr, nullptr});
        Result r{.entry = &entries.back()};
        r.spread = {theta, worst, P};
        r.runs = 4;
        r.factor = factor;
        r.operations = operations;
        results.push_back(r);
        return results.back();
    }
    Result& add(char const* name, Spread all, bool factor = true, char const* propagates = "covariance",
                long operations = 100) {
        return add(name, all, all, all, factor, propagates, operations);
    }
    std::vector<Result const*> all() const {
        std::vector<Result const*> out;
        for (Result const& r : results) out.push_back(&r);
        return out;
    }
    Comparison comparison() const {
        Comparison c{};
        c.rows = 100, c.size = 3, c.names = {"a", "b", "c"}, c.model.regressors = c.names;
        c.prior_bias = 1e-3;
        c.results.assign(results.begin(), results.end());
        return c;
    }
    Recommendation recommended() const { return recommend(arithmetic, comparison()); }
};

/// Four white columns, 60 000 rows, float, lambda 1: ud keeps a digit of P less.
TEST(Recommendation, TakesTheLeastOfTheLargestLosses) {
    Made m;
    m.add("ud", {5.3, 5.7, 6.1}, {5.1, 5.5, 5.9}, {3.9, 4.4, 5.2});
    m.add("carlson", {5.3, 5.7, 6.1}, {5.1, 5.5, 5.9}, {3.4, 3.9, 4.9});
    m.add("symmetric", {5.3, 5.8, 6.2}, {5.1, 5.6, 6.0}, {5.1, 5.4, 5.7}, false);
    EXPECT_EQ(m.recommended().variant, "symmetric");
}
TEST(Recommendation, CountsALossInEachMeasureAgainstTheBestOfIt) {
    for (auto const measure : PerMeasure<Spread>::all())
        for (double const lost : {0.1, 0.2, 0.3}) {
            Made m;
            Spread const full{13, 14, 15};
            PerMeasure<Spread> s{full, full, full};
            s.*measure = {13, 14 - lost, 15};
            m.add("cheap", s.theta, s.worst, s.covariance, true, "covariance", 10);
            m.add("even", {13, 13.8, 15});
            m.add("not to be used", full, {2.9, 14, 15}, full, true, "covariance", 1);  // the others are measured by it
            EXPECT_EQ(m.recommended().variant, lost <= 0.2 ? "cheap" : "even") << lost;
            m.add("broken", {16, 16, 16}).broken = 1;  // not by it
            EXPECT_EQ(m.recommended().variant, lost <= 0.2 ? "cheap" : "even") << lost;
            EXPECT_NEAR(m.recommended().losses.front().digits, std::min(lost, 0.2), 1e-9);
        }
}
TEST(Recommendation, OfEqualLossesAFactorThenCovarianceThenFewerOperations) {
    Spread const same{10, 11, 12};
    struct {
        bool factor;
        char const* propagates;
        long operations;
    } const order[] = {{true, "covariance", 200},  {true, "covariance", 201}, {true, "information", 100},
                       {true, "information", 101}, {false, "covariance", 50}, {false, "covariance", 51},
                       {false, "information", 10}};
    for (size_t first = 0; first < std::size(order); ++first) {
        Made m;
        for (size_t i = std::size(order); i-- > first;)
            m.add(i == first ? "first" : "later", same, order[i].factor, order[i].propagates, order[i].operations);
        EXPECT_EQ(m.recommended().variant, "first") << first;
    }
    Made m;  // of two that are alike the one that stands first in the list
    m.add("one", same);
    m.add("two", same);
    EXPECT_EQ(m.recommended().variant, "one");
    m.results.back().spread->theta.median += 0.1;
    EXPECT_EQ(m.recommended().variant, "two") << "a tenth of a digit is none";
}
TEST(Recommendation, NeedsThreeDigitsOfTheWorstComponentAndHalfADigitOfP) {
    for (double const low : {2.9, 3.0}) {
        Made m;
        m.add("it", {5, 6, 7}, {low, 6, 7}, {5, 6, 7});
        m.add("less", {4, 5, 6}, {2.5, 5, 6}, {4, 5, 6});
        Recommendation const r = m.recommended();
        EXPECT_EQ(r.variant, low < 3 ? "" : "it");
        EXPECT_EQ(r.too_short, low < 3);
        m.add("usable", {4, 4, 4}, false);
        EXPECT_EQ(m.recommended().variant, low < 3 ? "usable" : "it") << "before the more accurate one that is not";
    }
    for (double const median : {0.4, 0.5}) {
        Made m;
        m.add("it", {5, 6, 7}, {5, 6, 7}, {0, median, 3});
        EXPECT_EQ(m.recommended().variant, median < 0.5 ? "" : "it");
        if (median < 0.5) {
            EXPECT_EQ(m.recommended().why, "none of 1 variants keeps half a digit of P");
        }
    }
    EXPECT_EQ(Made{}.recommended().variant, "");
    EXPECT_FALSE(Made{}.recommended().too_short);
}
/// A two-motor rig in float: an error of ten times the answer at a tenth of the checkpoints.
TEST(Recommendation, SaysWhyAnArithmeticIsTooShort) {
    Made m;
    m.add("ud", {-1.5, 0.8, 2.0});
    m.add("carlson", {-1, 1.0, 2.6});
    Comparison c = m.comparison();
    c.condition = 2.1e5;
    Recommendation r = recommend(m.arithmetic, c);
    EXPECT_EQ(r.variant, "");
    EXPECT_THAT(r.why, Names("carlson -1.0 3 2.1e+05"));
    c.recommendations = {r};
    EXPECT_THAT(verdict(c), Names("double carlson -1.0"));
    for (Result& result : c.results) result.spread->worst = {-INFINITY, 1, 2};
    EXPECT_THAT(recommend(m.arithmetic, c).why, Names("carlson no digits"));
    m.arithmetic.digits = 8;
    EXPECT_THAT(m.recommended().why, Names("2.4 3"));
}
TEST(Recommendation, TellsWhatItAndTheRunnerUpAndConventionalLose) {
    auto const said = [](Made const& m) {
        Comparison c = m.comparison();
        c.recommendations = {recommend(m.arithmetic, c)};
        return verdict(c);
    };
    Made m;
    m.add("conventional", {11, 11, 11}, {11, 11, 11}, {8, 8.2, 9}, false);
    m.add("ud", {11, 11, 11});
    EXPECT_THAT(said(m), Names("100 next conventional 2.8 P"));
    m.add("qr", {10.6, 10.8, 11}, {11, 11, 11}, {10.5, 10.9, 11});
    EXPECT_THAT(said(m), Names("next qr 0.2 theta conventional 2.8 P"));
    m.results.front().broken = 4, m.results.front().breakdown = Breakdown{129, Health::indefinite};
    EXPECT_THAT(said(m), Names("0.2 theta conventional indefinite 129"));
    m.add("joseph", {11.1, 11.1, 11.1}, {10, 10, 10}, {10, 10, 10}, false);
    EXPECT_THAT(said(m), Names("ud 0.1 next qr 0.3 theta conventional"));
    EXPECT_EQ(m.recommended().losses.size(), 3u);
    Made equal;
    equal.add("ud", {11, 11, 11});
    equal.add("carlson", {11, 11, 11}, true, "covariance", 101);
    EXPECT_THAT(said(equal), Names("next carlson good"));
    Made alone;
    alone.add("conventional", {11, 11, 11});
    EXPECT_THAT(said(alone), testing::AllOf(Names("100"), testing::Not(Names("next"))));
}
TEST(Recommendation, NeverOneThatBrokeDownInAnyOrder) {
    Made m;
    m.add("broken", {13, 14, 15}, true, "covariance", 1).broken = 1;
    m.add("sound", {4, 5, 6}, false);
    EXPECT_EQ(m.recommended().variant, "sound");
    m.results.front().broken = 0, m.results.front().others.broken = 1;
    EXPECT_EQ(m.recommended().variant, "sound");
    m.results.back().broken = 4;
    EXPECT_EQ(m.recommended().variant, "");
    EXPECT_THAT(m.recommended().why, Names("2 variants"));
    EXPECT_TRUE(m.recommended().too_short);
}
/// 0.5 is not too far, 0.6 is: in any of the three measures, whatever its medians are.
TEST(Recommendation, NotOneWhoseLowIsMoreThanHalfADigitBehind) {
    for (auto const measure : PerMeasure<Spread>::all())
        for (double const lost : {0.5, 0.6}) {
            Made m;
            PerMeasure<Spread> s{{14, 15.3, 16}, {14, 15.3, 16}, {14, 15.3, 16}};
            (s.*measure).low -= lost;
            m.add("high", s.theta, s.worst, s.covariance);
            m.add("steady", {14, 15.0, 15.5});
            EXPECT_EQ(m.recommended().variant, lost > 0.5 ? "steady" : "high") << lost;
            (m.results.back().spread->theta).low = 12;  // each is behind the other: the lesser loss again
            if (lost > 0.5) {
                EXPECT_EQ(m.recommended().variant, "high");
            }
        }
    Made m;  // no answer at a tenth of the checkpoints
    m.add("none", {-INFINITY, 15, 16}, {4, 15, 16}, {14, 15, 16});
    m.add("steady", {13.9, 14.6, 15}, {4, 14.6, 15}, {14, 14.6, 15});
    EXPECT_EQ(m.recommended().variant, "steady");
}
TEST(Recommendation, TheCheapestFactorWithinHalfADigitStandsBeside) {
    auto const beside = [](double loss, long operations, bool factor, double low) {
        Made m;
        m.add("best", {10, 11, 12});
        m.add("other", {low, 11 - loss, 12}, factor, "covariance", operations);
        m.add("far", {5, 6, 7}, true, "covariance", 1);
        Comparison c = m.comparison();
        c.recommendations = {recommend(m.arithmetic, c)};
        EXPECT_EQ(c.recommendations.front().variant, "best");
        std::string const out = c.recommendations.front().cheapest;
        EXPECT_EQ(verdict(c).find("within half a digit for less: other, ") != std::string::npos, !out.empty());
        return out;
    };
    EXPECT_EQ(beside(0.5, 99, true, 9.5), "other");
    EXPECT_EQ(beside(0.6, 99, true, 9.5), "");
    EXPECT_EQ(beside(0.5, 100, true, 9.5), "");
    EXPECT_EQ(beside(0.5, 99, false, 9.5), "") << "P itself may become indefinite behind the record";
    EXPECT_EQ(beside(0.5, 99, true, 9.4), "");
}
TEST(Recommendation, InformationWhereItsSumsAreExactAndItIsWithinHalfADigit) {
    for (double const loss : {0.5, 0.6})
        for (bool const exact : {true, false}) {
            Made m;
            m.add("ud", {10, 11, 12});
            m.add("information", {10, 11 - loss, 12}, false, "information");
            Comparison c = m.comparison();
            if (exact) c.exact = {{"double", 4096}};
            Recommendation const r = recommend(m.arithmetic, c);
            EXPECT_EQ(r.variant, exact && loss < 0.55 ? "information" : "ud");
            EXPECT_EQ(r.exact_rows, r.variant == "information" ? 4096 : 0);
        }
}
TEST(Recommendation, NotThoseThatTakeBlocksNorThoseOfLibraries) {
    Made m;
    m.add("block", {13, 14, 15});
    m.entries.back().block = 32;
    m.add("library", {13, 14, 15}).operations = {};
    EXPECT_EQ(m.recommended().variant, "");
    m.add("row", {4, 5, 6});
    EXPECT_EQ(m.recommended().variant, "row");
}
TEST(Recommendation, NoneWhereThePriorDecides) {
    Made m;
    m.add("it", {13, 14, 15});
    Comparison c = m.comparison();
    c.prior_bias = 0.01;
    EXPECT_EQ(recommend(m.arithmetic, c).variant, "it");
    c.prior_bias = 0.0101;
    EXPECT_THAT(recommend(m.arithmetic, c).why, Names("prior theta 0.01"));
    c.options.p0 = 1;
    EXPECT_THAT(recommend(m.arithmetic, c).why, Names("prior --p0"));
    EXPECT_EQ(recommend(m.arithmetic, c).variant, "");
    c.prior_bias = std::nan("");
    EXPECT_EQ(recommend(m.arithmetic, c).variant, "");
    c.prior_bias = 0, c.options.p0.reset();
    c.component_bias = 0.1;
    EXPECT_EQ(recommend(m.arithmetic, c).variant, "it");
    c.component_bias = 0.101;
    EXPECT_THAT(recommend(m.arithmetic, c).why, Names("prior component theta 0.1"));
    EXPECT_EQ(recommend(m.arithmetic, c).variant, "");
}
TEST(Warnings, TellOfAPriorThatDecidesAndOfAnOffset) {
    Comparison c{};
    EXPECT_TRUE(warnings(c).empty());
    c.prior_bias = 0.02, c.component_bias = 0.5, c.offset = 2.01;
    c.model.output = "y[k]";
    ASSERT_EQ(warnings(c).size(), 2u);
    EXPECT_THAT(warnings(c)[0], Names("theta 0.02"));
    EXPECT_THAT(warnings(c)[1], Names("y[k] 2.01"));
    c.prior_bias = 0.01, c.offset = 2;
    ASSERT_EQ(warnings(c).size(), 1u);
    EXPECT_THAT(warnings(c)[0], Names("component theta 0.5"));
    c.component_bias = 0.1;
    EXPECT_TRUE(warnings(c).empty());
}
TEST(Warnings, AnOffsetIsTheMeanOfYInItsStandardDeviationsWhereNoRegressorIsConstant) {
    Records r{.psi = Matrix<double>{{1, 2, 3, 5}}, .y = Vector<double>{{9, 11, 9, 11}}, .names = {"x"}};
    CompareOptions options;
    options.variants = {"ud"}, options.arithmetics = {"double"}, options.timings = false;
    EXPECT_DOUBLE_EQ(compare::compare(r, options).offset, 10);
    r.psi = Matrix<double>{{1, 2, 3, 5}, {4, 4, 4, 4}}, r.names = {"x", "1"};
    EXPECT_EQ(compare::compare(r, options).offset, 0);
}
/// Wampler's polynomial: a bound on theta alone leaves x1 with the wrong sign.
TEST(Warnings, NoComponentIsThePriorsByDefault) {
    Records r{.psi = Matrix<double>(6, 21), .y = Vector<double>(21), .names = std::vector<std::string>(6, "x")};
    for (Index k = 0; k < 21; ++k) {
        double power = 1, sum = 0;
        for (Index i = 0; i < 6; ++i, power *= double(k)) r.psi(i, k) = power, sum += power;
        r.y[k] = sum;
    }
    CompareOptions options;
    options.variants = {"ud"}, options.arithmetics = {"double"}, options.timings = false;
    Comparison const c = compare::compare(r, options);
    for (std::string const& theta : c.theta) EXPECT_NEAR(std::stod(theta), 1, 1e-2);
    EXPECT_LE(c.component_bias, 1e-2);
    EXPECT_GT(c.component_bias, 1e-5) << "the least such c";
}
TEST(Recommendation, NoneWhereStoringTheProblemSpoilsIt) {
    Made m;
    m.add("it", {13, 14, 15});
    Comparison c = m.comparison();
    RoundingEffect const good{"double", 1, 3, true, 5.0, 0.01, 0};
    c.rounding = {{"other", 0, 1, false, {}, 1, 1}, good};
    EXPECT_EQ(recommend(m.arithmetic, c).variant, "it");
    auto const why = [&](RoundingEffect const& s) {
        c.rounding.back() = s;
        EXPECT_EQ(recommend(m.arithmetic, c).variant, "");
        EXPECT_TRUE(recommend(m.arithmetic, c).too_short);
        return recommend(m.arithmetic, c).why;
    };
    RoundingEffect s = good;
    s.rank = 2;
    EXPECT_THAT(why(s), Names("rank 2 3"));
    s = good, s.in_range = false;
    EXPECT_THAT(why(s), Names("P0 range --p0"));
    s.forgetting = 0;
    EXPECT_THAT(why(s), Names("lambda zero"));
    s = good, s.prior_subnormal = true;
    EXPECT_THAT(why(s), Names("P0 range --p0"));
    s = good, s.data_in_range = false, s.rank = 0;
    EXPECT_THAT(why(s), Names("data range"));
    s = good, s.theta_digits = 0.4;
    EXPECT_THAT(why(s), Names("rounding data theta"));
    s = good, s.prior_bias = 0.0101;
    EXPECT_THAT(why(s), Names("prior theta"));
    s.prior_bias = std::nan("");
    EXPECT_THAT(why(s), Names("prior theta"));
}

TEST(Recommendation, NoneInAWindowThatDoesNotDetermineTheParameters) {
    Made m;
    m.add("it", {13, 14, 15});
    Comparison c = m.comparison();
    c.options.composition.window = 3;
    EXPECT_EQ(recommend(m.arithmetic, c).variant, "it");
    c.options.composition.window = 2;
    EXPECT_EQ(recommend(m.arithmetic, c).variant, "");
    EXPECT_EQ(recommend(m.arithmetic, c).why,
              "the prior, not the data, decides theta: 2 rows do not determine 3 parameters: a longer --window");
}

TEST(Spread, IsTheTenthHalfAndNinetyPercentPoint) {
    std::vector<std::optional<double>> digits;
    for (int i = 20; i >= 0; --i) digits.push_back(i);  // 0 ... 20: ranks 2, 10, 18
    EXPECT_EQ(spread_of(digits), (Spread{2, 10, 18}));
    digits.push_back(21);  // 22 numbers: ranks 2.1 down, 10.5 down, 18.9 up
    EXPECT_EQ(spread_of(digits), (Spread{2, 10, 19}));
    EXPECT_EQ(spread_of({1.26}), (Spread{1.3, 1.3, 1.3}));
    EXPECT_EQ(spread_of({1.24, 3.0}), (Spread{1.2, 1.2, 3.0}));
    EXPECT_EQ(spread_of({1.0, 2.0, 3.0}), (Spread{1, 2, 3}));
    double const none = -std::numeric_limits<double>::infinity();
    EXPECT_EQ(spread_of({std::nullopt, 2.0, std::nullopt}), (Spread{none, none, 2}));
    EXPECT_EQ(spread_of({-0.04}).low, 0);
}

TEST(Compare, TellsOfTheReferenceThenOfTheVariants) {
    Records r{.psi = Matrix<double>{{1, 2, 3, 5}}, .y = Vector<double>{{9, 11, 9, 12}}, .names = {"x"}};
    std::vector<std::string> stages;
    double last = 0;
    compare::compare(r, {.arithmetics = {"bfloat16", "float", "double", "quad"}, .timings = false},
                     [&](std::string_view stage, double part) {
                         if (stages.empty() || stages.back() != stage) stages.emplace_back(stage), last = 0;
                         EXPECT_GT(part, last) << stage;
                         last = part;
                         if (stage == "comparing") return;
                         EXPECT_EQ(stage, "reference");
                     });
    EXPECT_EQ(stages, (std::vector<std::string>{"reference", "comparing"}));
    EXPECT_EQ(last, 1);
}

TEST(Checkpoints, AreFortyEvenlySpreadAndEndWithTheLastRow) {
    EXPECT_EQ(checkpoints_of(1), std::vector<Index>{1});
    EXPECT_EQ(checkpoints_of(3), (std::vector<Index>{1, 2, 3}));
    for (Index rows : {39, 40, 41, 79, 100, 148, 4000}) {
        std::vector<Index> const at = checkpoints_of(rows);
        EXPECT_EQ(at.size(), size_t(std::min<Index>(rows, 40)));
        EXPECT_EQ(at.back(), rows);
        for (size_t i = 0; i < at.size(); ++i) {
            Index const step = at[i] - (i ? at[i - 1] : 0);
            EXPECT_GE(step, std::max<Index>(1, rows / 40));
            EXPECT_LE(step, rows / 40 + 1);
        }
    }
}

TEST(RowOrders, AreTheRecordsAndThreePermutationsOrOneWithForgetting) {
    auto const orders = row_orders(50, 1, 7);
    ASSERT_EQ(orders.size(), 4u);
    EXPECT_TRUE(orders[0].empty());
    std::set<std::vector<Index>> different;
    for (size_t i = 1; i < 4; ++i) {
        std::set<Index> const rows(orders[i].begin(), orders[i].end());
        EXPECT_EQ(orders[i].size(), 50u);
        EXPECT_EQ(rows.size(), 50u);
        EXPECT_EQ(*rows.rbegin(), 49);
        different.insert(orders[i]);
    }
    EXPECT_EQ(different.size(), 3u);
    EXPECT_EQ(row_orders(50, 1, 7), orders);
    EXPECT_NE(row_orders(50, 1, 8), orders);
    EXPECT_EQ(row_orders(50, 0.999, 7).size(), 1u);
    // Every row comes first equally often: 600 draws of 3, each of 5 rows 120 times of 600, give or take 10.
    std::array<int, 5> first{};
    for (std::uint64_t seed = 0; seed < 200; ++seed)
        for (size_t i = 1; i < 4; ++i) ++first[size_t(row_orders(5, 1, seed * 1000)[i][0])];
    for (int const n : first) EXPECT_NEAR(n, 120, 40);
}

TEST(Code, IsForTheShortestArithmeticOfTheHardwareThatHasARecommendation) {
    Made m;
    Comparison c = m.comparison();
    c.recommendations = {{"binary16", "a", ""}, {"float", "b", ""}, {"double", "c", ""}};
    ASSERT_NE(coded(c), nullptr);
    EXPECT_EQ(coded(c)->arithmetic, "float");
    c.recommendations[1].variant = "";
    EXPECT_EQ(coded(c)->arithmetic, "double");
    c.recommendations[2].variant = "";
    EXPECT_EQ(coded(c), nullptr);
    EXPECT_EQ(code(c), "");
}
TEST(Verdict, ArithmeticsWithoutARecommendationShareALine) {
    Made m;
    Comparison c = m.comparison();
    c.recommendations = {
        {"bfloat16", "", "no"}, {"float", "", "no"}, {"double", "", "other"}, {"quad", "", "no", true}};
    EXPECT_EQ(verdict(c),
              "in bfloat16, float  use none: no\nin double  use none: other\n"
              "in quad  has too few digits for this record: no\n");
}

}  // namespace
}  // namespace rlslab
