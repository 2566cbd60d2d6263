// Rules of forgetting, windows and guards by name: the bits of the types that they name, and what the commands say.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>
#include "tests/common/composed.hpp"
#include "tests/common/program.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/hand_over.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/kalman.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/ud.hpp>

#include <cxxabi.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

namespace rlslab {
namespace {

using namespace composed_laws;

// --- the bits --------------------------------------------------------------------------------------------------------

template <class F>
bool same_numbers(F const& typed, AnyFilter const& composed) {
    using T = typename F::scalar;
    auto const exact = [](T const& x) { return widen(x); };
    Stored<Reference> const a = typed.stored().template mapped<Reference>(exact), b = composed.stored();
    Vector<Reference> const x = Vector<T>(typed.theta()).unaryExpr(exact), y = composed.theta();
    return a.F == b.F && a.D == b.D && x == y;
}
/// Rows over which a composition has the bits of the type, from the first on.
template <class F>
Index rows_alike(F typed, ComposedFilter& composed, Records const& records) {
    using T = typename F::scalar;
    for (Index k = 0; k < records.rows(); ++k) {
        Vector<T> const psi = records.psi.col(k).unaryExpr(&round_to<T>);
        typed.update(psi, round_to<T>(records.y[k]));
        composed.update(records.sample(k), records.y[k]);
        if (!same_numbers(typed, composed)) return k;
    }
    return records.rows();
}

template <class F>
class Typed {
    using T = typename F::scalar;
    Problem<double> given_;
    Problem<T> problem_;
    Records records_ = rows_of(400, 100, 250, Seed{11});

public:
    explicit Typed(double forgetting)
        : given_{.size = d, .forgetting = forgetting, .prior = Prior<double>{.variance = 64}},
          problem_(problem_as<T>(given_)) {}
    Problem<T> const& problem() const { return problem_; }
    template <class Composed>
    void check(Composed const& typed, Composition const& composition) const {
        auto const made = composed(composition, F::name, ArithmeticTraits<T>::name, given_);
        ASSERT_NE(made, nullptr) << F::name;
        EXPECT_EQ(rows_alike(typed, *made, records_), records_.rows())
            << F::name << ' ' << composition.control << ' ' << composition.window << ' ' << composition.guard;
    }
    void alone_is_another(Composition const& composition) const {
        auto const made = composed(composition, F::name, ArithmeticTraits<T>::name, given_);
        EXPECT_LT(rows_alike(F(problem_), *made, records_), records_.rows())
            << composition.control << composition.guard;
    }
};
template <class F>
void check_some() {
    using T = typename F::scalar;
    Typed<F> const t(1);
    t.check(Windowed<F>(t.problem(), {.rows = 20}), {.window = 20});
    t.check(Guarded<F, resetting>(t.problem()), {.guard = "reset"});
    t.check(Forgetting<F, Kulhavy<T>>(t.problem(), {.forgetting = T(0.95), .least_excitation = T(0.5)}),
            {.control = "kulhavy", .parameters = {0.95, 0.5}});
    t.check(Forgetting<F, Fortescue<T>>(t.problem(), {.noise_variance = T(0.02), .memory = T(50), .least = T(0.25)}),
            {.control = "fortescue", .parameters = {0.02, 50, 0.25}});
    t.alone_is_another({.window = 20});
    t.alone_is_another({.guard = "reset"});
    t.alone_is_another({.control = "kulhavy", .parameters = {0.95, 0.5}});
    t.alone_is_another({.control = "fortescue", .parameters = {0.02, 50, 0.25}});
}
template <class F>
void check_others() {
    using T = typename F::scalar;
    using W = Windowed<F>;
    Typed<F> const t(0.96875);
    t.check(F(t.problem()), {.control = "constant"});
    t.check(Guarded<F, reporting>(t.problem()), {.guard = "report"});
    t.check(Guarded<F, rebuilding>(t.problem()), {.guard = "rebuild"});
    t.check(Guarded<Relay<F, Ud<std::conditional_t<std::same_as<T, float>, double, Quad>>>, handing_over>(t.problem()),
            {.guard = "hand_over"});
    t.check(Guarded<W, resetting>(W(t.problem(), {.rows = 30}), t.problem()), {.window = 30, .guard = "reset"});
    t.check(Forgetting<F, RotatingRidge<T>>(t.problem(), {.ridge = T(0.25)}),
            {.control = "ridge", .parameters = {0.25}});
    t.check(Forgetting<F, CovarianceReset<T>>(t.problem(), {.period = 70, .variance = T(9)}),
            {.control = "reset", .parameters = {70, 9}});
    t.check(Forgetting<F, RandomWalk<T>>(t.problem(), {.variance = T(0.01)}),
            {.control = "random_walk", .parameters = {0.01}});
    using Walks = Forgetting<F, RandomWalk<T>>;
    t.check(Guarded<Walks, resetting>(Walks(t.problem(), {.variance = T(0.01)}), t.problem()),
            {.control = "random_walk", .parameters = {0.01}, .guard = "reset"});
    if constexpr (ReportsInformationAlong<F>)
        t.check(Forgetting<F, CaoSchwartz<T>>(t.problem(), {.forgetting = T(0.9)}),
                {.control = "cao_schwartz", .parameters = {0.9, 0}});
}

TEST(Compositions, HaveTheBitsOfTheTypesInDouble) {
    check_some<Ud<double>>();
    check_some<Qr<double>>();
    check_some<Carlson<double>>();
    check_some<Conventional<double>>();
    check_others<Ud<double>>();
    check_others<Qr<double>>();
}
TEST(Compositions, HaveTheBitsOfTheTypesInFloat) {
    check_some<Ud<float>>();
    check_others<Ud<float>>();
}
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
TEST(Compositions, WalkAsKalmansOwnFilterDoes) {
    Problem<double> const problem{.size = d, .prior = Prior<double>{.variance = 64}};
    Kalman<double> const typed(problem, Matrix<double>::Identity(d, d) * 0.01);
    auto const made = composed({.control = "random_walk", .parameters = {0.01}}, "kalman", "double", problem);
    EXPECT_EQ(rows_alike(typed, *made, rows_of(200, 1, 100, Seed{13})), 200);
    auto const other = composed({.control = "random_walk", .parameters = {0.02}}, "kalman", "double", problem);
    EXPECT_LT(rows_alike(typed, *other, rows_of(200, 1, 100, Seed{13})), 200);
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
    std::ifstream in(RLSLAB_SOURCE_DIR "/src/rlslab/adapt/guard_policy.hpp");
    std::string const header{std::istreambuf_iterator<char>(in), {}};
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

// --- the command line ------------------------------------------------------------------------------------------------

using nlohmann::json;

class ComposedCommand : public Program {
protected:
    std::string const sales =
        "compare '" + root + "/data/sales.csv' --input lead --output sales --order 2 --detrend --no-timings ";
    json compared(std::string const& options) const {
        Outcome const run = shell("rlslab " + sales + options + " --json");
        EXPECT_LE(run.code, 1) << options << run.err;
        return run.code <= 1 ? json::parse(run.out) : json();
    }
};

TEST_F(ComposedCommand, RefusesWhatMakesNoSense) {
    refused(sales + "--control fortescu", "--control: no control \"fortescu\" (did you mean \"fortescue\"?)");
    refused(sales + "--control \"\"", "--control: expected the name of a control");
    refused(sales + "--guard rest", "--guard: no policy \"rest\" (did you mean \"reset\"?)");
    refused(sales + "--window 0", "--window");
    refused(sales + "--window 1.5", "--window");
    refused(sales + "--window 60 --control kulhavy",
            "do not go together: a window takes rows back, whose weight a rule has changed");
    refused(sales + "--window 60 --guard hand_over", "do not go together");
    refused(sales + "--control random_walk", "--control: expected random_walk:VARIANCE");
    refused(sales + "--control random_walk:nan",
            "--control random_walk: VARIANCE: expected a number from 0, found \"nan\"");
    refused(sales + "--control random_walk:1e999", "VARIANCE: expected a number");
    refused(sales + "--control kulhavy:1.5",
            "--control kulhavy: LAMBDA: expected a number above 0 to 1, found \"1.5\"");
    refused(sales + "--control kulhavy:0.9:0:1", "--control: expected kulhavy[:LAMBDA[:EXCITATION]], found");
    refused(sales + "--control reset:2.5",
            "--control reset: PERIOD: expected a whole number from 1 to 10000000, found \"2.5\"");
    refused(sales + "--control reset:", "PERIOD");
    refused(sales + "--control ridge", "--control ridge: expected --forgetting below 1");
    refused(sales + "--window 60 --arithmetic bfloat16",
            "--control, --window and --guard exist in float and double, not in bfloat16");
    refused(sales + "--window 60 --all", "--all: does not go with --control, --window or --guard");
    refused(sales + "--guard reset --variants kalman", "kalman shows no state that could be discounted");
}
TEST_F(ComposedCommand, SaysWhatItsDigitsAreComparedWith) {
    json const window = compared("--window 60 --guard reset");
    EXPECT_EQ(window["composition"]["text"], "window of 60 rows; guard reset");
    EXPECT_THAT(std::string(window["composition"]["digits"]),
                testing::StartsWith("against the certified least-squares solution of the rows in the window"));
    EXPECT_THAT(std::string(compared("--control random_walk:1e-4")["composition"]["digits"]),
                testing::StartsWith("against the same recursion in 257 bits"));
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
    EXPECT_THAT(text.out,
                testing::HasSubstr("the window of 500 rows is as long as the record, or longer: no row leaves it"));
    EXPECT_THAT(text.out, testing::HasSubstr("shows no state"));
}
TEST_F(ComposedCommand, AnswersTheSameWithAnyNumberOfThreads) {
    for (std::string options : {"--window 60 --guard rebuild --json", "--control fortescue --csv", "--guard hand_over"})
        EXPECT_EQ(shell("rlslab " + sales + options + " --threads 1").out,
                  shell("rlslab " + sales + options + " --threads 3").out);
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
    refused("compare exact.csv --regressors u --output y --control fortescue",
            "none follows from a record that the model fits exactly");
    EXPECT_LE(shell("rlslab compare exact.csv --regressors u --output y --control fortescue:0.01").code, 1);
    refused("compare exact.csv --regressors u --output y --control cao_schwartz:1e-400",
            "LAMBDA: expected a number above 0 to 1 that double can hold");
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
    EXPECT_THAT(broken.out, testing::HasSubstr("broke down: nonfinite at row "));
    Outcome const short_window = shell("rlslab identify data.csv --input u --output y --order 1 --window 2");
    EXPECT_THAT(short_window.out, testing::HasSubstr("does not determine"));
    EXPECT_THAT(shell("rlslab identify data.csv --input u --output y --order 1 --window 100000").out,
                testing::HasSubstr("no row leaves it"));
    EXPECT_EQ(shell("rlslab identify data.csv --input u --output y --order 1 --control cao_schwartz:1e-320").code, 2);
    EXPECT_THAT(shell("rlslab compare data.csv --input u --output y --order 1 --window 50").out,
                testing::HasSubstr("with the prior, of all rows"));
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
    std::string const csv = read(folder / "model/tracked.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 1199);
    EXPECT_THAT(csv.substr(0, 120), testing::StartsWith("row,y,predicted,predicted_sd,noise_variance,\"a1\",\"a1_sd\","
                                                        "\"b0\",\"b0_sd\",\"c\",\"c_sd\",refactored,"));
    EXPECT_TRUE(csv.find("\n1200,") != std::string::npos);
    EXPECT_EQ(shell("rlslab identify data.csv --input u --output y --order 1 --variant kalman --control constant").code,
              0);
    refused("identify data.csv --input u --output y --order 1 --variant kalman --window 9",
            "--variant kalman: shows no state");
    refused("identify data.csv --input u --output y --order 1 --control nothing", "--control: no control \"nothing\"");
}

}  // namespace
}  // namespace rlslab
