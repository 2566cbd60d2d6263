// Rules of forgetting, windows and guards by name: what they tell, what is refused, the lists, and what `compare` and
// `identify` say of them. Their bits are tested in native_compositions.cpp and native_windows.cpp.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>
#include "tests/common/composed.hpp"
#include "tests/common/program.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/ud.hpp>

#include <nlohmann/json.hpp>

#include <cxxabi.h>
#include <set>

namespace rlslab {
namespace {

using namespace composed_laws;
using nlohmann::json;

TEST(Compositions, TellWhatAssessedTells) {
    Problem<double> const problem{.size = d, .forgetting = 0.96875, .prior = Prior<double>{.variance = 64}};
    using F = Guarded<Windowed<Qr<double>>, resetting>;
    using Ruled = Forgetting<Ud<double>, Kulhavy<double>>;
    Assessed<F> window(F(Windowed<Qr<double>>(problem, {.rows = 40}), problem), problem.forgetting);
    Assessed<Ruled> rule(Ruled(problem), problem.forgetting);
    auto const by_name = composed({.window = 40, .guard = "reset"}, "qr", "double", problem);
    auto const rule_by_name = composed({.control = "kulhavy", .parameters = {0.98, 0}}, "ud", "double", problem);
    Records const records = rows_of(300, 30, 150, Seed{12});
    EXPECT_TRUE(std::isnan(by_name->noise_variance()));
    auto const equal = [](Interval<double> const& a, Interval<double> const& b) {
        return a.value == b.value && a.deviation == b.deviation && a.low == b.low && a.high == b.high;
    };
    for (Index k = 0; k < records.rows(); ++k) {
        Vector<double> const psi = records.psi.col(k);
        if (k > 0) {
            EXPECT_TRUE(equal(window.prediction(psi), by_name->prediction(psi, 1.96))) << k;
            EXPECT_TRUE(equal(rule.prediction(psi), rule_by_name->prediction(psi, 1.96))) << k;
        }
        window.update(psi, records.y[k]), rule.update(psi, records.y[k]);
        by_name->update(psi, records.y[k]), rule_by_name->update(psi, records.y[k]);
        ASSERT_EQ(window.noise_variance(), by_name->noise_variance()) << k;
        ASSERT_EQ(rule.noise_variance(), rule_by_name->noise_variance()) << k;
        EXPECT_TRUE(equal(window.interval(k % d), by_name->interval(k % d, 1.96))) << k;
        EXPECT_TRUE(equal(rule.interval(k % d), rule_by_name->interval(k % d, 1.96))) << k;
        EXPECT_FALSE(equal(rule.interval(k % d), rule_by_name->interval(k % d, 2))) << k;
    }
}
TEST(Compositions, RefuseNumbersThatTheArithmeticCannotHold) {
    Problem<double> const problem{.size = d, .prior = Prior<double>{.variance = 64}};
    EXPECT_THROW(composed({.control = "fortescue", .parameters = {1e-300, 100, 0.5}}, "ud", "float", problem),
                 std::invalid_argument);
    EXPECT_THROW(composed({.control = "random_walk", .parameters = {1e300}}, "ud", "float", problem),
                 std::invalid_argument);
    EXPECT_THROW(composed({.control = "random_walk", .parameters = {1e300}}, "kalman", "float", problem),
                 std::invalid_argument);
    EXPECT_THROW(composed({.control = "random_walk", .parameters = {NAN}}, "ud", "double", problem),
                 std::invalid_argument);
    EXPECT_NE(composed({.control = "random_walk", .parameters = {1e300}}, "ud", "double", problem), nullptr);
    EXPECT_EQ(composed({.window = 9}, "ud", "quad", problem), nullptr);
}
TEST(Compositions, RefuseOptionsThatAreNone) {
    Problem<double> const problem{.size = d};
    for (Composition const& c : {Composition{.control = "random_walk"},
                                 {.control = "random_walk", .parameters = {1, 2}},
                                 {.parameters = {1}},
                                 {.window = -1},
                                 {.guard = "resett"}})
        for (char const* variant : {"ud", "kalman"})
            EXPECT_THROW(composed(c, variant, "double", problem), std::invalid_argument) << c.control << variant;
    EXPECT_THROW(composed({.control = "kulhavy", .parameters = {0.98}}, "ud", "double", problem),
                 std::invalid_argument);
    EXPECT_EQ(composed({.control = "resett"}, "ud", "double", problem), nullptr);
}
// --- the lists -------------------------------------------------------------------------------------------------------

template <class Rule>
std::string type_of() {
    std::unique_ptr<char, decltype(&std::free)> const text(
        abi::__cxa_demangle(typeid(Rule).name(), nullptr, nullptr, nullptr), &std::free);
    return text.get();
}
template <auto member>
std::string text_of() {
    return __PRETTY_FUNCTION__;
}
/// What the lists print as C++ is C++: the types, the members and the constants.
TEST(Compositions, RulesAndPoliciesArePrintedAsTheyAreWritten) {
    std::set<std::string_view> names;
    for_each(Rules<double>{}, [&]<class Rule>() {
        EXPECT_TRUE(names.insert(Rule::name).second) << Rule::name << " is there twice";
        EXPECT_EQ(type_of<Rule>(), "rlslab::" + std::string(Rule::type) + "<double>");
        auto const check = [](std::string_view member, std::string const& written) {
            EXPECT_THAT(written, testing::HasSubstr("::" + std::string(member)));
        };
        [&]<size_t... I>(std::index_sequence<I...>) {
            (check(std::get<I>(detail::numbers_of<Rule>()).member,
                   text_of<std::get<I>(detail::numbers_of<Rule>()).at>()),
             ...);
        }(std::make_index_sequence<std::tuple_size_v<decltype(detail::numbers_of<Rule>())>>());
        EXPECT_TRUE(std::ifstream(std::string(RLSLAB_SOURCE_DIR "/src/rlslab/") +
                                  std::string(control_named(Rule::name).header) + ".hpp"));
    });
    std::string const header = files::read(RLSLAB_SOURCE_DIR "/src/rlslab/adapt/guard_policy.hpp");
    for (NamedPolicy const& named : guard_policies) {
        EXPECT_THAT(header, testing::HasSubstr("GuardPolicy " + std::string(named.constant) + "{"));
        EXPECT_EQ(find_policy(named.name), &named) << named.name << " is there twice";
        EXPECT_TRUE(named.policy.valid());
    }
}

/// What obstacle() says is what composed() does, for every variant and composition.
TEST(Compositions, ExistWhereNothingStandsInTheWay) {
    Problem<double> const problem{.size = d, .forgetting = 0.9, .prior = Prior<double>{.variance = 64}};
    std::vector<std::string> guards{""};
    for (std::string_view const name : guard_names()) guards.emplace_back(name);
    std::vector<Composition> all;
    for (Index window : {0, 5})
        for (std::string const& guard : guards) {
            all.push_back({.window = window, .guard = guard});
            for (Control const& control : controls()) {
                all.push_back({.control = std::string(control.name), .window = window, .guard = guard});
                for (ControlParameter const& p : control.parameters)
                    all.back().parameters.push_back(p.whole ? 50 : std::isnan(p.start) ? 0.1 : p.start);
            }
        }
    std::map<std::string_view, int> made_of;
    for (Composition const& c : all)
        for (CatalogueEntry const* const entry : one_entry_each())
            for (char const* arithmetic : {"float", "double"}) {
                bool const none = !contradiction(c).empty() || !obstacle(c, entry->variant).empty();
                auto const made = composed(c, entry->variant, arithmetic, problem);
                ASSERT_EQ(made == nullptr, none)
                    << entry->variant << ' ' << c.control << ' ' << c.window << ' ' << c.guard;
                if (!made) continue;
                ++made_of[entry->variant];
                Records const records = rows_of(130, 1e3, 60, Seed{14});
                for (Index k = 0; k < records.rows(); ++k)
                    made->update(records.sample(k), records.y[k]);  // nothing is asked in vain
                EXPECT_EQ(made->interval(0, 1).value, static_cast<double>(made->theta()[0])) << entry->variant;
                made->prediction(records.sample(0), 1);
            }
    EXPECT_EQ(made_of["qr_block"], 0);
    EXPECT_GT(made_of["ud"], made_of["potter"]);
    EXPECT_GT(made_of["potter"], made_of["kalman"]);
}

// --- compare ---------------------------------------------------------------------------------------------------------

class ComposedCommand : public Program {
protected:
    std::string const sales =
        "compare '" + root + "/studies/data/sales.csv' --input lead --output sales --order 2 --detrend --no-timings ";
    json compared(std::string const& options) const {
        Outcome const run = shell("rlslab " + sales + options + " --json");
        EXPECT_LE(run.code, 1) << options << run.err;
        return run.code <= 1 ? json::parse(run.out) : json();
    }
};

TEST_F(ComposedCommand, SaysWhatItsDigitsAreComparedWith) {
    json const window = compared("--window 60 --guard reset");
    EXPECT_EQ(window["composition"]["text"], "window of 60 rows; guard reset");
    EXPECT_THAT(std::string(window["composition"]["digits"]), Names("certified window"));
    EXPECT_THAT(std::string(compared("--control random_walk:1e-4")["composition"]["digits"]), Names("257 bits"));
    json const plain = compared("");
    EXPECT_FALSE(plain.contains("composition"));
    EXPECT_FALSE(plain["results"][0].contains("happened"));
    int cannot = 0;
    for (json const& r : window["results"]) {
        cannot += !r["obstacle"].is_null();
        EXPECT_TRUE(r["obstacle"].is_null() || r["spread"]["theta"].is_null()) << r["variant"];
        EXPECT_EQ(r["happened"]["refactored"].size(), r["obstacle"].is_null() ? window["checkpoints"].size() : 0)
            << r["variant"];
    }
    EXPECT_GT(cannot, 0);
    Outcome const text = shell("rlslab " + sales + "--window 500 --variants ud,potter,kalman");
    EXPECT_THAT(text.out, Names("window 500"));
    EXPECT_THAT(text.out, Names("kalman state"));
    EXPECT_THAT(shell("rlslab " + sales + "--control random_walk:1e60 --arithmetic float").out,
                Names("a number of the control is 0 or infinite"));
    EXPECT_THAT(shell("rlslab " + sales + "--certify --variants ud,kalman").out, Names("None in kalman."));
}
TEST_F(ComposedCommand, AnswersTheSameWithAnyNumberOfThreads) {
    for (std::string options : {"--window 60 --guard rebuild --json", "--control fortescue --csv", "--guard reset"})
        EXPECT_EQ(shell("rlslab " + sales + options + " --no-timings --threads 1").out,
                  shell("rlslab " + sales + options + " --no-timings --threads 3").out);
}
TEST_F(ComposedCommand, SkipsMissingValuesAndNamesAnExactFit) {
    write("holes.csv",
          "u,y\n" + rows(80, [](int k) { return k % 9 == 4 ? std::string("NaN") : std::to_string(k * 5 % 13); }));
    json const holes = json::parse(
        shell("rlslab compare holes.csv --input u --output y --order 1 --window 20 --guard reset --json").out);
    EXPECT_GT(holes["data"]["skipped"], 0);
    write(
        "exact.csv", "u,y\n" + [] {
            std::string text;
            for (int k = 0; k < 40; ++k)
                text += std::to_string(k * 5 % 13) + "," + std::to_string(2 * (k * 5 % 13)) + "\n";
            return text;
        }());
    refused("compare exact.csv --regressors u --output y --control fortescue", "--control fortescue");
    EXPECT_LE(shell("rlslab compare exact.csv --regressors u --output y --control fortescue:0.01").code, 1);
    refused("compare exact.csv --regressors u --output y --control cao_schwartz:1e-400", "LAMBDA 0 1");
}

// --- identify --------------------------------------------------------------------------------------------------------

class ComposedIdentify : public Program {
protected:
    /// A system whose gain drifts from 1 to 2 over the record, if `drifts`; noise of standard deviation 0.1.
    void record(int seed, bool drifts) const {
        std::string text = "u,y\n";
        Seed draws{std::uint64_t(seed)};
        double y = 0, u = 0;
        for (int k = 0; k < 1200; ++k) {
            y = 0.5 * y + (drifts ? 1 + k / 1200.0 : 1) * u + 0.1 * draws.bell();
            u = draws.bell();
            text += std::to_string(u) + "," + std::to_string(y) + "\n";
        }
        write("data.csv", text);
    }
    json identified(std::string const& options) const {
        Outcome const run =
            shell("rlslab identify data.csv --input u --output y --na 1 --nb 0 --delay 1 " + options + " --json");
        EXPECT_EQ(run.code, 0) << options << run.err;
        return run.code == 0 ? json::parse(run.out) : json();
    }
};

TEST_F(ComposedIdentify, EndsWhereTheModelDoesWhenNothingIsComposed) {
    record(1, false);
    for (std::string options : {"--control constant", "--guard report", "--window 5000"}) {
        json const out = identified(options + " --validate 0 --forgetting 0.99");
        json const& last = out["tracked"]["rows"].back();
        for (size_t i = 0; i < 2; ++i) EXPECT_EQ(out["parameters"][i]["value"], last["theta"][i]) << options;
        EXPECT_EQ(last["row"], 1200);
    }
    json const other = identified("--window 100 --validate 0");
    EXPECT_NE(other["parameters"][0]["value"], other["tracked"]["rows"].back()["theta"][0]);
    EXPECT_FALSE(identified("").contains("tracked"));
}
/// 1199 outputs in 95 % intervals: 99.9 % of binomial counts lie within 2.1 % of it.
TEST_F(ComposedIdentify, PredictsWithItsVariance) {
    for (int seed : {2, 3, 4}) {
        record(seed, false);
        for (std::string options : {"--window 200", "--forgetting 0.99 --guard report"}) {
            json const tracked = identified(options)["tracked"];
            EXPECT_NEAR(double(tracked["covered"]), 0.95, 0.025) << options << " seed " << seed;
            EXPECT_NEAR(double(tracked["rows"].back()["noise_variance"]), 0.01, 0.003) << options;
        }
    }
}
TEST_F(ComposedIdentify, SaysThatItBrokeDownAndWhatIsOdd) {
    record(4, false);
    Outcome const broken = shell("rlslab identify data.csv --input u --output y --order 1 --control random_walk:1e308");
    EXPECT_EQ(broken.code, 1);
    EXPECT_THAT(broken.out, Names("nonfinite row"));
    Outcome const short_window = shell("rlslab identify data.csv --input u --output y --order 1 --window 2");
    EXPECT_THAT(short_window.out, Names("window 2 rows"));
    EXPECT_THAT(shell("rlslab identify data.csv --input u --output y --order 1 --window 100000").out,
                Names("window 100000"));
    EXPECT_EQ(shell("rlslab identify data.csv --input u --output y --order 1 --control cao_schwartz:1e-320").code, 2);
    EXPECT_THAT(shell("rlslab compare data.csv --input u --output y --order 1 --window 50").out,
                Names("prior window 50"));
}
TEST_F(ComposedIdentify, FollowsADrift) {
    record(5, true);
    json const still = identified("--control constant")["tracked"],
               walks = identified("--control random_walk:1e-4")["tracked"];
    EXPECT_GT(double(walks["fit_one_step"]), double(still["fit_one_step"]) + 1);
    EXPECT_NEAR(double(walks["rows"].back()["theta"][1]), 2, 0.2);
    EXPECT_GT(std::abs(double(still["rows"].back()["theta"][1]) - 2), 0.3);
}
TEST_F(ComposedIdentify, WritesARowForEachRow) {
    record(6, true);
    identified("--window 50 --guard reset --out model");
    std::string const csv = without_run(read(folder / "model/tracked.csv"));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 1199);
    EXPECT_THAT(csv.substr(0, 120), testing::StartsWith("row,y,predicted,predicted_sd,noise_variance,\"a1\",\"a1_sd\","
                                                        "\"b0\",\"b0_sd\",\"c\",\"c_sd\",refactored,"));
    EXPECT_TRUE(csv.find("\n1200,") != std::string::npos);
    EXPECT_EQ(shell("rlslab identify data.csv --input u --output y --order 1 --variant kalman --control constant").code,
              0);
}

}  // namespace
}  // namespace rlslab
