// Rules of forgetting, windows and guards by name: the bits of the types that they name.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>
#include "tests/common/composed.hpp"
#include "tests/common/program.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/guard.hpp>
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
