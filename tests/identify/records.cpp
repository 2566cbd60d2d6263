// Records that identify takes although something is not there: rows that miss a value, and series without an input.
#include "identify/structure.hpp"
#include "identify/text.hpp"
#include "tests/common/files.hpp"

#include <rlslab/model/fit.hpp>
#include <rlslab/model/lags.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rlslab {
using namespace identify;
using namespace report;
namespace {

using testing::HasSubstr;

/// NaN: an empty cell.
std::string csv(Signal const& u, Signal const& y) {
    std::string out = "u,y";
    for (size_t k = 0; k < u.size(); ++k)
        out += fmt::format("\n{},{}", u[k], std::isnan(y[k]) ? "" : fmt::format("{}", y[k]));
    return out + '\n';
}

class IdentifyRecords : public testing::Test {
protected:
    files::Folder const folder;
    Signal const u = white_noise(300, Seed{1}),
                 y = simulate({.a = {-0.8}, .b = {{0, 0.5}}, .delay = 0, .c = 0}, {u}, white_noise(300, Seed{2}));
    std::string const file = folder.file(csv(u, y));
};

/// A series without an input, beside a batch fit of the same rows. The equation has the past outputs on its left.
TEST_F(IdentifyRecords, PastOutputsAloneAreAModel) {
    Identified const m = identify::identify(file, {.output = "y", .regressors = {"y[k-1..k-3]"}, .detrend = false});
    EXPECT_EQ(equation_text(m.terms, "y"), "y[k] + a1 y[k-1] + a2 y[k-2] + a3 y[k-3] = e[k]");
    EXPECT_EQ(m.poles.size(), 3u);
    EXPECT_TRUE(m.excitation.empty() && m.gain.empty() && m.zeros.empty());
    EXPECT_GT(m.held_out_one_step, 0);
    EXPECT_TRUE(std::isnan(m.held_out_simulated)) << "nothing drives a simulation";
    Columns const columns = read_columns(file, {"y"});
    Records const rows = lagged_records(columns, lagged_of("", {"y[k-1..k-3]"}, "y"), "y");
    Vector<double> const theta = fit({.psi = rows.psi.leftCols(197), .y = rows.y.head(197), .names = {}}).theta;
    for (Index i = 0; i < 3; ++i)
        EXPECT_NEAR(m.parameters[size_t(i)].value, -theta[i], 1e-3 * m.parameters[size_t(i)].sd);
    EXPECT_THAT(as_page(m), HasSubstr("figure id=\"poles\""));
}
/// Rows that miss a value are left out of the fit, of the orders and of what is tracked, and keep their places.
TEST_F(IdentifyRecords, MissingValuesAreSkipped) {
    Signal gaps = y;
    gaps[50] = gaps[250] = NAN;
    std::string const text = csv(u, gaps);
    IdentifyOptions options{.inputs = {"u"}, .output = "y", .order = 1, .detrend = false};
    options.composition.window = 100;
    Identified const m = identify::identify(folder.file(text, "gaps.csv"), options);
    EXPECT_EQ(m.fitted, 199 - 2);
    EXPECT_EQ(m.skipped, 4);
    EXPECT_THAT(as_table(m), Names("300 197 100 4"));
    Records rows{.psi = Matrix<double>(3, 197), .y = Vector<double>(197), .names = {}};
    Index at = 0;
    for (size_t k = 1; k < 200; ++k)
        if (k != 50 && k != 51) {
            rows.psi.col(at) << -y[k - 1], u[k], u[k - 1];
            rows.y[at++] = y[k];
        }
    Vector<double> const theta = fit(rows).theta;
    for (Index i = 0; i < 3; ++i)
        EXPECT_NEAR(m.parameters[size_t(i)].value, theta[i], 1e-3 * m.parameters[size_t(i)].sd);
    ASSERT_EQ(m.measured.size(), 299u);
    EXPECT_TRUE(std::isnan(m.one_step[49]) && std::isnan(m.one_step[50]) && !std::isnan(m.one_step[51]));
    EXPECT_FALSE(std::isnan(m.held_out_one_step)) << "of what was measured";
    ASSERT_TRUE(m.tracked);
    EXPECT_EQ(m.tracked->rows.size(), 295u);
    EXPECT_EQ(m.tracked->rows[48].row, 50);
    EXPECT_EQ(m.tracked->rows[49].row, 53);
    options.order = 0;
    EXPECT_EQ(identify::identify(folder.file(text, "gaps.csv"), options).choice.rows, 190 - 11)
        << "order 10, its lags and the output";
    EXPECT_THAT(as_page(m), testing::Not(testing::ContainsRegex("[^a-z_]nan[^a-z_]")));
}
TEST_F(IdentifyRecords, WithoutARowAreRefused) {
    Signal every_third = y;
    for (size_t k = 0; k < y.size(); k += 3) every_third[k] = NAN;
    auto const said = [&](std::string const& text, IdentifyOptions options) {
        options.inputs = {"u"}, options.output = "y";
        return folder.without(files::message_of([&] { identify::identify(folder.file(text, "gaps.csv"), options); }));
    };
    EXPECT_THAT(said(csv(u, every_third), {.order = 2}), Names("gaps.csv 2 6 0"));
    EXPECT_EQ(said(csv(u, every_third), {.order = 1}), "no error");
    std::string no_input = "u,y\n";
    for (double const v : y) no_input += fmt::format(",{}\n", v);
    EXPECT_THAT(said(no_input, {.order = 1}), Names("gaps.csv u"));
}
/// An error that does not matter is stated in units of each regressor: units of u move no digit and no word. Little
/// noise, slow poles.
TEST_F(IdentifyRecords, UnitsChangeNothing) {
    Signal noise = white_noise(300, Seed{3}), small = u;
    for (double& x : noise) x *= 1e-9;
    for (double& x : small) x *= 0x1p-40;
    Signal const slow =
        simulate({.a = {-2.91, 2.8226, -0.912576}, .b = {{0, 1e-3, 2e-3, 1e-3}}, .delay = 0, .c = 0}, {u}, noise);
    auto const of = [&](Signal const& input) {
        return identify::identify(folder.file(csv(input, slow), "slow.csv"),
                                  {.inputs = {"u"}, .output = "y", .order = 3});
    };
    Identified const one = of(u), other = of(small);
    EXPECT_EQ(one.c, other.c);
    EXPECT_EQ(one.prior_effect, other.prior_effect);
    EXPECT_EQ(one.warnings(), other.warnings());
    for (size_t i : {0u, 1u, 2u}) EXPECT_EQ(one.parameters[i].value, other.parameters[i].value);
    for (size_t i : {3u, 4u, 5u, 6u}) EXPECT_EQ(one.parameters[i].value, 0x1p-40 * other.parameters[i].value);
}

}  // namespace
}  // namespace rlslab
