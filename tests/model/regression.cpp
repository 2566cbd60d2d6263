// Regressors hold what the model's equation says, and no row that misses a value.
#include "tests/common/files.hpp"

#include <rlslab/model/regression.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

namespace rlslab {
namespace {

namespace fs = std::filesystem;
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

TEST(Demo, SalesFollowTheirIndicator) {
    auto const data = read_columns(fs::path(RLSLAB_SOURCE_DIR) / "studies/data/sales.csv", {"lead", "sales"});
    auto const records = arx_records(data, "lead", "sales", {.na = 1, .nb = 1, .delay = 3, .intercept = true});
    EXPECT_EQ(records.rows(), 146);
    EXPECT_EQ(records.presample, 4);
}

/// The files of studies/data/nist as records, and their exact solutions.
struct Nist {
    fs::path folder = fs::path(RLSLAB_SOURCE_DIR) / "studies/data/nist";
    nlohmann::json solutions = nlohmann::json::parse(std::ifstream(folder / "solutions.json"));
    Records records(std::string const& name) const {
        CsvFile file(folder / (name + ".csv"));
        auto regressors = file.names();
        auto const data = file.read(regressors);
        regressors.pop_back();
        return linear_records(data, regressors, "y");
    }
    Vector<double> theta(std::string const& name, std::string const& which = "theta") const {
        auto const text = solutions.at(name).at(which).get<Words>();
        Vector<double> theta(text.size());
        for (std::size_t i = 0; i < text.size(); ++i) theta[Index(i)] = std::stod(text[i]);
        return theta;
    }
};

double residual_sum(Records const& records, Vector<double> const& theta) {
    return (records.y - records.psi.transpose() * theta).squaredNorm();
}

TEST(NistData, LeaveTheCertifiedResidualSums) {
    Nist const nist;
    // Rounding theta and psi' theta moves residuals of about 200 by some 1e-9; a mistyped digit moves the sum far more.
    EXPECT_NEAR(residual_sum(nist.records("longley"), nist.theta("longley")), 836424.055505915, 1e-2);
    for (auto const& [name, sum] : {std::pair{"wampler1", 0.},
                                    {"wampler3", 83554268.},
                                    {"wampler4", 835542680000.},
                                    {"wampler5", 8355426800000000.}})
        EXPECT_EQ(residual_sum(nist.records(name), nist.theta(name)), sum) << name;  // integers throughout
    EXPECT_LT(residual_sum(nist.records("wampler2"), nist.theta("wampler2")), 1e-24);
    EXPECT_NEAR(residual_sum(nist.records("filip"), nist.theta("filip", "theta_stored")), 0.795851382172941e-3, 1e-9);
}

TEST(NistData, FilipHoldsTheBitsOfRepeatedProducts) {
    auto const filip = Nist().records("filip");
    ASSERT_EQ(filip.parameters(), 11);
    ASSERT_EQ(filip.rows(), 82);
    for (Index k = 0; k < 82; ++k) {
        EXPECT_EQ(filip.psi(0, k), 1);
        for (Index j = 1; j < 11; ++j) EXPECT_EQ(filip.psi(j, k), filip.psi(j - 1, k) * filip.psi(1, k));
    }
}

}  // namespace
}  // namespace rlslab
