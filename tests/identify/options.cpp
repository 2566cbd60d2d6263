// Structures given by options, refusals in one line, and that the printed numbers are the computed ones.
#include "identify/structure.hpp"
#include "identify/text.hpp"
#include "tests/common/files.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <regex>
#include <sstream>
#include <sys/wait.h>

namespace rlslab {
using namespace identify;
using namespace report;
namespace {

using files::message_of;
using nlohmann::json;
using testing::HasSubstr;

std::string csv(std::vector<Signal> const& columns, std::string header) {
    for (size_t k = 0; k < columns[0].size(); ++k) {
        header += '\n';
        for (size_t j = 0; j < columns.size(); ++j) header += fmt::format("{}{}", j ? "," : "", columns[j][k]);
    }
    return header + '\n';
}

class Options : public testing::Test {
protected:
    files::Folder const folder;
    std::string const file = [this] {
        Signal const u = white_noise(300, Seed{1}), v = prbs(7, 300);
        DifferenceEquation const model{
            .a = {-1.1, 0.5}, .b = {{0, 0, 1, 0.4}, {0.3, -0.6, 0, 0}}, .delay = 0, .c = 0.4};
        Signal xi = white_noise(300, Seed{2});
        for (double& x : xi) x *= 0.2;
        return folder.file(csv({u, v, simulate(model, {u, v}, xi)}, "u,v,y"));
    }();
    Identified run(IdentifyOptions options) const {
        if (options.inputs.empty() && options.regressors.empty()) options.inputs = {"u"};
        options.output = "y";
        return identify::identify(file, options);
    }
    std::string refusal(IdentifyOptions const& options) const {
        return folder.without(message_of([&] { run(options); }));
    }
    struct Outcome {
        int code;
        std::string out, err;
    };
    Outcome program(std::string const& words) const {
        auto const text = [](std::filesystem::path const& path) {
            std::ifstream in(path);
            return std::string(std::istreambuf_iterator<char>(in), {});
        };
        int const status = std::system(
            ("cd '" + folder.path.string() + "' && '" RLSLAB_PROGRAM "' identify " + words + " > out.txt 2> err.txt")
                .c_str());
        return {WEXITSTATUS(status), text(folder.path / "out.txt"), text(folder.path / "err.txt")};
    }
};
std::vector<double> values(Identified const& m) {
    std::vector<double> out;
    for (Parameter const& p : m.parameters) out.push_back(p.value);
    return out;
}

TEST_F(Options, OneStructureSaidInThreeWaysIsOneModel) {
    Identified const by_order = run({.order = 2}), by_na = run({.na = 2, .nb = {2}}),
                     by_list = run({.regressors = {"y[k-1]", "y[k-2]", "u[k..k-2]"}});
    EXPECT_EQ(values(by_order), values(by_na));
    EXPECT_EQ(values(by_order), values(by_list));
    EXPECT_EQ(by_order.structure, "order 2");
    EXPECT_EQ(by_na.structure, "na = 2, nb = 2");
    EXPECT_EQ(by_list.structure, "5 regressors");
    EXPECT_EQ(by_order.fit_one_step, by_list.fit_one_step);
    EXPECT_EQ(by_order.held_out_simulated, by_list.held_out_simulated);
    EXPECT_EQ(by_order.ljung_box.p, by_list.ljung_box.p);
    EXPECT_EQ(by_list.why, "given");
    EXPECT_TRUE(by_na.choice.fits.empty());
}
TEST_F(Options, NbAndDelayAreForAllInputsOrForEach) {
    Identified const each = run({.inputs = {"u", "v"}, .na = 2, .nb = {1, 1}, .delay = {2, 0}});
    Identified const list = run({.regressors = {"u[k-2..k-3]", "y[k-1..k-2]", "v[k..k-1]"}});
    EXPECT_EQ(values(each), values(list)) << "outputs first, then each input in the order of its first mention";
    std::vector<std::string> of;
    for (Parameter const& p : each.parameters) of.push_back(p.regressor);
    EXPECT_EQ(of, (std::vector<std::string>{"y[k-1]", "y[k-2]", "u[k-2]", "u[k-3]", "v[k]", "v[k-1]", "1"}));
    EXPECT_EQ(each.parameters[2].name, "b0[u]") << "counted from the delay";
    EXPECT_EQ(list.parameters[2].name, "b2[u]") << "counted by its lag";
    EXPECT_EQ(each.structure, "na = 2, nb = 1, delay 2,0");
    EXPECT_EQ(each.order, 2);
    EXPECT_NEAR(each.parameters[2].value, 1, 5 * each.parameters[2].sd);
    EXPECT_NEAR(each.parameters[5].value, -0.6, 5 * each.parameters[5].sd);
    EXPECT_EQ(values(run({.inputs = {"u", "v"}, .na = 1, .nb = {2}, .delay = {1}})),
              values(run({.inputs = {"u", "v"}, .na = 1, .nb = {2, 2}, .delay = {1, 1}})));
    Identified const fir = run({.na = 0, .nb = {12}, .detrend = false});
    EXPECT_TRUE(fir.poles.empty());
    EXPECT_EQ(fir.parameters.size(), 13u);
    EXPECT_NEAR(fir.parameters[2].value, 1, 6 * fir.parameters[2].sd) << "the impulse response";
    EXPECT_NEAR(fir.parameters[3].value, 1.1 + 0.4, 6 * fir.parameters[3].sd);
    EXPECT_EQ(run({.order = 3, .delay = {2}}).parameters[3].regressor, "u[k-2]");
    EXPECT_EQ(run({.max_order = 3, .delay = {2}}).parameters.back().regressor, "1");
}
TEST_F(Options, TheEquationIsPrintedWithItsSigns) {
    auto const equation = [&](IdentifyOptions options) {
        Identified const m = run(options);
        EXPECT_THAT(as_table(m), HasSubstr("\n" + equation_text(m.terms, "y") + "\n"));
        return equation_text(m.terms, "y");
    };
    EXPECT_EQ(equation({.order = 1}), "y[k] + a1 y[k-1] = b0 u[k] + b1 u[k-1] + c + e[k]");
    EXPECT_EQ(equation({.order = 2, .detrend = false}),
              "y[k] + a1 y[k-1] + a2 y[k-2] = b0 u[k] + b1 u[k-1] + b2 u[k-2] + e[k]");
    EXPECT_EQ(equation({.order = 4, .delay = {3}, .detrend = false}),
              "y[k] + a1 y[k-1] + ... + a4 y[k-4] = b0 u[k-3] + ... + b4 u[k-7] + e[k]");
    EXPECT_EQ(equation({.regressors = {"v[k-2]", "y[k-1]", "y[k-3]", "u"}, .intercept = true}),
              "y[k] + a1 y[k-1] + a3 y[k-3] = b2[v] v[k-2] + b0[u] u[k] + c + e[k]");
    // The signs are those of the estimate: y[k] = 0.5 y[k-1] + 2 u[k-1] has a1 = -0.5, b1 = 2.
    Signal const u = prbs(6, 100),
                 y = simulate({.a = {-0.5}, .b = {{0, 2}}, .delay = 0, .c = 0}, {u}, Signal(100, 0.0));
    Identified const m =
        identify::identify(folder.file(csv({u, y}, "u,y"), "clean.csv"), {.inputs = {"u"}, .output = "y", .order = 1});
    EXPECT_NEAR(m.parameters[0].value, -0.5, 1e-9);
    EXPECT_NEAR(m.parameters[2].value, 2, 1e-9);
    EXPECT_NEAR(y[5], 0.5 * y[4] + 2 * u[4], 1e-12);
}
TEST_F(Options, ThatDoNotGoTogetherAreRefused) {
    EXPECT_EQ(refusal({.order = 2, .na = 1, .nb = {1}}), "--order: does not go with --na and --nb");
    EXPECT_EQ(refusal({.order = 2, .max_order = 3}), "--max-order: does not go with --order, --na and --nb");
    EXPECT_EQ(refusal({.max_order = 3, .na = 1, .nb = {1}}), "--max-order: does not go with --order, --na and --nb");
    EXPECT_EQ(refusal({.na = 1}), "--na: expected --nb, too");
    EXPECT_EQ(refusal({.nb = {1}}), "--nb: expected --na, too");
    EXPECT_EQ(refusal({.na = 1, .nb = {1, 2}}), "--nb: expected one number, or one for each of the 1 inputs, found 2");
    EXPECT_EQ(refusal({.inputs = {"u", "v"}, .order = 1, .delay = {1, 2, 3}}),
              "--delay: expected one number, or one for each of the 2 inputs, found 3");
    EXPECT_EQ(refusal({.inputs = {"u"}, .regressors = {"u"}}),
              "--regressors: does not go with --input, --order, --max-order, --na, --nb or --delay");
    EXPECT_EQ(refusal({.order = 1, .regressors = {"u"}}),
              "--regressors: does not go with --input, --order, --max-order, --na, --nb or --delay");
    EXPECT_EQ(refusal({.delay = {1}, .regressors = {"u"}}),
              "--regressors: does not go with --input, --order, --max-order, --na, --nb or --delay");
    EXPECT_EQ(refusal({.regressors = {"u", "y"}}), "--regressors: y: the output needs a lag: y[k-1] or further back");
    EXPECT_EQ(refusal({.regressors = {"y[k-201]", "u"}}),
              "--regressors: y[k-201]: expected a lag of at most 200 for the output");
    EXPECT_EQ(refusal({.regressors = {"u", "u[k-201]"}}),
              "--regressors: u[k-201]: expected the lags of an input within 200 of one another");
    EXPECT_EQ(refusal({.regressors = {"w[k-1]"}}).substr(0, 24), "data.csv: no column \"w\";");
    EXPECT_EQ(refusal({.inputs = {"u", "u"}}), "data.csv: column \"u\" is asked for twice");
    EXPECT_EQ(refusal({.inputs = {"y"}}), "data.csv: column \"y\" is asked for twice");
    EXPECT_EQ(message_of([&] { identify::identify(file, {.output = "y"}); }),
              "--input: expected the name of an input column, or several: a,b (or --regressors; past outputs alone: "
              "--regressors 'y[k-1..k-3]')");
    EXPECT_EQ(message_of([&] { identify::identify(file, {.inputs = {"u"}}); }),
              "--output: expected the name of the output column");
}
TEST_F(Options, AreRefusedByTheProgramInOneLineWithExitCodeTwo) {
    for (auto const& [words, expected] : std::vector<std::pair<std::string, std::string>>{
             {"--input u --na 1,2 --nb 1", "--na: "},
             {"--input u --na -1 --nb 1", "--na: expected a whole number from 0 to 200, found \"-1\""},
             {"--input u --na 1 --nb x", "--nb: expected a whole number from 0 to 200, found \"x\""},
             {"--input u,v --na 1 --nb 1,201", "--nb: expected a whole number from 0 to 200, found \"201\""},
             {"--input u --delay 100001", "--delay: expected a whole number from 0 to 100000, found \"100001\""},
             {"--input u --delay 290", "expected a lower order, or a smaller --validate"},
             {"--regressors ''", "--regressors"},
             {"--regressors 'u[k+1]'", "--regressors: u[k+1]: lies in the future"},
             {"--regressors 'u[k-1],u[k-1]'", "--regressors: u[k-1] is named twice"},
             {"--order 1", "--input: expected the name of an input column"},
             {"--input u --order 2 --na 2 --nb 2", "--order: does not go with --na and --nb"}}) {
        Outcome const run = program("data.csv --output y " + words);
        EXPECT_EQ(run.code, 2) << words;
        EXPECT_EQ(run.out, "") << words;
        EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
        EXPECT_THAT(run.err, HasSubstr(expected)) << words;
    }
    Outcome const good = program("data.csv --output y --input u,v --na 2 --nb 1,1 --delay 2,0 --json");
    EXPECT_EQ(good.code, 0) << good.err;
    EXPECT_EQ(json::parse(good.out)["structure"], "na = 2, nb = 1, delay 2,0");
    Outcome const list = program("--output y --regressors 'y[k-1..k-2],u[k-2..k-3]' data.csv");
    EXPECT_EQ(list.code, 0) << list.err;
    EXPECT_THAT(list.out, HasSubstr("y[k] + a1 y[k-1] + a2 y[k-2] = b2 u[k-2] + b3 u[k-3] + c + e[k]"));
    EXPECT_THAT(program("--help").out, HasSubstr("y[k] + a1 y[k-1] + ... + a_na y[k-na] = b0 u[k-delay]"));
}

/// The required number of samples is enough, one fewer is not.
TEST_F(Options, TooFewSamplesAreRefusedAtTheNumberThatIsNamed) {
    auto const cut = [&](Index samples) {
        Signal const u = white_noise(samples, Seed{1}), e = white_noise(samples, Seed{2});
        Signal y(u.size(), 0.0);
        for (size_t k = 1; k < u.size(); ++k) y[k] = 0.5 * y[k - 1] + u[k - 1] + e[k];
        return folder.file(csv({u, y}, "u,y"), "cut.csv");
    };
    // Order 2, a delay of 1: 6 parameters, the constant included; 3 samples of presample; one row more than parameters.
    IdentifyOptions const options{.inputs = {"u"}, .output = "y", .order = 2, .delay = {1}, .validate = 0};
    EXPECT_EQ(folder.without(message_of([&] { identify::identify(cut(9), options); })),
              "cut.csv: order 2, delay 1 has 6 parameters and needs at least 10 samples to fit, found 9: expected a "
              "lower order");
    Identified const m = identify::identify(cut(10), options);
    EXPECT_EQ(m.fitted, 7);
    EXPECT_NEAR(m.freedom, 1, 1e-3);
}
TEST_F(Options, RecordsWithoutAModelAreRefused) {
    auto const said = [&](Signal const& u, Signal const& y, IdentifyOptions options = {}) {
        options.inputs = {"u"}, options.output = "y", options.order = 1;
        return folder.without(message_of([&] {
            identify::identify(folder.file(csv({u, y}, "u,y"), "bad.csv"), options);
        }));
    };
    Signal const u = white_noise(60, Seed{1});
    Signal late(60, 3.0), tiny = u;
    late[59] = 4;
    EXPECT_EQ(said(u, Signal(60, 3.0)), "bad.csv: column \"y\" does not change: there is nothing to model");
    EXPECT_EQ(
        said(u, late),
        "bad.csv: column \"y\" does not change over the 40 samples that are fitted: expected a smaller --validate");
    EXPECT_THAT(said(Signal(60, 1.0), u), HasSubstr("the input does not excite the system"));
    for (double& x : tiny) x *= 0x1p-405;
    EXPECT_THAT(said(u, tiny), HasSubstr("expected moderate numbers; multiply it by a power of ten"));
    EXPECT_THAT(said(tiny, u), HasSubstr("column \"u\" is "));
    for (double& x : tiny) x *= 0x1p+7;  // about 2^-398 at most
    EXPECT_EQ(said(tiny, white_noise(60, Seed{9})), "no error");
}
/// Too short a memory is refused by its degrees of freedom, with a lambda that is long enough.
TEST_F(Options, AMemoryShorterThanTheParametersIsRefused) {
    std::string const short_memory = refusal({.order = 2, .forgetting = 0.5});
    EXPECT_EQ(short_memory,
              "--forgetting: lambda = 0.5 remembers about 2 rows, too few for 6 parameters: expected 0.917 or more");
    EXPECT_EQ(refusal({.order = 2, .forgetting = 0.917}), "no error");
    EXPECT_GE(run({.order = 2, .forgetting = 0.917}).freedom, 1);
}

// --- what is printed -------------------------------------------------------------------------------------------------

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
    EXPECT_THAT(text, HasSubstr("99 % interval"));
    EXPECT_THAT(text,
                HasSubstr(fmt::format(
                    ": 300 samples: {} rows fitted, 100 held out; means taken off: u {:.5g}, v {:.5g}, y {:.5g}\n",
                    m.fitted, m.means[0], m.means[1], m.means[2])));
    EXPECT_THAT(text,
                HasSubstr(fmt::format(
                    "\nud in double, lambda = 1, prior P0_ii = (c / s_i)^2, c = 2^{}, s_i the size of regressor i: "
                    "it moves no parameter by more than",
                    std::ilogb(m.c))));
    EXPECT_THAT(
        text,
        HasSubstr(
            "\ninput u: excites enough for every order tried (exciting of order 4 at least)\ninput v: excites enough "
            "for every order tried (exciting of order 4 at least)\n"));
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
                                              {"high", p.upper}}));
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
    EXPECT_THAT(text, HasSubstr("all orders fitted without forgetting"));
    EXPECT_THAT(text, HasSubstr("no verdict on those of the last theta over all rows"));
    EXPECT_THAT(text, HasSubstr("criteria: AIC, BIC and FPE are those of a fit without forgetting; none here"));
    EXPECT_THAT(text, testing::Not(HasSubstr("are not white")));
}
TEST_F(Options, LambdaAndConfidenceThatLeaveNothingAreRefused) {
    for (double const lambda : {0.5, 1e-30, 1e-100, 1e-320})
        EXPECT_THAT(refusal({.order = 2, .forgetting = lambda}), HasSubstr("--forgetting: lambda = ")) << lambda;
    EXPECT_THAT(program("data.csv --input u --output y --confidence 0.9999999999999999").err,
                HasSubstr("--confidence: expected a number from 0.001 to 0.999999"));
}
TEST_F(Options, APageOfALatin1NameIsUtf8) {
    std::string text = csv({white_noise(200, Seed{3}), white_noise(200, Seed{4})}, "T\xb0,y");
    std::string const page =
        as_page(identify::identify(folder.file(text, "latin.csv"), {.inputs = {"T\xb0"}, .output = "y", .order = 1}));
    EXPECT_NO_THROW(json(page).dump()) << "not UTF-8";
}

}  // namespace
}  // namespace rlslab
