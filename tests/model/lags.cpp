// Lists of regressors: what is understood, what is refused and in which words, and the rows they make.
#include "tests/common/files.hpp"

#include <rlslab/model/regression.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

namespace rlslab {
namespace {

using files::message_of;
using Words = std::vector<std::string>;
using List = std::vector<Lagged>;

List list(Words const& words, std::string const& output = "y") { return lagged_of("--regressors", words, output); }
std::string refusal(Words const& words) {
    return message_of([&] { list(words); });
}

TEST(Lags, AreUnderstood) {
    EXPECT_EQ(list({"y[k-1]", "u[k-3]", "u[k]", "v"}), (List{{"y", 1}, {"u", 3}, {"u", 0}, {"v", 0, true}}));
    EXPECT_EQ(list({"y[k-1..k-3]", "u[k..k-1]"}), (List{{"y", 1}, {"y", 2}, {"y", 3}, {"u", 0}, {"u", 1}}));
    EXPECT_EQ(list({" u [ k - 2 ] ", "flow rate[k-1]"}), (List{{"u", 2}, {"flow rate", 1}}));
    EXPECT_EQ(list({"x[k-1][k]", "x[k-1][k-2]"}), (List{{"x[k-1]", 0}, {"x[k-1]", 2}}))
        << "a column whose name ends in brackets";
    EXPECT_EQ(list({"1", "2[k-1]"}, "3"), (List{{"1", 0, true}, {"2", 1}})) << "columns without a header";
    EXPECT_EQ(list({"u[k-1000000]"}), (List{{"u", 1000000}}));
    EXPECT_EQ(list({"u[k..k-1999]"}).size(), 2000u);
    EXPECT_EQ(text_of({"u", 3}), "u[k-3]");
    EXPECT_EQ(text_of({"u", 0}), "u[k]");
}

TEST(Lags, AreRefusedInOneLineThatSaysWhatWasExpected) {
    for (char const* word : {"", " ", "[k-1]", "u]", "u[]", "u[3]", "u[k-]", "u[k-x]", "u[k--1]", "u[k-1.5]", "u[k 1]",
                             "u[k-1..]", "u[k-1..3]", "u[k-1.k-2]"}) {
        std::string const said = refusal({"y[k-1]", word});
        EXPECT_TRUE(
            said.starts_with("--regressors: expected columns with lags, as in y[k-1],y[k-2],u[k-3..k-5], found \""))
            << word << ": " << said;
    }
    EXPECT_THAT(refusal({"y"}), Names("--regressors y y[k-1]"));
    EXPECT_THAT(refusal({"y[k]"}), Names("--regressors y[k] y[k-1]"));
    EXPECT_THAT(refusal({"y[k..k-2]"}), Names("--regressors y[k..k-2] y[k-1]"));
    EXPECT_THAT(refusal({"u[k+1]"}), Names("--regressors u[k+1] k-1"));
    EXPECT_THAT(refusal({"u[k-4..k-2]"}), Names("--regressors u[k-4..k-2] u[k-2..k-4]"));
    EXPECT_THAT(refusal({"u[k-1000001]"}), Names("--regressors u[k-1000001] 1000000"));
    EXPECT_THAT(refusal({"u[k-99999999999999999999]"}), Names("--regressors u[k-99999999999999999999] 1000000"));
    EXPECT_THAT(refusal({"u[k..k-2000]"}), Names("--regressors u[k..k-2000] 2000"));
    EXPECT_THAT(refusal({"u[k..k-1998]", "v", "w"}), Names("--regressors w 2000"));
    EXPECT_THAT(refusal({"u", "y[k-1]", "u[k]"}), Names("--regressors u[k]"));
    EXPECT_THAT(refusal({"u[k-1..k-4]", "u[k-2]"}), Names("--regressors u[k-2]"));
    EXPECT_THAT(refusal({}), Names("--regressors"));
}

Columns columns(Words names, std::vector<std::vector<double>> values) {
    std::vector<long> lines(values[0].size());
    return {.file = "data.csv", .names = std::move(names), .values = std::move(values), .lines = std::move(lines)};
}

TEST(LaggedRecords, AreTheRowsOfTheEquation) {
    auto data = columns({"u", "v", "y"}, {{1, 2, 3, 4, 5, 6}, {.1, .2, .3, .4, .5, .6}, {10, 20, 30, 40, 50, 60}});
    auto const r = lagged_records(data, list({"u[k-2]", "y[k-1]", "v"}), "y", true);
    EXPECT_EQ(r.names, (Words{"1", "u[k-2]", "y[k-1]", "v"}));
    EXPECT_EQ(r.presample, 2);
    EXPECT_EQ(r.rows(), 4);
    for (Index k = 0; k < 4; ++k) {
        EXPECT_EQ(r.psi.col(k),
                  (Vector<double>{{1, double(k + 1), 10.0 * double(k + 2), data.values[1][size_t(k + 2)]}}));
        EXPECT_EQ(r.y[k], 10.0 * double(k + 3));
    }
    data.header = false;
    EXPECT_EQ(lagged_records(data, list({"u[k-2]", "y[k-1]", "v"}), "y").names,
              (Words{"column u[k-2]", "column y[k-1]", "column v"}));
    EXPECT_THAT(message_of([&] { lagged_records(data, list({"u[k-1..k-4]"}), "y"); }), Names("data.csv 4 2 0"));
    EXPECT_THROW(lagged_records(data, {}, "y"), std::invalid_argument);
    EXPECT_THROW(lagged_records(data, {{"y", 0}}, "y"), std::invalid_argument);
    EXPECT_THROW(lagged_records(data, {{"u", -1}}, "y"), std::invalid_argument);
}

/// An ARX model is the list of its lags, row for row, whatever is missing; its past outputs have a minus.
RC_GTEST_PROP(LaggedRecords, ContainTheArxModels, ()) {
    Arx const model{.na = *rc::gen::inRange(0, 4), .nb = *rc::gen::inRange(0, 4), .delay = *rc::gen::inRange(0, 4)};
    auto const count = *rc::gen::inRange<size_t>(20, 60);
    std::vector<double> u(count), y(count);
    for (size_t k = 0; k < count; ++k)
        for (auto* x : {&u, &y})
            (*x)[k] = *rc::gen::inRange(0, 30) == 0 ? std::numeric_limits<double>::quiet_NaN()
                                                    : double(*rc::gen::inRange(-99, 99));
    List regressors;
    for (int i = 1; i <= model.na; ++i) regressors.push_back({"y", i});
    for (int i = 0; i <= model.nb; ++i) regressors.push_back({"u", model.delay + i});
    auto const data = columns({"u", "y"}, {u, y});
    Records arx, lagged;
    try {
        arx = arx_records(data, "u", "y", model);
    } catch (InputError const&) {
        RC_DISCARD("too few rows");
    }
    lagged = lagged_records(data, regressors, "y");
    arx.psi.topRows(model.na) *= -1;
    RC_ASSERT(lagged.psi == arx.psi);
    RC_ASSERT(lagged.y == arx.y);
    RC_ASSERT(lagged.skipped == arx.skipped);
    RC_ASSERT(lagged.presample == arx.presample);
}

}  // namespace
}  // namespace rlslab
