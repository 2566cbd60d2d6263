// The functions of claims, checked by hand: each number, both ends of an interval, each group; and the cells that a table accepts.
#include "studies/engine/findings.hpp"
#include "studies/engine/scenarios.hpp"

#include <rlslab/reference/certified.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rlslab {
namespace {

using testing::ElementsAre;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Table column_of(std::vector<double> const& values) {
    Table out({"x"});
    for (double const v : values) out.add({v});
    return out;
}

TEST(Numbers, TheMedianIsTheMiddleOrTheMeanOfTheMiddleTwo) {
    EXPECT_EQ(median(column_of({3, 1, 2}).numbers("x")), 2);
    EXPECT_EQ(median(column_of({8, 1, 2, 4}).numbers("x")), 3);
    EXPECT_EQ(median("x")(column_of({8, 1})), 4.5);
    EXPECT_EQ(median("x")(column_of({1.5e308, 1.5e308})), 1.5e308) << "their sum overflows";
    EXPECT_EQ(median("x")(column_of({nan, 1, 2})), 2) << "NaN is worse than any number";
    EXPECT_TRUE(std::isnan(median("x")(column_of({nan, nan, 1}))));
    EXPECT_TRUE(std::isnan(median("x")(column_of({}))));
}
TEST(Numbers, TheLeastTheGreatestAndTheRootMeanSquare) {
    EXPECT_EQ(least("x")(column_of({3, -4, 2})), -4);
    EXPECT_EQ(greatest("x")(column_of({3, -4, 2})), 3);
    EXPECT_TRUE(std::isnan(least("x")(column_of({3, nan}))));
    EXPECT_TRUE(std::isnan(greatest("x")(column_of({nan, 3}))));
    EXPECT_EQ(root_mean_square("x")(column_of({1, 7, -1, -7})), 5);
}
TEST(Numbers, SlopesAreThoseOfTheirScales) {
    Table t({"x", "y"});
    for (double const x : {1.0, 2.0, 4.0}) t.add({x, 3 * x * x});
    EXPECT_NEAR(slope("x", "y")(t), 2, 1e-14);
    EXPECT_NEAR(linear_slope("x", "y")(t), 72.0 / (14.0 / 3), 1e-13);  // about the means 7/3 and 21
    Table decay({"k", "e"});
    for (int k = 0; k < 5; ++k) decay.add({double(k), std::ldexp(7.0, -k)});
    EXPECT_NEAR(rate("k", "e")(decay), -0.69314718055994531, 1e-14);
}

TEST(Findings, HoldAtBothEndsOfTheIntervalAndNotBeyond) {
    Table const t = column_of({2});
    EXPECT_TRUE(within(t, {}, greatest("x"), 2, 3).holds);
    EXPECT_TRUE(within(t, {}, greatest("x"), 1, 2).holds);
    EXPECT_FALSE(within(t, {}, greatest("x"), std::nextafter(2, 3), 3).holds);
    EXPECT_FALSE(within(t, {}, greatest("x"), 1, std::nextafter(2, 1)).holds);
}
TEST(Findings, HoldOnlyWhereEveryGroupDoes) {
    for (int outside = 0; outside < 3; ++outside) {
        Table t({"word", "x"});
        for (int i = 0; i < 3; ++i) t.add({std::string(1, char('a' + i)), i == outside ? 9.0 : 1.0 + i});
        Finding const f = within(t, {"word"}, greatest("x"), 0, 5);
        EXPECT_FALSE(f.holds) << outside;
        EXPECT_EQ(f.measured, outside == 0 ? "2 (b) ... 9 (a)" : outside == 1 ? "1 (a) ... 9 (b)" : "1 (a) ... 9 (c)");
        EXPECT_TRUE(within(t, {"word"}, greatest("x"), 0, 9).holds);
    }
    Table t({"word", "x"});
    t.add({"a", nan}), t.add({"b", 1.0});
    EXPECT_FALSE(within(t, {"word"}, greatest("x"), 0, 5).holds);
    EXPECT_EQ(within(t, {"word"}, greatest("x"), 0, 5).measured, "not a number (a)");
}
TEST(Findings, AWordStandsEverywhereOrNot) {
    Table t({"health"});
    t.add({"sound"}), t.add({"sound"});
    EXPECT_TRUE(everywhere(t, "health", "sound").holds);
    t.add({"indefinite"});
    EXPECT_FALSE(everywhere(t, "health", "sound").holds);
    EXPECT_EQ(everywhere(t, "health", "sound").measured, "2 of 3 are \"sound\"");
}

TEST(Tables, RefuseEveryCellThatWouldNeedQuotes) {
    for (char const* text : {"a,b", "a\"b", "a\nb", "a\rb"})
        EXPECT_THROW(csv_line({text}), std::logic_error) << testing::PrintToString(text);
    EXPECT_EQ(csv_line({"a b", 0.5, nan, ""}), "a b,0.5,nan,");
}
TEST(Tables, ACellIsANumberOnlyAsAWhole) {
    Table t({"a", "b", "c", "d", "e"});
    t.add_line("3x,1e3,-0.5,1 2,");
    EXPECT_THAT(t.rows().front(), ElementsAre(Cell("3x"), Cell(1000.0), Cell(-0.5), Cell("1 2"), Cell("")));
    EXPECT_THROW(t.numbers("a"), std::logic_error);
    EXPECT_THROW(t.add_line("1,2,3,4"), std::logic_error) << "a cell is missing";
    EXPECT_THROW(t.add_line("1,2,3,4,5,6"), std::logic_error);
}

/// Every tap has variance 1 and correlation `pole` with the next; what drives it the variance 1 - pole^2.
TEST(Scenarios, ADelayLineIsStationaryWithVarianceOne) {
    for (double const pole : {0.0, 0.9, -0.6}) {
        Index const rows = 40000;
        Records const r = delay_line(3, rows, pole, Seed{7});
        double square = 0, product = 0;
        for (Index k = 0; k < rows; ++k) square += r.psi(0, k) * r.psi(0, k), product += r.psi(0, k) * r.psi(1, k);
        // 4 standard deviations: var of the mean square = 2 (1 + pole^2) / (1 - pole^2) / rows.
        double const allowed = 4 * std::sqrt(2 * (1 + pole * pole) / (1 - pole * pole) / double(rows));
        EXPECT_NEAR(square / double(rows), 1, allowed) << pole;
        EXPECT_NEAR(product / square, pole, 0.02) << pole;
        for (Index k = 1; k < 100; ++k)
            for (Index i = 1; i < 3; ++i) EXPECT_EQ(r.psi(i, k), r.psi(i - 1, k - 1));
    }
}
TEST(Scenarios, GradedRegressorsHaveTheConditionNumberThatWasAskedFor) {
    for (Index const size : {1, 2, 5})
        for (double const kappa : {10.0, 1e6})
            EXPECT_NEAR(condition(graded(size, 40, kappa, Seed{8}), 1) / (size > 1 ? kappa : 1), 1, 1e-8) << size << " " << kappa;
}

}  // namespace
}  // namespace rlslab
