// The numbers that `identify` prints are those that it computed: JSON beside the model, each line beside JSON.
#include "tests/identify/said.hpp"

namespace rlslab {
using namespace identify;
using namespace report;
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Columns and lines that go on have one blank.
std::string flat(std::string const& text) {
    return std::regex_replace(std::regex_replace(text, std::regex("\n    (?! )"), " "), std::regex(" +"), " ");
}
void expect_lines(Identified const& m, std::vector<std::string> const& lines) {
    json const out = json::parse(as_json(m));
    for (std::string const& line : lines) EXPECT_THAT(flat(as_table(m)), HasSubstr('\n' + filled(line, out)));
}

TEST_F(Options, TheTableSaysWhatTheJsonSays) {
    Identified const m = run({.inputs = {"u", "v"}, .order = 3, .confidence = 0.99});
    std::vector<std::string> lines{
        "ud in double, lambda = 1, prior P0_ii = (c / s_i)^2, c = 2^" + std::to_string(std::ilogb(m.c)) + ",",
        "input u: excites enough for every order tried (exciting of order 4 at least)\n",
        "input v: excites enough for every order tried (exciting of order 4 at least)\n",
        "order 3 (given)\n",
        " parameter of estimate sd 99 % interval\n",
        "poles: {/poles/0/0:.4f} +- {/poles/0/1:.4f}i (|z| " + fmt::format("{:.3f}), ", std::abs(m.poles[0])) +
            "{/poles/2/0:.4f}; slowest",
        "steady-state gain of u: {/inputs/0/gain:.5g} (sd {/inputs/0/gain_sd:.2g})\n",
        "steady-state gain of v: {/inputs/1/gain:.5g} (sd {/inputs/1/gain_sd:.2g})\n",
        "fit: {/fit/one_step:.2f} % one step ahead; held out: {/fit/held_out_one_step:.2f} % one step ahead, "
        "{/fit/held_out_simulated:.2f} % simulated (0 %: no better than the mean)\n",
        "residuals: sigma^2 = {/sigma2:.4g}; they pass for white: p = {/whiteness/p:.3g} >= 0.01 (Ljung-Box: Q = "
        "{/whiteness/Q:.4g}, 25 lags, 22 degrees of freedom)\n",
        "criteria: AIC {/criteria/aic:.6g}, BIC {/criteria/bic:.6g}, FPE {/criteria/fpe:.4g}, of 12 parameters over "
        "{/fitted:.0f} rows\n",
        "arithmetic: ud agrees with the certified minimiser in {/digits/theta:.3g} of 15.9 digits "
        "({/digits/worst:.3g} in its worst component); kappa = {/condition:.3g}\n"};
    for (size_t i = 0; i < m.parameters.size(); ++i)
        lines.push_back(fmt::format(" {0} {1} {{{2}/value:.6g}} {{{2}/sd:.2g}} {{{2}/low:.5g}} ... {{{2}/high:.5g}}\n",
                                    m.parameters[i].name, m.parameters[i].regressor, fmt::format("/parameters/{}", i)));
    expect_lines(m, lines);
    std::string const text = flat(as_table(m));
    EXPECT_THAT(text,
                HasSubstr(filled(
                    "/record.csv: 300 samples: {/fitted:.0f} rows fitted, the last 100 samples held out; means taken "
                    "off: u {/inputs/0/mean:.5g}, v {/inputs/1/mean:.5g}, y {/output_mean:.5g}\n",
                    json::parse(as_json(m)))));
    EXPECT_THAT(text, HasSubstr(fmt::format("time constant {:.3g} samples\n", -1 / std::log(std::abs(m.poles[0])))));
    auto const largest = [](Signal const& r, size_t first) {
        size_t at = first;
        for (size_t lag = first; lag < r.size(); ++lag)
            if (std::abs(r[lag]) > std::abs(r[at])) at = lag;
        return fmt::format("{:.2g} at lag {}", r[at], at);
    };
    EXPECT_THAT(text,
                HasSubstr(fmt::format("\ntheir largest correlation: with themselves {}; with past u {}; with past "
                                      "v {} (99 % bound {:.2g})\n",
                                      largest(m.auto_correlation, 1), largest(m.cross_correlation[0], 0),
                                      largest(m.cross_correlation[1], 0), m.bound)));
}
TEST_F(Options, TheJsonSaysWhatWasWorkedOut) {
    Identified const m = run({.inputs = {"u", "v"}, .order = 3});
    json const out = json::parse(as_json(m));
    auto const is = [&](std::string const& place, json const& value) {
        EXPECT_EQ(out.at(json::json_pointer(place)), value) << place;
    };
    is("/samples", m.samples), is("/fitted", m.fitted), is("/held_out", m.held_out), is("/sigma2", m.sigma2),
        is("/degrees_of_freedom", m.freedom), is("/criteria/aic", m.aic), is("/criteria/bic", m.bic),
        is("/criteria/fpe", m.fpe), is("/fit/one_step", m.fit_one_step),
        is("/fit/held_out_one_step", m.held_out_one_step), is("/fit/held_out_simulated", m.held_out_simulated),
        is("/whiteness/p", m.ljung_box.p), is("/whiteness/Q", m.ljung_box.Q), is("/whiteness/lags", 25),
        is("/whiteness/degrees_of_freedom", 22), is("/whiteness/level", 0.01), is("/whiteness/white", true),
        is("/digits/theta", m.digits), is("/digits/worst", m.digits_worst), is("/condition", m.condition),
        is("/bound", m.bound), is("/prior/c", m.c), is("/prior/moves_by_sd", m.prior_effect),
        is("/residual_correlation", m.auto_correlation), is("/output_mean", m.means[2]), is("/breakdown", nullptr),
        is("/equation", equation_text(m.terms, "y")), is("/suggested/aic", m.choice.aic),
        is("/suggested/bic", m.choice.bic), is("/suggested/fpe", m.choice.fpe),
        is("/suggested/f_test", m.choice.f_test);
    EXPECT_EQ(out["prior"]["scales"].size(), m.parameters.size());
    auto const has = [](json const& object, std::string const& names, std::vector<json> const& values) {
        std::istringstream words(names);
        std::string name;
        for (json const& value : values) EXPECT_EQ(object.at((words >> name, name)), value) << name;
        EXPECT_EQ(object.size(), values.size());
    };
    for (size_t i = 0; i < m.parameters.size(); ++i) {
        Parameter const& p = m.parameters[i];
        has(out["parameters"][i], "name of value sd low high p",
            {p.name, p.regressor, p.value, p.sd, p.lower, p.upper, p.p});
    }
    for (size_t i = 0; i < m.choice.fits.size(); ++i) {
        OrderFit const& f = m.choice.fits[i];
        has(out["orders"][i], "order parameters J aic bic fpe p whiteness held_out",
            {f.order, f.parameters, f.J, f.aic, f.bic, f.fpe, f.p, f.ljung_box, f.held_out});
    }
    auto const parts = [](auto const& roots) {
        json all = json::array();
        for (auto const& z : roots) all.push_back({z.real(), z.imag()});
        return all;
    };
    for (size_t j : {0u, 1u}) {
        std::string const input = fmt::format("/inputs/{}/", j);
        is(input + "mean", m.means[j]), is(input + "gain", m.gain[j]), is(input + "gain_sd", m.gain_sd[j]);
        is(input + "exciting_of_order", 4), is(input + "constant_at_start", m.excitation[j].constant_at_start);
        is(input + "residual_correlation", m.cross_correlation[j]), is(input + "zeros", parts(m.zeros[j]));
    }
    EXPECT_EQ(out["poles"], parts(m.poles));
}
TEST_F(Options, EveryOrderThatWasTriedHasItsLine) {
    Identified const m = run({.inputs = {"u", "v"}, .max_order = 4});
    std::vector<std::string> lines;
    ASSERT_EQ(m.choice.fits.size(), 5u);
    for (OrderFit const& fit : m.choice.fits)
        lines.push_back(fmt::format(
            "{0} {1} {2} {{{3}/aic:.5g}} {{{3}/bic:.5g}} {{{3}/fpe:.3g}} {{{3}/whiteness:.2g}} "
            "{{{3}/held_out:.2f}} %\n",
            fit.order == m.order ? "*" : "", fit.order, fit.parameters, fmt::format("/orders/{}", fit.order)));
    expect_lines(m, lines);
    EXPECT_THAT(as_table(m), HasSubstr(filled("; AIC says {/suggested/aic:.0f}, BIC {/suggested/bic:.0f}, FPE "
                                              "{/suggested/fpe:.0f}, F-test {/suggested/f_test:.0f}\n",
                                              json::parse(as_json(m)))));
    // With forgetting residuals get no verdict, and the table says why.
    std::string const forgets = as_table(run({.inputs = {"u", "v"}, .max_order = 4, .forgetting = 0.98}));
    EXPECT_THAT(forgets, testing::ContainsRegex("\ncriteria: AIC, BIC and FPE [^\n]*none"));
    EXPECT_THAT(forgets, testing::ContainsRegex("\nresiduals: "));
    EXPECT_THAT(forgets, testing::Not(testing::ContainsRegex("\nresiduals: [^\n]* p = ")));
}
/// The gain is 0.5, from sample 200 on 0.9; samples are half a second apart.
TEST_F(Options, AChangeOfTheParametersHasItsRow) {
    Signal const u = white_noise(600, Seed{1}), e = white_noise(600, Seed{2});
    Signal y(600, 0.0);
    for (size_t k = 1; k < 600; ++k) y[k] = (k < 200 ? 0.5 : 0.9) * y[k - 1] + u[k - 1] + 0.1 * e[k];
    Identified const m = run({.order = 1, .sample_time = 0.5}, uy(u, y));
    auto const &sum = m.constancy.cusum, &squares = m.constancy.squares;
    auto const row = [&](Index at) { return m.constancy.samples[size_t(at)] + 1; };
    ASSERT_TRUE(squares.surely);
    EXPECT_NEAR(double(row(squares.farthest)), 201, 10);
    std::string const crossing = fmt::format("row {}", row(*squares.crosses));
    EXPECT_THAT(as_table(m), HasSubstr(crossing));
    EXPECT_THAT(as_page(m), HasSubstr("crosses at " + crossing));
    json const out = json::parse(as_json(m))["constancy"];
    EXPECT_EQ(out["cusum_of_squares"]["farthest_at_row"], row(squares.farthest));
    EXPECT_EQ(out["cusum_of_squares"]["value"], json(squares.value));
    EXPECT_EQ(out["cusum"]["high"], json(sum.upper));
    EXPECT_EQ(out["rows"].size(), out["recursive_residuals"].size());
    EXPECT_THAT(m.warnings(),
                testing::Contains(Names(fmt::format("parameters row {} {:.4g} --window --forgetting",
                                                    row(squares.farthest), 0.5 * double(row(squares.farthest) - 1)))));
}

}  // namespace
}  // namespace rlslab
