// Records and structures of every kind: what is one model, what is refused, numbers by another hand; what a noise model
// and instruments say of records whose parameters are known.
#include "src/lab/identify/estimate.hpp"
#include "tests/identify/said.hpp"

#include <rlslab/adapt/extended_least_squares.hpp>
#include <rlslab/adapt/instrumental_variables.hpp>
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/model/fit.hpp>
#include <rlslab/variants/ud.hpp>

namespace rlslab {
using namespace identify;
using namespace report;
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// --- structures ------------------------------------------------------------------------------------------------------

TEST_F(Options, OneModelSaidInSeveralWaysIsOneModel) {
    std::vector<std::string> const uv{"u", "v"};
    using Way = std::pair<IdentifyOptions, std::string>;
    for (std::vector<Way> const& ways :
         {std::vector<Way>{{{.inputs = {"u"}, .order = 2}, "order 2"},
                           {{.inputs = {"u"}, .na = 2, .nb = {2}}, "na = 2, nb = 2"},
                           {{.regressors = {"y[k-1]", "y[k-2]", "u[k..k-2]"}}, "5 regressors"}},
          {{{.order = 3}, "order 3"}, {{.na = 3}, "na = 3"}, {{.regressors = {"y[k-1..k-3]"}}, "3 regressors"}},
          {{{.inputs = uv, .na = 2, .nb = {1, 1}, .delay = {2, 0}}, "na = 2, nb = 1, delay 2,0"},
           {{.regressors = {"u[k-2..k-3]", "y[k-1..k-2]", "v[k..k-1]"}}, "6 regressors"}},
          {{{.inputs = uv, .na = 1, .nb = {2}, .delay = {1}}, "na = 1, nb = 2, delay 1"},
           {{.inputs = uv, .na = 1, .nb = {2, 2}, .delay = {1, 1}}, "na = 1, nb = 2, delay 1"}}}) {
        Identified const one = of(two_inputs(), ways[0].first);
        for (auto const& [options, structure] : ways) {
            Identified const m = of(two_inputs(), options);
            EXPECT_EQ(values(m), values(one)) << structure;
            EXPECT_EQ(m.structure, structure);
            EXPECT_EQ(m.why, "given");
            EXPECT_EQ(m.choice.fits.empty(), options.order == 0) << structure;
            for (size_t i = 0; i < m.parameters.size(); ++i) EXPECT_EQ(m.parameters[i].sd, one.parameters[i].sd);
            EXPECT_EQ(m.fit_one_step, one.fit_one_step);
            EXPECT_EQ(m.ljung_box.p, one.ljung_box.p);
            if (!options.inputs.empty()) {
                EXPECT_EQ(m.held_out_simulated, one.held_out_simulated);
            }
        }
    }
}

// --- refusals --------------------------------------------------------------------------------------------------------

TEST_F(Options, ThatDoNotGoTogetherAreRefused) {
    is_refused({.order = 2, .na = 1, .nb = {1}}, "--order --na --nb");
    is_refused({.order = 2, .max_order = 3}, "--max-order --order --na --nb");
    is_refused({.max_order = 3, .na = 1, .nb = {1}}, "--max-order --order --na --nb");
    is_refused({.na = 1}, "--na --nb");
    is_refused({.nb = {1}}, "--nb --na");
    is_refused({.na = 1, .nb = {1, 2}}, "--nb 1 2");
    is_refused({.inputs = {"u", "v"}, .order = 1, .delay = {1, 2, 3}}, "--delay 2 3");
    for (IdentifyOptions o : {IdentifyOptions{.inputs = {"u"}}, {.order = 1}, {.delay = {1}}}) {
        o.regressors = {"u"};
        is_refused(o, "--regressors --input --order --max-order --na --nb --delay");
    }
    is_refused({.regressors = {"u", "y"}}, "--regressors y y[k-1]");
    is_refused({.regressors = {"y[k-201]", "u"}}, "--regressors y[k-201] 200");
    is_refused({.regressors = {"u", "u[k-201]"}}, "--regressors u[k-201] 200");
    is_refused({.regressors = {"w[k-1]"}}, "record.csv w");
    is_refused({.inputs = {"u", "u"}}, "record.csv u");
    is_refused({.inputs = {"y"}}, "record.csv y");
    for (double const lambda : {0.5, 1e-30, 1e-100, 1e-320})
        is_refused({.order = 2, .forgetting = lambda}, "--forgetting lambda 6");
    is_refused({.order = 2, .forgetting = 0.5}, "--forgetting 0.5 2 6 0.917");
    is_refused({.order = 2, .forgetting = 0.917}, "");
    EXPECT_GE(run({.order = 2, .forgetting = 0.917}).freedom, 1);
    for (double const bad : {0.0, -1.0, std::nan(""), double(INFINITY)})
        is_refused({.order = 1, .sample_time = bad}, "--sample-time 1e-15 1e15");
    is_refused({.order = 2, .instruments = -3}, "--instruments whole number");
    is_refused({.inputs = {"u", "v"}, .na = 3, .nb = {1, 1}, .delay = {2, 0}, .instruments = 1}, "--instruments 2");
    EXPECT_THAT(files::message_of([&] { identify::identify(file, {.inputs = {"u"}}); }), Names("--output"));
}
TEST_F(Options, RecordsWithoutAModelAreRefused) {
    Signal const u = white_noise(60, Seed{1}), tiny = times(u, 0x1p-405), still(60, 3.0);
    Signal late = still;
    late[59] = 4;
    IdentifyOptions const one{.order = 1};
    is_refused(one, "record.csv y", uy(u, still));
    is_refused(one, "record.csv y 40 --validate", uy(u, late));
    is_refused(one, "record.csv input", uy(Signal(60, 1.0), u));
    is_refused(one, "record.csv y power", uy(u, tiny));
    is_refused(one, "record.csv u power", uy(tiny, u));
    is_refused(one, "", uy(times(tiny, 0x1p+7), white_noise(60, Seed{9})));  // about 2^-398 at most
    // Order 2, a delay of 1: 6 parameters, the constant included; 3 samples of presample; one row more than parameters.
    IdentifyOptions const two{.order = 2, .delay = {1}, .validate = 0};
    auto const cut = [](Index n) {
        return simulated({-0.5}, {0, 1}, white_noise(n, Seed{1}), white_noise(n, Seed{2}));
    };
    is_refused(two, "record.csv 2 1 6 10 9", cut(9));
    EXPECT_EQ(run(two, cut(10)).fitted, 7);
    EXPECT_NEAR(run(two, cut(10)).freedom, 1, 1e-3);
    Data gaps = simulated({-0.8}, {0, 0.5}, white_noise(300, Seed{1}), white_noise(300, Seed{2}));
    for (size_t k = 0; k < 300; k += 3) gaps.columns[1][k] = NAN;
    is_refused({.order = 2}, "record.csv 2 6 0", gaps);
    is_refused(one, "", gaps);
    is_refused(one, "record.csv u", uy(Signal(300, NAN), gaps.columns[0]));
    is_refused({.order = 2, .noise_model = 1}, "--noise-model rounding",
               simulated({-1.5, 0.7}, {0, 1, 0.5}, white_noise(300, Seed{1}), Signal(300, 0.0)));
}
TEST_F(Options, AreRefusedByTheProgramInOneLineWithExitCodeTwo) {
    for (auto const& [words, things] : std::vector<std::pair<std::string, std::string>>{
             {"--input u --na 1,2 --nb 1", "--na"},
             {"--input u --na 1 --nb x", "--nb 0 200 x"},
             {"--input u,v --na 1 --nb 1,201", "--nb 0 200 201"},
             {"--input u --delay 100001", "--delay 0 100000 100001"},
             {"--input u --delay 290", "order --validate"},
             {"--regressors ''", "--regressors"},
             {"--regressors 'u[k+1]'", "--regressors u[k+1]"},
             {"--regressors 'u[k-1],u[k-1]'", "--regressors u[k-1]"},
             {"--nb 1", "--nb --input"},
             {"--order 2 --delay 1", "--delay --input"},
             {"--na 0", "--na 1 --input"},
             {"--input u --confidence 0.9999999999999999", "--confidence 0.001 0.999999"},
             {"--input u --order 2 --noise-model 0", "--noise-model 1"},
             {"--input u --order 2 --noise-model two", "--noise-model two"},
             {"--input u --order 2 --instruments 1.5", "--instruments 1.5"},
             {"--input u --order 2 --noise-model 200", "--noise-model rows too few"},
             {"--input u --order 2 --instruments 150", "--instruments smaller number"},
             {"--input u --order 2 --instruments 1000", "--instruments smaller number"},
             {"--input u --order 3 --instruments 2", "--instruments 3 more"},
             {"--input u --na 0 --nb 2 --instruments 2", "--instruments past outputs"},
             {"--input u --na 0 --nb 2 --noise-model 2", "--noise-model past outputs"},
             {"--input u --order 2 --forgetting 0.99 --noise-model 2", "--noise-model --forgetting"},
             {"--order 2 --instruments 2", "--instruments --input"}})
        refused("identify data.csv --output y " + words, things);
    for (char const* const bad : {"0", "-1", "nan", "inf", "x", "1e-16", "1e16", "''"})
        refused(std::string("identify data.csv --input u --output y --order 1 --sample-time ") + bad, "--sample-time");
    for (std::string const good : {"--input u,v --na 2 --nb 1,1 --delay 2,0", "--input u --order 1 --sample-time 1e-15",
                                   "--input u --order 1 --sample-time 1e15", "--regressors 'y[k-1..k-2],u[k-2..k-3]'"})
        EXPECT_EQ(shell("rlslab identify data.csv --output y " + good).code, 0) << good;
    EXPECT_THAT(shell("rlslab identify --help").out,
                HasSubstr("y[k] + a1 y[k-1] + ... + a_na y[k-na] = b0 u[k-delay]"));
}

// --- rows that are missing, and series -------------------------------------------------------------------------------

class IdentifyRecords : public Options {
protected:
    Signal const u = white_noise(300, Seed{1}),
                 y = simulated({-0.8}, {0, 0.5}, u, white_noise(300, Seed{2})).columns[1];
};
/// A simulation stops where an input is missing and begins anew from measured outputs; it is as good as without gaps.
TEST_F(IdentifyRecords, ASimulationGoesOnBehindAMissingInput) {
    Signal gaps = u;
    gaps[230] = gaps[260] = NAN;
    IdentifyOptions const options{.order = 1, .detrend = false};
    Identified const whole = run(options, uy(u, y)), m = run(options, uy(gaps, y));
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
    IdentifyOptions options{.order = 1, .detrend = false};
    options.composition.window = 100;
    Identified const m = run(options, uy(u, gaps));
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
    for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(m.parameters[i].value, theta[Index(i)], 1e-3 * m.parameters[i].sd) << i;
    ASSERT_EQ(m.measured.size(), 299u);
    EXPECT_TRUE(std::isnan(m.one_step[49]) && std::isnan(m.one_step[50]) && !std::isnan(m.one_step[51]));
    EXPECT_FALSE(std::isnan(m.held_out_one_step)) << "of what was measured";
    ASSERT_TRUE(m.tracked);
    EXPECT_EQ(m.tracked->rows.size(), 295u);
    EXPECT_EQ(m.tracked->rows[48].row, 50);
    EXPECT_EQ(m.tracked->rows[49].row, 53);
    expect_numbers(m, "with gaps");
    options.order = 0;
    EXPECT_EQ(run(options, uy(u, gaps)).choice.rows, 190 - 11) << "order 10, its lags and the output";
}
/// An error that does not matter is stated in units of each regressor: units of u move no digit and no word. Little
/// noise, slow poles.
TEST_F(IdentifyRecords, UnitsChangeNothing) {
    Signal const slow =
        simulated({-2.91, 2.8226, -0.912576}, {0, 1e-3, 2e-3, 1e-3}, u, times(white_noise(300, Seed{3}), 1e-9))
            .columns[1];
    Identified const one = run({.order = 3}, uy(u, slow)), other = run({.order = 3}, uy(times(u, 0x1p-40), slow));
    EXPECT_EQ(one.c, other.c);
    EXPECT_EQ(one.prior_effect, other.prior_effect);
    EXPECT_EQ(one.warnings(), other.warnings());
    for (size_t i = 0; i < 7; ++i)
        EXPECT_EQ(one.parameters[i].value, (i < 3 ? 1 : 0x1p-40) * other.parameters[i].value) << i;
}

// --- variants that break down ----------------------------------------------------------------------------------------

TEST_F(Options, EveryVariantOnEveryRecordAnswersInNumbers) {
    Signal const u = white_noise(60, Seed{2});
    std::vector<Data> const records{damped(slow_input(200), 0, 4), damped(prbs(7, 200), 0.01, 6),
                                    uy(times(u, 1e-100), times(plus(u, white_noise(60, Seed{3})), 1e90))};
    int broken = 0;
    for (CatalogueEntry const* const entry : one_entry_each())  // each is in double
        for (size_t r = 0; r < records.size(); ++r)
            for (double const lambda : {1.0, 0.9})
                for (std::optional<double> const& p0 :
                     {std::optional<double>(), std::optional<double>(lambda == 1 ? 0x1p80 : 0x1p40)}) {
                    std::string const variant(entry->variant),
                        what = fmt::format("{} {} lambda {} p0 {}", variant, r, lambda, p0.value_or(0));
                    IdentifyOptions options{.order = r == 2 ? 1 : 3};
                    options.variant = variant, options.forgetting = lambda, options.p0 = p0;
                    Identified const m = run(options, records[r]);
                    expect_numbers(m, what);
                    broken += m.failure.has_value();
                    if (m.failure) {
                        EXPECT_THAT(m.warnings(), Contains(Names(variant + " row"))) << what;
                        EXPECT_THAT(as_json(m), HasSubstr("\"breakdown\": {")) << what;
                    }
                    if (std::ranges::any_of(m.parameters, [](Parameter const& p) { return std::isnan(p.value); })) {
                        EXPECT_TRUE(m.failure) << what;
                        EXPECT_FALSE(m.ljung_box.white()) << what;
                        EXPECT_THAT(as_table(m), Not(HasSubstr("pass for white"))) << what;
                    }
                }
    EXPECT_GT(broken, 0) << "the trial shows nothing";
}
/// The program: its exit code says whether the variant can be believed.
TEST_F(Options, AVariantThatBrokeDownExitsWithOneAndIsNamed) {
    write("slow.csv", damped(slow_input(1024), 0, 6).csv());
    std::string const command = "rlslab identify slow.csv --input u --output y --order 10 --variant ";
    Outcome const bad = shell(command + "conventional");
    EXPECT_EQ(bad.code, 1) << bad.out;
    EXPECT_THAT(bad.out + bad.err, Names("conventional row 1"));
    EXPECT_THAT(not_numbers(bad.out + bad.err), testing::IsEmpty());
    EXPECT_EQ(shell(command + "ud").code, 0);
}
/// One warning for one cause, and the variant it names is one that does better, by trial.
TEST_F(Options, AVariantThatIsRecommendedDoesBetter) {
    Data const record = damped(prbs(8, 250), 0.01, 6);
    int named = 0;
    for (CatalogueEntry const* const entry : one_entry_each()) {
        IdentifyOptions options{.order = 4};
        options.variant = entry->variant, options.p0 = 0x1p60;
        Identified const m = run(options, record);
        for (std::string const& warning : m.warnings())
            if (auto const at = warning.find("--variant "); at != warning.npos) {
                std::string const other = warning.substr(at + 10, warning.find_first_of(" :", at + 10) - at - 10);
                EXPECT_NE(other, entry->variant);
                options.variant = other;
                Identified const better = run(options, record);
                EXPECT_FALSE(better.failure) << other;
                EXPECT_GT(better.digits, m.failure ? 0 : m.digits) << entry->variant << " -> " << other;
                EXPECT_THAT(better.warnings(), Not(Contains(HasSubstr("--variant")))) << other;
                ++named;
            }
    }
    EXPECT_GT(named, 0);
}

// --- coloured noise -------------------------------------------------------------------------------------------------

constexpr double a1 = -1.5, a2 = 0.7, b1 = 1, b2 = 0.5;
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
/// Eigen cuts products of more than some 250 terms by the sizes of the processor's caches.
TEST_F(Coloured, NoNumberFollowsTheProcessorsCaches) {
    std::array const here{Eigen::l1CacheSize(), Eigen::l2CacheSize(), Eigen::l3CacheSize()};
    auto const with = [&](std::ptrdiff_t first) {
        Eigen::setCpuCacheSizes(first, 8 * first, 64 * first);
        Identified const m = of(record(1500, 3, {0.5}), {.noise_model = 2, .instruments = 3});
        std::vector<double> out;
        for (auto const& cured : {m.noise_model, m.instruments})
            for (CuredParameter const& p : cured->parameters) out.insert(out.end(), {p.value, p.sd});
        return out;
    };
    EXPECT_EQ(with(0x4000), with(0xc000));
    Eigen::setCpuCacheSizes(here[0], here[1], here[2]);
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
