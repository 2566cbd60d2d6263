// Regressors hold what the model's equation says, and no row that misses a value. Lists of regressors: what is
// understood, what is refused and in which words, and the rows they make.
#include "tests/common/files.hpp"

#include <rlslab/model/regression.hpp>

#include <rapidcheck/gtest.h>

#include <limits>

namespace rlslab {
namespace {

using files::message_of;
using Words = std::vector<std::string>;
using Numbers = std::vector<double>;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

Columns columns(Words names, std::vector<Numbers> values) {
    std::vector<long> lines(values[0].size());
    return {.file = "data.csv", .names = std::move(names), .values = std::move(values), .lines = std::move(lines)};
}

/// A matrix as people write it: one row of regressors after the other.
Matrix<double> rows(std::vector<Numbers> const& psi) {
    Matrix<double> matrix(psi[0].size(), psi.size());
    for (std::size_t k = 0; k < psi.size(); ++k)
        matrix.col(Index(k)) = Vector<double>::Map(psi[k].data(), matrix.rows());
    return matrix;
}
Numbers numbers(Vector<double> const& y) { return {y.begin(), y.end()}; }

TEST(LinearRecords, AreTheColumnsWithTheInterceptFirst) {
    auto const data = columns({"y", "a", "b"}, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}});
    auto const plain = linear_records(data, {"b", "a"}, "y");
    EXPECT_EQ(plain.names, (Words{"b", "a"}));
    EXPECT_EQ(plain.psi, rows({{7, 4}, {8, 5}, {9, 6}}));
    EXPECT_EQ(numbers(plain.y), (Numbers{1, 2, 3}));
    EXPECT_EQ(plain.skipped, 0);

    auto const with = linear_records(data, {"b", "a"}, "y", true);
    EXPECT_EQ(with.names, (Words{"1", "b", "a"}));
    EXPECT_EQ(with.psi, rows({{1, 7, 4}, {1, 8, 5}, {1, 9, 6}}));
}

TEST(LinearRecords, NumberedColumnsAreNotTakenForTheIntercept) {
    auto data = columns({"1", "2"}, {{4, 5, 6}, {7, 8, 9}});
    data.header = false;
    EXPECT_EQ(linear_records(data, {"1"}, "2", true).names, (Words{"1", "column 1"}));
}

TEST(LinearRecords, SkipRowsThatMissAValueOfTheirOwn) {
    auto const data = columns({"a", "z", "y"}, {{1, missing, 3, 4}, {missing, 1, missing, 1}, {1, 2, missing, 4}});
    auto const records = linear_records(data, {"a"}, "y");
    EXPECT_EQ(records.psi, rows({{1}, {4}}));
    EXPECT_EQ(numbers(records.y), (Numbers{1, 4}));
    EXPECT_EQ(records.skipped, 2);
    EXPECT_EQ(records.rows(), 2);
}

TEST(ArxRecords, AreTheEquation) {
    Numbers const u{1, 2, 3, 4, 5, 6}, y{10, 20, 30, 40, 50, 60};
    auto const records = arx_records(u, y, {.na = 2, .nb = 1});
    EXPECT_EQ(records.names, (Words{"a1", "a2", "b0", "b1"}));
    EXPECT_EQ(arx_records(u, y, {.na = 1, .nb = 0}).psi, rows({{-10, 2}, {-20, 3}, {-30, 4}, {-40, 5}, {-50, 6}}));
    EXPECT_EQ(records.presample, 2);
    EXPECT_EQ(records.skipped, 0);
    EXPECT_EQ(numbers(records.y), (Numbers{30, 40, 50, 60}));
    EXPECT_EQ(records.psi, rows({{-20, -10, 3, 2}, {-30, -20, 4, 3}, {-40, -30, 5, 4}, {-50, -40, 6, 5}}));
}

TEST(ArxRecords, TakeADelayAndAnInterceptLast) {
    Numbers const u{1, 2, 3, 4, 5, 6, 7}, y{10, 20, 30, 40, 50, 60, 70};
    auto const records = arx_records(u, y, {.na = 1, .nb = 1, .delay = 2, .intercept = true});
    EXPECT_EQ(records.names, (Words{"a1", "b0", "b1", "c"}));
    EXPECT_EQ(records.psi, rows({{-30, 2, 1, 1}, {-40, 3, 2, 1}, {-50, 4, 3, 1}, {-60, 5, 4, 1}}));
    EXPECT_EQ(numbers(records.y), (Numbers{40, 50, 60, 70}));
    EXPECT_EQ(records.presample, 3);
    auto const impulse_response = arx_records(u, y, {.na = 0, .nb = 0});
    EXPECT_EQ(impulse_response.rows(), 7);
    EXPECT_EQ(impulse_response.names, (Words{"b0"}));
}

TEST(ArxRecords, SkipEveryRowThatNeedsAMissingValue) {
    Numbers const u{1, 2, 3, 4, 5, missing, 7}, y{1, 2, missing, 4, 5, 6, 7};
    auto const records = arx_records(u, y, {.na = 1, .nb = 0});  // k = 2 and 3 for y, 5 for u
    EXPECT_EQ(records.psi, rows({{-1, 2}, {-4, 5}, {-6, 7}}));
    EXPECT_EQ(numbers(records.y), (Numbers{2, 5, 7}));
    EXPECT_EQ(records.skipped, 3);
    EXPECT_EQ(records.presample, 1);
}

RC_GTEST_PROP(ArxRecords, EveryRowIsKeptSkippedOrLeadIn, ()) {
    Arx const model{.na = *rc::gen::inRange(0, 4),
                    .nb = *rc::gen::inRange(0, 4),
                    .delay = *rc::gen::inRange(0, 4),
                    .intercept = *rc::gen::arbitrary<bool>()};
    auto const count = *rc::gen::inRange<std::size_t>(5, 60);
    // y is a row's number and u its negative, so a regressor shows which values were taken; one in twelve is missing.
    Numbers u(count), y(count);
    for (std::size_t k = 0; k < count; ++k) {
        y[k] = *rc::gen::inRange(0, 12) == 0 ? missing : double(k);
        u[k] = *rc::gen::inRange(0, 12) == 0 ? missing : -double(k);
    }
    Records records;
    try {
        records = arx_records(u, y, model);
    } catch (InputError const&) {
        RC_DISCARD("too few rows");
    }
    RC_ASSERT(records.rows() + records.skipped + records.presample == Index(count));
    RC_ASSERT(records.y.size() == records.rows());
    RC_ASSERT(records.parameters() == model.size() && Index(records.names.size()) == model.size());
    for (Index n = 0; n < records.rows(); ++n) {
        double const k = records.y[n];
        if (n > 0) {  // || in an RC_ASSERT evaluates both sides
            RC_ASSERT(k > records.y[n - 1]);
        }
        Index i = 0;
        for (; i < model.na; ++i) RC_ASSERT(records.psi(i, n) == -(k - double(i) - 1));
        for (; i <= model.na + model.nb; ++i) RC_ASSERT(records.psi(i, n) == -(k - model.delay - double(i - model.na)));
        if (model.intercept) {
            RC_ASSERT(records.psi(i, n) == 1);
        }
    }
}

TEST(RecordsRefuse, ModelsThatAreNone) {
    Numbers const u(9), y(9);
    auto const arx = [&](Arx const& model) { return message_of([&] { arx_records(u, y, model); }); };
    EXPECT_THAT(message_of([] { arx_of_order(0); }), Names("order 1 0"));
    EXPECT_THAT(message_of([] { arx_of_order(-3); }), Names("order 1 -3"));
    EXPECT_THAT(arx({.na = -1, .nb = 2}), Names("na 0 -1"));
    EXPECT_THAT(arx({.na = 1, .nb = -2}), Names("nb 0 -2"));
    EXPECT_THAT(arx({.na = 1, .nb = 1, .delay = -1}), Names("delay 0 -1"));
    EXPECT_EQ(arx_of_order(3).size(), 7);
    EXPECT_THROW(arx_records(u, Numbers(8), {.na = 1, .nb = 1}), std::invalid_argument);
}

TEST(RecordsRefuse, TooFewRows) {
    auto const data = columns({"u", "y"}, {{1, 2, missing, 4, 5}, {1, 2, 3, 4, missing}});
    auto const arx = [&](Arx const& model) { return message_of([&] { arx_records(data, "u", "y", model); }); };
    EXPECT_THAT(arx(arx_of_order(3)), Names("data.csv 7 5"));
    EXPECT_THAT(arx({.na = 2'000'000'000, .nb = 2'000'000'000, .delay = 2'000'000'000}),
                Names("data.csv 4000000001 5"));
    EXPECT_THAT(arx({.na = 1, .nb = 1}), Names("data.csv 3 1"));
    EXPECT_THAT(arx({.na = 0, .nb = 0, .delay = 2'000'000'000}), Names("data.csv 1 0 5"));
    auto const other = columns({"a", "b", "c", "y"}, {{1, missing, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}});
    EXPECT_THAT(message_of([&] { linear_records(other, {"a", "b", "c"}, "y"); }), Names("data.csv 3 2 1"));
    EXPECT_THAT(message_of([&] { linear_records(other, {"a", "b", "c"}, "y", true); }), Names("data.csv 4 3"));
}

TEST(RecordsRefuse, ColumnsInTwoRoles) {
    auto const data = columns({"u", "y"}, {{1, 2, 3}, {1, 2, 3}});
    EXPECT_THAT(message_of([&] { linear_records(data, {}, "y"); }), Names("data.csv"));
    EXPECT_THAT(message_of([&] { linear_records(data, {"u", "y"}, "y"); }), Names("data.csv y"));
    EXPECT_THAT(message_of([&] { linear_records(data, {"u", "u"}, "y"); }), Names("data.csv u"));
    EXPECT_THAT(message_of([&] { arx_records(data, "u", "u", {.na = 1, .nb = 1}); }), Names("data.csv u"));
    EXPECT_THROW(linear_records(data, {"z"}, "y"), std::invalid_argument);
    EXPECT_THROW(arx_records(data, "u", "z", {.na = 1, .nb = 1}), std::invalid_argument);
}

// --- lists of regressors ---------------------------------------------------------------------------------------------

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
        for (auto* x : {&u, &y}) (*x)[k] = *rc::gen::inRange(0, 30) == 0 ? missing : double(*rc::gen::inRange(-99, 99));
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
