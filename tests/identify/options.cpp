// Structures given by options, and refusals in one line.
#include "tests/identify/options.hpp"

#include <regex>

namespace rlslab {
using namespace identify;
using namespace report;
namespace {

using files::message_of;
using nlohmann::json;
using testing::HasSubstr;

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
    EXPECT_THAT(refusal({.order = 2, .na = 1, .nb = {1}}), Names("--order --na --nb"));
    EXPECT_THAT(refusal({.order = 2, .max_order = 3}), Names("--max-order --order --na --nb"));
    EXPECT_THAT(refusal({.max_order = 3, .na = 1, .nb = {1}}), Names("--max-order --order --na --nb"));
    EXPECT_THAT(refusal({.na = 1}), Names("--na --nb"));
    EXPECT_THAT(refusal({.nb = {1}}), Names("--nb --na"));
    EXPECT_THAT(refusal({.na = 1, .nb = {1, 2}}), Names("--nb 1 2"));
    EXPECT_THAT(refusal({.inputs = {"u", "v"}, .order = 1, .delay = {1, 2, 3}}), Names("--delay 2 3"));
    EXPECT_THAT(refusal({.inputs = {"u"}, .regressors = {"u"}}),
                Names("--regressors --input --order --max-order --na --nb --delay"));
    EXPECT_THAT(refusal({.order = 1, .regressors = {"u"}}),
                Names("--regressors --input --order --max-order --na --nb --delay"));
    EXPECT_THAT(refusal({.delay = {1}, .regressors = {"u"}}),
                Names("--regressors --input --order --max-order --na --nb --delay"));
    EXPECT_THAT(refusal({.regressors = {"u", "y"}}), Names("--regressors y y[k-1]"));
    EXPECT_THAT(refusal({.regressors = {"y[k-201]", "u"}}), Names("--regressors y[k-201] 200"));
    EXPECT_THAT(refusal({.regressors = {"u", "u[k-201]"}}), Names("--regressors u[k-201] 200"));
    EXPECT_THAT(refusal({.regressors = {"w[k-1]"}}), Names("data.csv w"));
    EXPECT_THAT(refusal({.inputs = {"u", "u"}}), Names("data.csv u"));
    EXPECT_THAT(refusal({.inputs = {"y"}}), Names("data.csv y"));
    auto const without_input = [&](IdentifyOptions options) {
        options.output = "y";
        return message_of([&] { identify::identify(file, options); });
    };
    EXPECT_THAT(without_input({.na = 1, .nb = {1}}), Names("--nb --input"));
    EXPECT_THAT(without_input({.order = 1, .delay = {1}}), Names("--delay --input"));
    EXPECT_THAT(without_input({.na = 0}), Names("--na 1 --input"));
    EXPECT_THAT(message_of([&] { identify::identify(file, {.inputs = {"u"}}); }), Names("--output"));
}
TEST_F(Options, AreRefusedByTheProgramInOneLineWithExitCodeTwo) {
    for (auto const& [words, things] :
         std::vector<std::pair<std::string, std::string>>{{"--input u --na 1,2 --nb 1", "--na"},
                                                          {"--input u --na -1 --nb 1", "--na 0 200 -1"},
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
                                                          {"--input u --order 2 --na 2 --nb 2", "--order --na --nb"}}) {
        Outcome const run = program("data.csv --output y " + words);
        EXPECT_EQ(run.code, 2) << words;
        EXPECT_EQ(run.out, "") << words;
        EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
        EXPECT_THAT(run.err, Names(things)) << words;
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
    EXPECT_THAT(folder.without(message_of([&] { identify::identify(cut(9), options); })), Names("cut.csv 2 1 6 10 9"));
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
    EXPECT_THAT(said(u, Signal(60, 3.0)), Names("bad.csv y"));
    EXPECT_THAT(said(u, late), Names("bad.csv y 40 --validate"));
    EXPECT_THAT(said(Signal(60, 1.0), u), Names("bad.csv input"));
    for (double& x : tiny) x *= 0x1p-405;
    EXPECT_THAT(said(u, tiny), Names("bad.csv y power"));
    EXPECT_THAT(said(tiny, u), Names("bad.csv u power"));
    for (double& x : tiny) x *= 0x1p+7;  // about 2^-398 at most
    EXPECT_EQ(said(tiny, white_noise(60, Seed{9})), "no error");
}
/// Too short a memory is refused by its degrees of freedom, with a lambda that is long enough.
TEST_F(Options, AMemoryShorterThanTheParametersIsRefused) {
    EXPECT_THAT(refusal({.order = 2, .forgetting = 0.5}), Names("--forgetting 0.5 2 6 0.917"));
    EXPECT_EQ(refusal({.order = 2, .forgetting = 0.917}), "no error");
    EXPECT_GE(run({.order = 2, .forgetting = 0.917}).freedom, 1);
}

// --- what is printed -------------------------------------------------------------------------------------------------

TEST_F(Options, LambdaAndConfidenceThatLeaveNothingAreRefused) {
    for (double const lambda : {0.5, 1e-30, 1e-100, 1e-320})
        EXPECT_THAT(refusal({.order = 2, .forgetting = lambda}), Names("--forgetting lambda 6")) << lambda;
    EXPECT_THAT(program("data.csv --input u --output y --confidence 0.9999999999999999").err,
                Names("--confidence 0.001 0.999999"));
}
TEST_F(Options, APageOfALatin1NameIsUtf8) {
    std::string text = csv({white_noise(200, Seed{3}), white_noise(200, Seed{4})}, "T\xb0,y");
    std::string const page =
        as_page(identify::identify(folder.file(text, "latin.csv"), {.inputs = {"T\xb0"}, .output = "y", .order = 1}));
    EXPECT_NO_THROW(json(page).dump()) << "not UTF-8";
}

}  // namespace
}  // namespace rlslab
