// The rules of the recommendation, each from both sides of its margin.
#include "tests/common/message.hpp"
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/score.hpp"
#include "src/lab/compare/words.hpp"

#include <deque>
#include <set>

namespace rlslab {
using namespace compare;
using namespace report;
namespace {

PerMeasure<Spread> all(Spread const& one) { return {one, one, one}; }

/// What a variant that does not exist has kept.
struct Form {
    std::string name;
    PerMeasure<Spread> spread;
    bool factor = true;
    char const* propagates = "covariance";
    std::optional<long> operations = 100;
    int broken = 0, broken_in_another_order = 0;
    Index block = 1;
};
using Change = std::function<void(Comparison&)>;

Arithmetic const* arithmetic_of(int digits) {
    static Arithmetic const wide{"double", 53, -1022, 1023, false, nullptr},
        narrow{"double", 8, -126, 127, false, nullptr};
    return digits == 53 ? &wide : &narrow;
}
/// A comparison of them in one arithmetic, with its recommendation.
Comparison compared(std::vector<Form> const& forms, Change const& change = {}, int digits = 53) {
    static std::deque<CatalogueEntry> entries;
    static std::deque<std::string> names;
    Comparison c{};
    c.rows = 100, c.size = 3, c.names = {"a", "b", "c"}, c.model.regressors = c.names;
    c.prior_bias = 1e-3;
    for (Form const& f : forms) {
        names.push_back(f.name);
        entries.push_back(
            {names.back(), arithmetic_of(digits), false, f.block, f.propagates, false, Family{}, nullptr, nullptr});
        Result& r = c.results.emplace_back(Result{.entry = &entries.back()});
        r.spread = f.spread, r.runs = 4, r.factor = f.factor, r.operations = f.operations;
        r.broken = f.broken, r.others.broken = f.broken_in_another_order;
    }
    if (change) change(c);
    c.recommendations = {recommend(*arithmetic_of(digits), c)};
    return c;
}
Recommendation named(std::vector<Form> const& forms, Change const& change = {}, int digits = 53) {
    return compared(forms, change, digits).recommendations.front();
}

struct Case {
    char const* what;
    std::vector<Form> forms;
    std::string named;
    char const* why = "";    // that is in the reason, where none is named
    bool too_short = false;  // where none is
    Change change = {};
    int digits = 53;
};
Spread const good{13, 14, 15}, fair{4, 5, 6};

TEST(Recommendation, IsOf) {
    auto const bias = [](double prior, double component, std::optional<double> p0 = {}) {
        return [=](Comparison& c) { c.prior_bias = prior, c.component_bias = component, c.options.p0 = p0; };
    };
    auto const window = [](Index rows) { return [=](Comparison& c) { c.options.composition.window = rows; }; };
    auto const stored = [](auto change) {  // in double; what another arithmetic stores does not count
        return [=](Comparison& c) {
            c.rounding = {{"other", 0, 1, false, {}, 1, 1}, {"double", 1, 3, true, 5.0, 0.01, 0}};
            change(c.rounding.back());
        };
    };
    Form const it{"it", all(good)}, ud_of_a_rig{"ud", all({-1.5, 0.8, 2.0})},
        carlson_of_it{"carlson", all({-1, 1.0, 2.6})};
    double const none = -std::numeric_limits<double>::infinity(), nan = std::nan("");
    using Effect = RoundingEffect;
    std::vector<Case> const cases{
        {"the least of the largest losses: four white columns, 60 000 rows, float, where ud keeps a digit of P less",
         {{"ud", {{5.3, 5.7, 6.1}, {5.1, 5.5, 5.9}, {3.9, 4.4, 5.2}}},
          {"carlson", {{5.3, 5.7, 6.1}, {5.1, 5.5, 5.9}, {3.4, 3.9, 4.9}}},
          {"symmetric", {{5.3, 5.8, 6.2}, {5.1, 5.6, 6.0}, {5.1, 5.4, 5.7}}, false}},
         "symmetric"},
        {"two that are alike: the first in the list", {{"one", all(good)}, {"two", all(good)}}, "one"},
        {"a tenth of a digit is none", {{"one", all(good)}, {"two", {{13, 14.1, 15}, good, good}}}, "two"},
        {"three digits of the worst component", {{"it", {{5, 6, 7}, {3.0, 6, 7}, {5, 6, 7}}}}, "it"},
        {"less than three",
         {{"it", {{5, 6, 7}, {2.9, 6, 7}, {5, 6, 7}}}, {"less", {fair, {2.5, 5, 6}, fair}}},
         "",
         "",
         true},
        {"a usable one before the more accurate one",
         {{"it", {{5, 6, 7}, {2.9, 6, 7}, {5, 6, 7}}}, {"usable", all({4, 4, 4}), false}},
         "usable"},
        {"the more accurate one of two usable ones",
         {{"it", {{5, 6, 7}, {3.0, 6, 7}, {5, 6, 7}}}, {"usable", all({4, 4, 4}), false}},
         "it"},
        {"half a digit of P", {{"it", {{5, 6, 7}, {5, 6, 7}, {0, 0.5, 3}}}}, "it"},
        {"less than half a digit of P", {{"it", {{5, 6, 7}, {5, 6, 7}, {0, 0.4, 3}}}}, "", "1 half digit P", true},
        {"nothing was tried", {}, ""},
        {"an error of ten times the answer at a tenth of the checkpoints: a two-motor rig in float",
         {ud_of_a_rig, carlson_of_it},
         "",
         "carlson -1.0 3 2.1e+05",
         true,
         [](Comparison& c) { c.condition = 2.1e5; }},
        {"no answer at a tenth", {{"carlson", {{-1, 1, 2}, {none, 1, 2}, {-1, 1, 2}}}}, "", "carlson no digits", true},
        {"a short arithmetic", {ud_of_a_rig}, "", "2.4 3", true, {}, 8},
        {"never one that broke down",
         {{"broken", all(good), true, "covariance", 1, 1}, {"sound", all(fair), false}},
         "sound"},
        {"nor in another order",
         {{"broken", all(good), true, "covariance", 1, 0, 1}, {"sound", all(fair), false}},
         "sound"},
        {"all broke down",
         {{"one", all(good), true, "covariance", 1, 0, 1}, {"other", all(fair), true, "covariance", 1, 4}},
         "",
         "2 variants",
         true},
        {"not one without an answer at a tenth, whatever its medians are",
         {{"none", {{none, 15, 16}, {4, 15, 16}, {14, 15, 16}}},
          {"steady", {{13.9, 14.6, 15}, {4, 14.6, 15}, {14, 14.6, 15}}}},
         "steady"},
        {"neither blocks nor a library",
         {{"block", all(good), true, "covariance", 100, 0, 0, 32}, {"library", all(good), true, "covariance", {}}},
         ""},
        {"a row before both",
         {{"block", all(good), true, "covariance", 100, 0, 0, 32},
          {"library", all(good), true, "covariance", {}},
          {"row", all(fair)}},
         "row"},
        {"a prior that moves theta by its hundredth", {it}, "it", "", false, bias(0.01, 0)},
        {"a prior that decides theta", {it}, "", "prior theta 0.01", false, bias(0.0101, 0)},
        {"a given prior that does", {it}, "", "prior --p0", false, bias(0.0101, 0, 1)},
        {"one of which nothing is known", {it}, "", "prior", false, bias(nan, 0)},
        {"a prior that moves a component by its tenth", {it}, "it", "", false, bias(0, 0.1)},
        {"a prior that decides a component", {it}, "", "prior component theta 0.1", false, bias(0, 0.101)},
        {"a window of three rows", {it}, "it", "", false, window(3)},
        {"one that does not determine theta", {it}, "", "prior 2 rows 3 parameters --window", false, window(2)},
        {"stored well", {it}, "it", "", false, stored([](Effect&) {})},
        {"rank 2 as stored", {it}, "", "rank 2 3", true, stored([](Effect& s) { s.rank = 2; })},
        {"P0 that is not in range", {it}, "", "P0 range --p0", true, stored([](Effect& s) { s.in_range = false; })},
        {"lambda that is zero", {it}, "", "lambda zero", true, stored([](Effect& s) {
             s.in_range = false, s.forgetting = 0;
         })},
        {"P0 among subnormal numbers", {it}, "", "P0 range --p0", true, stored([](Effect& s) {
             s.prior_subnormal = true;
         })},
        {"data beyond the range", {it}, "", "data range", true, stored([](Effect& s) {
             s.data_in_range = false, s.rank = 0;
         })},
        {"data that rounding spoils", {it}, "", "rounding data theta", true, stored([](Effect& s) {
             s.theta_digits = 0.4;
         })},
        {"a prior that decides theta as stored", {it}, "", "prior theta", true, stored([](Effect& s) {
             s.prior_bias = 0.0101;
         })},
        {"or may", {it}, "", "prior theta", true, stored([=](Effect& s) { s.prior_bias = nan; })},
    };
    for (Case const& one : cases) {
        Recommendation const r = named(one.forms, one.change, one.digits);
        EXPECT_EQ(r.variant, one.named) << one.what;
        EXPECT_EQ(r.too_short, one.too_short) << one.what;
        EXPECT_THAT(r.why, Names(one.why)) << one.what;
    }
}
TEST(Recommendation, CountsALossInEachMeasureAgainstTheBestOfIt) {
    for (auto const measure : PerMeasure<Spread>::all())
        for (double const lost : {0.1, 0.2, 0.3}) {
            PerMeasure<Spread> s = all(good);
            s.*measure = {13, 14 - lost, 15};
            std::vector<Form> forms{{"cheap", s, true, "covariance", 10},
                                    {"even", all({13, 13.8, 15})},  // the others are measured by the next
                                    {"not to be used", {good, {2.9, 14, 15}, good}, true, "covariance", 1}};
            EXPECT_EQ(named(forms).variant, lost <= 0.2 ? "cheap" : "even") << lost;
            forms.push_back({"broken", all({16, 16, 16}), true, "covariance", 100, 1});  // not by it
            EXPECT_EQ(named(forms).variant, lost <= 0.2 ? "cheap" : "even") << lost;
            EXPECT_NEAR(named(forms).losses.front().digits, std::min(lost, 0.2), 1e-9);
        }
}
/// 0.5 is not too far, 0.6 is: in any of the three measures, whatever its medians are.
TEST(Recommendation, NotOneWhoseLowIsMoreThanHalfADigitBehind) {
    for (auto const measure : PerMeasure<Spread>::all())
        for (double const lost : {0.5, 0.6}) {
            Form high{"high", all({14, 15.3, 16})}, steady{"steady", all({14, 15.0, 15.5})};
            (high.spread.*measure).low -= lost;
            EXPECT_EQ(named({high, steady}).variant, lost > 0.5 ? "steady" : "high") << lost;
            steady.spread.theta.low = 12;  // each is behind the other: the lesser loss again
            if (lost > 0.5) {
                EXPECT_EQ(named({high, steady}).variant, "high");
            }
        }
}
TEST(Recommendation, OfEqualLossesAFactorThenCovarianceThenFewerOperations) {
    std::vector<Form> order;
    for (bool const factor : {true, false})
        for (char const* const propagates : {"covariance", "information"})
            for (long const operations : {0, 1})
                order.push_back({std::to_string(order.size()), all(good), factor, propagates,
                                 (factor ? 100 : 50) / (*propagates == 'i' ? 2 : 1) + operations});
    while (!order.empty()) {
        std::string const first = order.front().name;
        EXPECT_EQ(named({order.rbegin(), order.rend()}).variant, first);
        order.erase(order.begin());
    }
}
TEST(Recommendation, TellsWhatItAndTheRunnerUpAndConventionalLose) {
    Form const equal{"ud", all({11, 11, 11})}, qr{"qr", {{10.6, 10.8, 11}, {11, 11, 11}, {10.5, 10.9, 11}}},
        conventional{"conventional", {{11, 11, 11}, {11, 11, 11}, {8, 8.2, 9}}, false};
    Form broken = conventional;
    broken.broken = 4;
    auto const said = [](std::vector<Form> const& forms) {
        return verdict(compared(forms, [](Comparison& c) {
            if (c.results.front().broken > 0) c.results.front().breakdown = Breakdown{129, Health::indefinite};
        }));
    };
    EXPECT_THAT(said({conventional, equal}), Names("100 next conventional 2.8 P"));
    EXPECT_THAT(said({conventional, equal, qr}), Names("next qr 0.2 theta conventional 2.8 P"));
    EXPECT_THAT(said({broken, equal, qr}), Names("0.2 theta conventional indefinite 129"));
    std::vector<Form> const four{
        broken, equal, qr, {"joseph", {{11.1, 11.1, 11.1}, {10, 10, 10}, {10, 10, 10}}, false}};
    EXPECT_THAT(said(four), Names("ud 0.1 next qr 0.3 theta conventional"));
    EXPECT_EQ(named(four).losses.size(), 3u);
    EXPECT_THAT(said({equal, {"carlson", all({11, 11, 11}), true, "covariance", 101}}), Names("next carlson good"));
    EXPECT_THAT(said({{"conventional", all({11, 11, 11})}}), testing::AllOf(Names("100"), testing::Not(Names("next"))));
}
TEST(Recommendation, TheCheapestFactorWithinHalfADigitStandsBeside) {
    auto const beside = [](double loss, long operations, bool factor, double low) {
        Comparison const c = compared({{"best", all({10, 11, 12})},
                                       {"other", all({low, 11 - loss, 12}), factor, "covariance", operations},
                                       {"far", all({5, 6, 7}), true, "covariance", 1}});
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
            Recommendation const r =
                named({{"ud", all({10, 11, 12})}, {"information", all({10, 11 - loss, 12}), false, "information"}},
                      [&](Comparison& c) {
                          if (exact) c.exact = {{"double", 4096}};
                      });
            EXPECT_EQ(r.variant, exact && loss < 0.55 ? "information" : "ud");
            EXPECT_EQ(r.exact_rows, r.variant == "information" ? 4096 : 0);
        }
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
    Comparison c{};
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
    Comparison c{};
    c.recommendations = {
        {"bfloat16", "", "no"}, {"float", "", "no"}, {"double", "", "other"}, {"quad", "", "no", true}};
    EXPECT_EQ(verdict(c),
              "in bfloat16, float  use none: no\nin double  use none: other\n"
              "in quad  has too few digits for this record: no\n");
}

}  // namespace
}  // namespace rlslab
