// Coloured residuals: what a noise model and instruments say of records whose parameters are known.
#include "tests/identify/said.hpp"
#include "src/lab/identify/coloured.hpp"

#include <rlslab/adapt/extended_least_squares.hpp>
#include <rlslab/adapt/instrumental_variables.hpp>
#include <rlslab/variants/ud.hpp>

namespace rlslab {
using namespace identify;
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr double a1 = -1.5, a2 = 0.7, b1 = 1, b2 = 0.5;
Signal moving_average(Signal const& e, std::vector<double> const& c, double scale) {
    Signal out(e.size());
    for (size_t k = 0; k < e.size(); ++k) {
        out[k] = e[k];
        for (size_t i = 1; i <= c.size() && i <= k; ++i) out[k] += c[i - 1] * e[k - i];
        out[k] *= scale;
    }
    return out;
}
/// y[k] + a1 y[k-1] + a2 y[k-2] = b1 u[k-1] + b2 u[k-2] + C e.
Data record(Index N, std::uint64_t seed, std::vector<double> const& c, double noise = 0.5) {
    return simulated({a1, a2}, {0, b1, b2}, white_noise(N, Seed{seed}),
                     moving_average(white_noise(N, Seed{seed + 1000}), c, noise));
}

class Coloured : public Options {
protected:
    Identified of(Data const& record, IdentifyOptions options) const {
        options.na = 2, options.nb = {1}, options.delay = {1};
        return run(options, record);
    }
};
double z(CuredParameter const& p, double truth) { return std::abs(p.value - truth) / p.sd; }

TEST_F(Coloured, LeastSquaresIsBiasedAndNeitherCureIs) {
    std::vector<double> const truth{a1, a2, b1, b2};
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        Identified const m = of(record(6000, seed, {0.5}, 1), {.noise_model = 1, .instruments = 4});
        EXPECT_FALSE(m.ljung_box.white());
        EXPECT_GT(std::abs(m.parameters[0].value - a1) / m.parameters[0].sd, 8) << seed;
        for (auto const& cured : {m.noise_model, m.instruments}) {
            EXPECT_EQ(cured->health, Health::sound);
            for (size_t i = 0; i < truth.size(); ++i) {
                EXPECT_LT(z(cured->parameters[i], truth[i]), 4) << seed << ' ' << cured->parameters[i].name;
                EXPECT_EQ(cured->parameters[i].least_squares, m.parameters[i].value);
            }
        }
        EXPECT_LT(z(m.noise_model->parameters.back(), 0.5), 4) << seed;
        EXPECT_EQ(m.noise_model->farthest, std::abs(m.noise_model->parameters.back().value));
        EXPECT_TRUE(m.noise_model->ljung_box.white()) << seed;
        EXPECT_NEAR(m.noise_model->sigma2, 1, 0.1);
        EXPECT_FALSE(m.instruments->ljung_box.white());
    }
}
TEST_F(Coloured, InWhiteNoiseAllThreeAgree) {
    Identified const m = of(record(1500, 3, {}), {.noise_model = 2, .instruments = 3});
    for (auto const& cured : {m.noise_model, m.instruments})
        for (size_t i = 0; i < 4; ++i) EXPECT_LT(std::abs(cured->parameters[i].shift()), 4);
    EXPECT_LT(m.noise_model->farthest, 0.3);
    EXPECT_EQ(m.cure, "");
}
/// z^2 of each parameter has the mean 1; over 60 records of 4 parameters its standard deviation is 0.1 at most if they
/// move apart, 0.19 if together.
TEST_F(Coloured, TheDeviationsAreThoseOfManyRecords) {
    std::vector<double> const truth{a1, a2, b1, b2};
    double of_instruments = 0, of_noise = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        Identified const m = of(record(1500, seed, {0.6}), {.noise_model = 1, .instruments = 4});
        for (size_t i = 0; i < 4; ++i) {
            double const by_noise = z(m.noise_model->parameters[i], truth[i]),
                         by_instruments = z(m.instruments->parameters[i], truth[i]);
            of_noise += by_noise * by_noise / 240, of_instruments += by_instruments * by_instruments / 240;
        }
    }
    std::printf("mean z^2: noise model %.2f, instruments %.2f\n", of_noise, of_instruments);
    for (double const mean : {of_noise, of_instruments}) EXPECT_TRUE(0.5 < mean && mean < 1.8) << mean;
}

/// Rows by hand, with the filters of the library: the same bits, also where values are missing.
TEST_F(Coloured, IsTheLibrarysFiltersBitForBit) {
    Data data = record(600, 5, {0.6});
    Signal &u = data.columns[0], &y = data.columns[1];
    u[50] = y[120] = y[121] = u[300] = NAN;
    Identified const m = of(data, {.detrend = false, .noise_model = 2, .instruments = 3});
    EXPECT_EQ(m.skipped, 2 * 2 + 4);
    Matrix<double> P0 = Matrix<double>::Zero(6, 6);
    for (Index i = 0; i < 4; ++i) P0(i, i) = (m.c / m.scales[size_t(i)]) * (m.c / m.scales[size_t(i)]);
    P0(4, 4) = P0(5, 5) = 1 / m.sigma2;
    Matrix<double> const of_equation = P0.topLeftCorner(4, 4);
    ExtendedLeastSquares<Ud<double>> f({.size = 6, .prior = Prior<double>{.covariance = P0}}, 2);
    size_t const fitted = 400;
    Records zeta{
        .psi = Matrix<double>(5, 395), .y = Vector<double>::Zero(395), .names = {}, .skipped = 0, .presample = 0};
    Index rows = 0;
    auto const instruments_at = [&](size_t k) {
        return Vector<double>{{u[k - 1], u[k - 2], u[k - 3], u[k - 4], u[k - 5]}};
    };
    auto const psi_at = [&](size_t k) { return Vector<double>{{-y[k - 1], -y[k - 2], u[k - 1], u[k - 2]}}; };
    for (size_t k = 2; k < fitted; ++k) {
        Vector<double> const psi = psi_at(k);
        if (psi.hasNaN() || std::isnan(y[k])) f.pass_time();
        else f.update(psi, y[k]);
        if (k >= 5 && !psi.hasNaN() && !std::isnan(y[k]) && !instruments_at(k).hasNaN())
            zeta.psi.col(rows++) = instruments_at(k);
    }
    zeta.psi.conservativeResize(Eigen::NoChange, rows), zeta.y.conservativeResize(rows);
    InstrumentalVariables<Ud<double>> g({.size = 4, .prior = Prior<double>{.covariance = of_equation}},
                                        {.size = 5, .prior = default_prior(zeta, 1).prior()}, 2);
    for (size_t k = 5; k < fitted; ++k) {
        Vector<double> const psi = psi_at(k), instruments = instruments_at(k);
        if (psi.hasNaN() || std::isnan(y[k]) || instruments.hasNaN()) g.pass_time();
        else g.update(psi, instruments, y[k]);
    }
    for (Index i = 0; i < 6; ++i) EXPECT_EQ(m.noise_model->parameters[size_t(i)].value, f.theta()[i]) << i;
    for (Index i = 0; i < 4; ++i) EXPECT_EQ(m.instruments->parameters[size_t(i)].value, g.theta()[i]) << i;
    EXPECT_EQ(m.instruments->rows, rows);
    EXPECT_EQ(m.noise_model->rows, m.fitted);
}
TEST_F(Coloured, UnitsThatArePowersOfTwoChangeNoBit) {
    Data data = record(600, 7, {0.6});
    IdentifyOptions const options{.detrend = false, .noise_model = 1, .instruments = 2};
    Identified const m = of(data, options);
    Identified const scaled = of(uy(times(data.columns[0], 0x1p-200), times(data.columns[1], 0x1p200)), options);
    auto const same = [](Cured const& a, Cured const& b) {
        for (size_t i = 0; i < a.parameters.size(); ++i) {
            bool const of_input = i == 2 || i == 3;
            EXPECT_EQ(b.parameters[i].value, a.parameters[i].value * (of_input ? 0x1p400 : 1)) << i;
            EXPECT_NEAR(b.parameters[i].sd / (of_input ? 0x1p400 : 1) / a.parameters[i].sd, 1, 1e-9) << i;
        }
    };
    same(*m.noise_model, *scaled.noise_model), same(*m.instruments, *scaled.instruments);
}

// --- what is printed -------------------------------------------------------------------------------------------------

TEST_F(Coloured, TableJsonAndPageSayTheSame) {
    Identified const m = of(record(900, 2, {0.7}), {.noise_model = 1, .instruments = 2});
    std::string const table = as_table(m), page = as_page(m);
    json const out = json::parse(as_json(m));
    EXPECT_THAT(table, HasSubstr("noise model: C e with C of order 1"));
    EXPECT_THAT(table, HasSubstr("|C(e^iw) - 1| < 1 at every w"));
    EXPECT_THAT(table, HasSubstr("instruments: the equation's inputs"));
    for (auto const& [cured, name] : {std::pair(*m.noise_model, "noise_model"), {*m.instruments, "instruments"}})
        for (size_t i = 0; i < cured.parameters.size(); ++i) {
            CuredParameter const& p = cured.parameters[i];
            json const& q = out[name]["parameters"][i];
            EXPECT_EQ(q["value"], p.value);
            EXPECT_EQ(q["sd"], p.sd);
            EXPECT_EQ(q["least_squares"].is_null(), std::isnan(p.least_squares));
            for (std::string const& text : {table, page})
                EXPECT_THAT(text, HasSubstr(fmt::format("{:.6g}", p.value))) << p.name;
        }
    EXPECT_EQ(out["noise_model"]["order"], 1);
    EXPECT_EQ(out["noise_model"]["converges"], true);
    EXPECT_EQ(out["noise_model"]["whiteness"]["white"], m.noise_model->ljung_box.white());
    EXPECT_EQ(out["instruments"]["further_lags"], 2);
    EXPECT_EQ(out["instruments"]["rows"], m.instruments->rows);
    json const without = json::parse(as_json(of(record(900, 2, {0.7}), {})));
    EXPECT_FALSE(without.contains("noise_model") || without.contains("instruments"));
}

// --- the options -----------------------------------------------------------------------------------------------------

TEST_F(Coloured, NextIsOptionsThatWorkWhenPasted) {
    write("data.csv", record(900, 1, {0.7}, 0.2).csv());
    std::string const model = "rlslab identify data.csv --input u --output y --na 2 --nb 1 --delay 1 ";
    json const out = json::parse(shell(model + "--json").out);
    EXPECT_EQ(out["next"], "--noise-model 2 --instruments 2");
    EXPECT_THAT(out["warnings"][0].get<std::string>(), HasSubstr("--noise-model"));
    Outcome const pasted = shell(model + out["next"].get<std::string>());
    EXPECT_EQ(pasted.code, 0) << pasted.err;
    for (char const* const said : {"\nnoise model: ", "\ninstruments: "}) EXPECT_THAT(pasted.out, HasSubstr(said));
    EXPECT_THAT(pasted.out, Not(HasSubstr("next: --noise-model")));
    std::string const series = "rlslab identify data.csv --output y --order 1 ";
    EXPECT_EQ(json::parse(shell(series + "--json").out)["next"], "--noise-model 2");
    EXPECT_EQ(shell(series + "--noise-model 2").code, 0);
}
TEST_F(Coloured, AHigherOrderThatPassesIsStillFirst) {
    Identified m = of(record(900, 1, {0.7}), {});
    ASSERT_FALSE(m.ljung_box.white());
    m.options.na.reset(), m.options.nb.clear(), m.options.noise_model.reset();
    Record const none{.file = {}};
    m.choice.fits = {OrderFit{}, OrderFit{}};
    m.choice.fits[1].order = m.order + 1, m.choice.fits[1].ljung_box = 0.5;
    EXPECT_EQ(cure_for(m, none), "") << "it asks nothing of the record";
}
/// Two inputs: one further lag of each is as many as two past outputs. Without noise the instruments find the system.
TEST_F(Coloured, SeveralInputsShareTheInstruments) {
    Identified const m = run({.inputs = {"u", "v"}, .na = 2, .nb = {1, 1}, .delay = {2, 0}, .instruments = 1});
    for (CuredParameter const& p : m.instruments->parameters) EXPECT_LT(std::abs(p.shift()), 5) << p.name;
    Cured const exact = *of(record(300, 2, {}, 0), {.detrend = false, .instruments = 2}).instruments;
    EXPECT_NEAR(exact.parameters[0].value, a1, 1e-5);
    EXPECT_NEAR(exact.parameters[3].value, b2, 1e-5);
}

}  // namespace
}  // namespace rlslab
