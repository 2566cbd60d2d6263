// Rules of forgetting, windows and guards by name: what they tell, what is refused, and the lists. Their bits are
// tested in native_compositions.cpp.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>
#include "tests/common/composed.hpp"
#include "tests/common/program.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/ud.hpp>

#include <cxxabi.h>
#include <fstream>
#include <set>

namespace rlslab {
namespace {

using namespace composed_laws;

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

}  // namespace
}  // namespace rlslab
