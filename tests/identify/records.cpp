// Records that identify takes although something is not there: rows that miss a value, and series without an input.
#include "tests/identify/options.hpp"

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
/// An order, na, and the list of past outputs are one model; every output names it without an input.
TEST_F(IdentifyRecords, WithoutAnInputAnOrderIsOneOfPastOutputs) {
    auto const run = [&](IdentifyOptions options) {
        options.output = "y";
        return identify::identify(file, options);
    };
    Identified const by_order = run({.order = 3}), by_na = run({.na = 3}),
                     by_list = run({.regressors = {"y[k-1..k-3]"}});
    ASSERT_EQ(by_order.parameters.size(), 4u);
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(by_order.parameters[i].value, by_list.parameters[i].value);
        EXPECT_EQ(by_na.parameters[i].value, by_list.parameters[i].value);
        EXPECT_EQ(by_na.parameters[i].sd, by_list.parameters[i].sd);
    }
    EXPECT_EQ(by_order.structure, "order 3");
    EXPECT_EQ(by_na.structure, "na = 3");
    std::string const table = as_table(by_order), page = as_page(by_order);
    EXPECT_THAT(table, HasSubstr("no input: y is predicted from its own past alone"));
    for (std::string const& text : {table, page}) EXPECT_THAT(text, testing::Not(HasSubstr("simulated")));
    EXPECT_THAT(page, testing::Not(HasSubstr("figure id=\"step\"")));
    nlohmann::json const json = nlohmann::json::parse(as_json(by_order));
    EXPECT_TRUE(json["inputs"].empty() && json["output"]["simulated"].is_null());
    EXPECT_EQ(json["modes"].size(), by_order.modes.size());
}
/// Of a known series of order 2 the order is found, and its parameters lie within their intervals.
TEST_F(IdentifyRecords, WithoutAnInputAnOrderIsChosen) {
    Signal const e = white_noise(900, Seed{5});
    Signal series = e;
    for (size_t k = 2; k < series.size(); ++k) series[k] += 1.2 * series[k - 1] - 0.6 * series[k - 2];
    std::string text = "y";
    for (double const v : series) text += fmt::format("\n{}", v);
    std::string const of_series = folder.file(text + '\n', "series.csv");
    for (bool const detrend : {true, false}) {
        Identified const m = identify::identify(of_series, {.output = "y", .max_order = 6, .detrend = detrend});
        EXPECT_EQ(m.order, 2);
        EXPECT_EQ(m.choice.fits.size(), 7u);
        EXPECT_EQ(m.choice.fits[0].parameters, Index(detrend));
        EXPECT_EQ(m.choice.static_p, 1) << "nothing but the constant";
        EXPECT_NEAR(m.parameters[0].value, -1.2, 4 * m.parameters[0].sd);
        EXPECT_NEAR(m.parameters[1].value, 0.6, 4 * m.parameters[1].sd);
        EXPECT_NEAR(m.choice.fits[2].J, m.sigma2 * m.freedom, 0.1 * m.choice.fits[2].J) << "of fewer rows";
    }
    Identified const noise = identify::identify(file, {.output = "u"});
    EXPECT_THAT(noise.warnings(), testing::Contains(HasSubstr("the past of u predicts nothing")));
}
/// A simulation stops where an input is missing and begins anew from measured outputs; it is as good as without gaps.
TEST_F(IdentifyRecords, ASimulationGoesOnBehindAMissingInput) {
    Signal gaps = u;
    gaps[230] = gaps[260] = NAN;
    std::string text = "u,y";
    for (size_t k = 0; k < u.size(); ++k)
        text += fmt::format("\n{},{}", std::isnan(gaps[k]) ? "NA" : fmt::format("{}", gaps[k]), y[k]);
    IdentifyOptions const options{.inputs = {"u"}, .output = "y", .order = 1, .detrend = false};
    Identified const whole = identify::identify(file, options),
                     m = identify::identify(folder.file(text + '\n', "gaps.csv"), options);
    ASSERT_EQ(values(m), values(whole));
    ASSERT_TRUE(std::isfinite(m.held_out_simulated));
    for (size_t k = 199; k < 299; ++k) {  // measured begins with sample 1
        bool const gap = k + 1 == 230 || k + 1 == 231 || k + 1 == 260 || k + 1 == 261;
        EXPECT_EQ(std::isnan(m.simulated_held_out[k]), gap) << k;
        if (k + 1 < 230) {
            EXPECT_EQ(m.simulated_held_out[k], whole.simulated_held_out[k]);
        }
    }
    double const theta_y = m.parameters[0].value, b0 = m.parameters[1].value, b1 = m.parameters[2].value;
    EXPECT_NEAR(m.simulated_held_out[231], b0 * u[232] + b1 * u[231] - theta_y * y[231], 1e-12) << "from sample 231";
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
/// A series that is zero but once. What is said of it is so.
TEST_F(IdentifyRecords, AnImpulseIsCalledWhatItIs) {
    Signal impulse(140, 0.0);
    impulse[4] = 19.68;
    std::string text = "y\n";
    for (double const v : impulse) text += fmt::format("{}\n", v);
    std::string const one = folder.file(text, "impulse.csv");
    EXPECT_THAT(folder.without(files::message_of([&] { identify::identify(one, {.output = "y"}); })),
                Names("impulse.csv y 11 10 --max-order"));
    Identified const first = identify::identify(one, {.output = "y", .order = 1});
    EXPECT_EQ(first.held_out_one_step, -INFINITY) << "no percentage of a spread of zero";
    EXPECT_THAT(as_table(first), HasSubstr("held out: - one step"));
    Identified const whole = identify::identify(one, {.output = "y", .order = 1, .detrend = false, .validate = 0});
    EXPECT_GT(whole.sigma2, 2);
    EXPECT_FALSE(whole.ljung_box.zeros);
    EXPECT_THAT(as_table(whole), testing::Not(HasSubstr("beyond rounding")));
    EXPECT_THAT(whole.warnings(), testing::Contains(Names("row 5 100")));
}
/// Rows that a logger dropped, by their times: as if they were there and empty.
TEST_F(IdentifyRecords, TimesPutRowsWhereTheyBelong) {
    auto const text = [&](auto const& row) {
        std::string out = "time [s],u,y\n";
        for (size_t k = 0; k < u.size(); ++k) out += row(k);
        return out;
    };
    auto const gone = [](size_t k) { return k > 3 && k % 29 < 2; };
    std::string const dropped = folder.file(
                          text([&](size_t k) {
                              return gone(k) ? "" : fmt::format("{:.1f},{},{}\n", 0.1 * double(k), u[k], y[k]);
                          }),
                          "dropped.csv"),
                      empty = folder.file(text([&](size_t k) {
                                              return gone(k)
                                                         ? fmt::format("{:.1f},,\n", 0.1 * double(k))
                                                         : fmt::format("{:.1f},{},{}\n", 0.1 * double(k), u[k], y[k]);
                                          }),
                                          "empty.csv");
    IdentifyOptions options{.inputs = {"u"}, .output = "y", .order = 1};
    Identified const as_empty = identify::identify(empty, options), blind = identify::identify(dropped, options);
    ASSERT_FALSE(blind.remarks.empty());
    EXPECT_THAT(blind.remarks.front(), Says(Remark::Rank::time, "time 10 0.1 --time"));
    EXPECT_EQ(blind.next(), "--time 'time [s]'");
    EXPECT_NE(values(blind), values(as_empty));
    options.time = "time [s]";
    Identified const mended = identify::identify(dropped, options);
    EXPECT_EQ(values(mended), values(as_empty));
    EXPECT_EQ(mended.samples, as_empty.samples);
    EXPECT_EQ(mended.held_out_simulated, as_empty.held_out_simulated);
    EXPECT_EQ(mended.warnings(), as_empty.warnings());
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
