// The numbers that `identify` prints are those that it computed.
#include "tests/identify/options.hpp"

#include <regex>

namespace rlslab {
using namespace identify;
using namespace report;
namespace {

using files::message_of;
using nlohmann::json;
using testing::HasSubstr;

std::vector<double> numbers_in(std::string const& line) {
    static std::regex const number("[-+]?[0-9]+\\.?[0-9]*(e[-+]?[0-9]+)?");
    std::vector<double> out;
    for (std::sregex_iterator at(line.begin(), line.end(), number), end; at != end; ++at)
        out.push_back(std::stod(at->str()));
    return out;
}
std::string line_of(std::string const& text, std::string const& start) {
    auto const at = text.find("\n" + start);
    return at == text.npos ? "" : text.substr(at + 1, text.find('\n', at + 1) - at - 1);
}
/// A number printed to so many digits.
void expect_printed(double printed, double value, int digits, std::string const& what) {
    EXPECT_NEAR(printed, value, 0.51 * std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - digits)) << what;
}

TEST_F(Options, TheTableSaysWhatWasWorkedOut) {
    IdentifyOptions options{.inputs = {"u", "v"}, .order = 3, .confidence = 0.99};
    Identified const m = run(options);
    std::string const text = as_table(m);
    for (Parameter const& p : m.parameters) {
        std::string const line = line_of(text, "  " + p.name + " ");
        auto const at = line.find(p.regressor, p.name.size() + 2);
        ASSERT_NE(at, line.npos) << text;
        std::vector<double> const n = numbers_in(line.substr(at + p.regressor.size()));
        ASSERT_EQ(n.size(), 4u) << line;
        expect_printed(n[0], p.value, 6, p.name), expect_printed(n[1], p.sd, 2, p.name),
            expect_printed(n[2], p.lower, 5, p.name), expect_printed(n[3], p.upper, 5, p.name);
    }
    EXPECT_THAT(text, Names("99 %"));
    EXPECT_THAT(text, Names(fmt::format("300 {} 100 u {:.5g} v {:.5g} y {:.5g}", m.fitted, m.means[0], m.means[1],
                                        m.means[2])));
    EXPECT_THAT(text, Names(fmt::format("ud double lambda P0_ii 2^{}", std::ilogb(m.c))));
    for (char const* const input : {"input u: ", "input v: "}) EXPECT_THAT(line_of(text, input), Names("order 4"));
    EXPECT_THAT(text, HasSubstr("\norder 3 (given)\n"));
    std::string flat = std::regex_replace(text, std::regex("\n    "), " ");
    EXPECT_THAT(line_of(flat, "poles: "),
                HasSubstr(fmt::format("time constant {:.3g} samples", -1 / std::log(std::abs(m.poles[0])))));
    for (auto const& [input, j] : {std::pair("u", 0u), {"v", 1u}})
        EXPECT_EQ(line_of(flat, fmt::format("steady-state gain of {}", input)),
                  fmt::format("steady-state gain of {}: {:.5g} (sd {:.2g})", input, m.gain[j], m.gain_sd[j]));
    EXPECT_EQ(line_of(flat, "fit: "), fmt::format("fit: {:.2f} % one step ahead; held out: {:.2f} % one step ahead, "
                                                  "{:.2f} % simulated (0 %: no better than the mean)",
                                                  m.fit_one_step, m.held_out_one_step, m.held_out_simulated));
    EXPECT_EQ(line_of(flat, "residuals: "),
              fmt::format("residuals: sigma^2 = {:.4g}; they pass for white: p = {:.3g} >= 0.01 (Ljung-Box: Q = "
                          "{:.4g}, 25 lags, 22 degrees of freedom)",
                          m.sigma2, m.ljung_box.p, m.ljung_box.Q));
    EXPECT_EQ(line_of(flat, "criteria: "),
              fmt::format("criteria: AIC {:.6g}, BIC {:.6g}, FPE {:.4g}, of 12 parameters over {} rows", m.aic, m.bic,
                          m.fpe, m.fitted));
    EXPECT_EQ(line_of(flat, "arithmetic: "),
              fmt::format("arithmetic: ud agrees with the certified minimiser in {:.3g} of 15.9 digits ({:.3g} in its "
                          "worst component); kappa = {:.3g}",
                          std::round(10 * m.digits) / 10, std::round(10 * m.digits_worst) / 10, m.condition));
    auto const largest = [](Signal const& r, size_t first) {
        size_t at = first;
        for (size_t lag = first; lag < r.size(); ++lag)
            if (std::abs(r[lag]) > std::abs(r[at])) at = lag;
        return fmt::format("{:.2g} at lag {}", r[at], at);
    };
    EXPECT_EQ(
        line_of(flat, "their largest"),
        fmt::format("their largest correlation: with themselves {}; with past u {}; with past v {} (99 % bound {:.2g})",
                    largest(m.auto_correlation, 1), largest(m.cross_correlation[0], 0),
                    largest(m.cross_correlation[1], 0), m.bound));
    std::string poles_said = "poles: ";
    for (auto const& p : m.poles)
        if (p.imag() >= 0)
            poles_said += p.imag() > 0
                              ? fmt::format("{:.4f} +- {:.4f}i (|z| {:.3f}), ", p.real(), p.imag(), std::abs(p))
                              : fmt::format("{:.4f}, ", p.real());
    EXPECT_EQ(line_of(flat, "poles: ").substr(0, poles_said.size() - 2), poles_said.substr(0, poles_said.size() - 2));
}
TEST_F(Options, TheJsonSaysWhatWasWorkedOut) {
    Identified const m = run({.inputs = {"u", "v"}, .order = 3});
    json const out = json::parse(as_json(m));
    EXPECT_EQ(out["samples"], m.samples);
    EXPECT_EQ(out["fitted"], m.fitted);
    EXPECT_EQ(out["held_out"], m.held_out);
    EXPECT_EQ(out["sigma2"], m.sigma2);
    EXPECT_EQ(out["degrees_of_freedom"], m.freedom);
    EXPECT_EQ(out["criteria"]["aic"], m.aic);
    EXPECT_EQ(out["criteria"]["bic"], m.bic);
    EXPECT_EQ(out["criteria"]["fpe"], m.fpe);
    EXPECT_EQ(out["fit"]["one_step"], m.fit_one_step);
    EXPECT_EQ(out["fit"]["held_out_one_step"], m.held_out_one_step);
    EXPECT_EQ(out["fit"]["held_out_simulated"], m.held_out_simulated);
    EXPECT_EQ(out["whiteness"], (json{{"p", m.ljung_box.p},
                                      {"Q", m.ljung_box.Q},
                                      {"lags", 25},
                                      {"degrees_of_freedom", 22},
                                      {"level", 0.01},
                                      {"white", true}}));
    EXPECT_EQ(out["digits"]["theta"], m.digits);
    EXPECT_EQ(out["digits"]["worst"], m.digits_worst);
    EXPECT_EQ(out["condition"], m.condition);
    EXPECT_EQ(out["bound"], m.bound);
    EXPECT_EQ(out["prior"]["c"], m.c);
    EXPECT_EQ(out["prior"]["moves_by_sd"], m.prior_effect);
    EXPECT_EQ(out["prior"]["scales"].size(), m.parameters.size());
    EXPECT_EQ(out["residual_correlation"], json(m.auto_correlation));
    EXPECT_EQ(out["output_mean"], m.means[2]);
    EXPECT_TRUE(out["breakdown"].is_null());
    EXPECT_EQ(out["equation"], equation_text(m.terms, "y"));
    for (size_t i = 0; i < m.parameters.size(); ++i) {
        Parameter const& p = m.parameters[i];
        EXPECT_EQ(out["parameters"][i], (json{{"name", p.name},
                                              {"of", p.regressor},
                                              {"value", p.value},
                                              {"sd", p.sd},
                                              {"low", p.lower},
                                              {"high", p.upper},
                                              {"p", p.p}}));
    }
    for (size_t i = 0; i < m.choice.fits.size(); ++i) {
        OrderFit const& f = m.choice.fits[i];
        EXPECT_EQ(out["orders"][i], (json{{"order", f.order},
                                          {"parameters", f.parameters},
                                          {"J", f.J},
                                          {"aic", f.aic},
                                          {"bic", f.bic},
                                          {"fpe", f.fpe},
                                          {"p", f.p},
                                          {"whiteness", f.ljung_box},
                                          {"held_out", f.held_out}}));
    }
    EXPECT_EQ(out["suggested"],
              (json{{"aic", m.choice.aic}, {"bic", m.choice.bic}, {"fpe", m.choice.fpe}, {"f_test", m.choice.f_test}}));
    for (size_t j : {0u, 1u}) {
        json const& input = out["inputs"][j];
        EXPECT_EQ(input["mean"], m.means[j]);
        EXPECT_EQ(input["gain"], m.gain[j]);
        EXPECT_EQ(input["gain_sd"], m.gain_sd[j]);
        EXPECT_EQ(input["exciting_of_order"], 4);
        EXPECT_EQ(input["constant_at_start"], m.excitation[j].constant_at_start);
        EXPECT_EQ(input["residual_correlation"], json(m.cross_correlation[j]));
        for (size_t i = 0; i < m.zeros[j].size(); ++i)
            EXPECT_EQ(input["zeros"][i], (json{m.zeros[j][i].real(), m.zeros[j][i].imag()}));
    }
    for (size_t i = 0; i < m.poles.size(); ++i)
        EXPECT_EQ(out["poles"][i], (json{m.poles[i].real(), m.poles[i].imag()}));
}

TEST_F(Options, EveryOrderThatWasTriedHasItsLine) {
    Identified const m = run({.inputs = {"u", "v"}, .max_order = 4});
    std::string const text = as_table(m);
    EXPECT_THAT(text, HasSubstr(fmt::format("; AIC says {}, BIC {}, FPE {}, F-test {}\n", m.choice.aic, m.choice.bic,
                                            m.choice.fpe, m.choice.f_test)));
    ASSERT_EQ(m.choice.fits.size(), 5u);
    for (OrderFit const& fit : m.choice.fits)
        EXPECT_THAT(text,
                    HasSubstr(fmt::format("\n{} {:>5}  {:>10} {:>10} {:>10} {:>10}  {:>8}  {:>8}\n",
                                          fit.order == m.order ? '*' : ' ', fit.order, fit.parameters,
                                          number_text(fit.aic, 5), number_text(fit.bic, 5), number_text(fit.fpe, 3),
                                          number_text(fit.ljung_box, 2), fmt::format("{:.2f} %", fit.held_out))));
}
TEST_F(Options, WithForgettingResidualsGetNoVerdictAndTheTableSaysWhy) {
    std::string const text = as_table(run({.inputs = {"u", "v"}, .max_order = 4, .forgetting = 0.98}));
    EXPECT_THAT(line_of(text, "criteria: "), Names("AIC BIC FPE none"));
    EXPECT_THAT(line_of(text, "residuals: "), testing::Not(Names("p")));
}

}  // namespace
}  // namespace rlslab
