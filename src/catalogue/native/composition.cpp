// Rules of forgetting, windows and guards by name: which there are, which variant they go around, and what each variant
// lets others do to its state.
#include <rlslab/catalogue/native/composition.hpp>
#include <rlslab/catalogue/native/compose.hpp>

#include <rlslab/adapt/rules.hpp>
#include <rlslab/variants/variants.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab {

namespace {

template <class Rule>
Control control_of() {
    Control out{Rule::name, Rule::what, Rule::type, "adapt/forgetting", false, {}};
    if constexpr (requires { Rule::header; }) out.header = Rule::header;
    if constexpr (requires { Rule::below_one; }) out.below_one = Rule::below_one;
    detail::for_each_number<Rule>([&]<class X>(RuleNumber<Rule, X> const& n) {
        double const start = n.range.otherwise == RuleDefault::member ? double(Rule{}.*n.at) : std::nan("");
        if (!n.name.empty()) out.parameters.push_back({n.name, n.member, std::same_as<X, Index>, start, n.range});
    });
    return out;
}

}  // namespace

std::vector<Control> const& controls() {
    static std::vector<Control> const all = [] {
        std::vector<Control> out;
        for_each(Rules<double>{}, [&]<class Rule>() { out.push_back(control_of<Rule>()); });
        return out;
    }();
    return all;
}

Control const& control_named(std::string_view name) {
    auto const found = std::ranges::find(controls(), name, &Control::name);
    expects(found != controls().end(), "the name of a rule of forgetting");
    return *found;
}

std::vector<std::string_view> const& guard_names() {
    static std::vector<std::string_view> const all = [] {
        std::vector<std::string_view> out;
        for (NamedPolicy const& named : guard_policies) out.push_back(named.name);
        return out;
    }();
    return all;
}

bool Composition::keeps_the_problem() const { return control.empty() || control == ConstantForgetting<double>::name; }

GuardPolicy Composition::policy() const {
    if (guard.empty()) return reporting;
    NamedPolicy const* const named = find_policy(guard);
    expects(named != nullptr, "the name of a guard's policy");
    return named->policy;
}

VariantAbilities abilities_of(std::string_view variant) {
    VariantAbilities out;
    for_each(Variants<double>{}, [&]<class F>() {
        if (F::name != variant) return;
        out.single_rows = !TakesBlocks<F>;
        out.walks = std::constructible_from<F, Problem<double>, Matrix<double>>;
        out.abilities = abilities_by_type<F>();
        for_each(Rules<double>{}, [&]<class Rule>() {
            if constexpr (ForgettingRule<Rule, F>) out.rules.push_back(Rule::name);
        });
    });
    return out;
}

std::string contradiction(Composition const& c) {
    expects(0 <= c.certify && c.certify <= most_probes, "0 (none) to 6 probes");
    expects(c.digits == 0 || (c.certify > 0 && !c.guard.empty()), "probes and a guard beside digits");
    expects(0 <= c.digits && c.digits < 1000, "digits >= 0 that a bound can show");
    static_cast<void>(c.policy());  // throws where no policy has the guard's name
    if (c.window > 0 && !c.keeps_the_problem()) return "a window takes rows back, whose weight a rule has changed";
    return "";
}

bool is_its_own_rule(Composition const& c, std::string_view variant) {
    return c.control == RandomWalk<double>::name && c.window == 0 && c.guard.empty() && c.certify == 0 &&
           abilities_of(variant).walks;
}

std::string obstacle(Composition const& c, std::string_view variant) {
    VariantAbilities const can = abilities_of(variant);
    Abilities const& a = can.abilities;
    bool const ruled = !c.keeps_the_problem();
    if (c.certify > 0 && !a.certifiable) return "does not multiply probes by its P";
    if (!ruled && c.window == 0 && c.guard.empty() && c.certify == 0)
        return can.single_rows ? "" : "takes rows in blocks, or is another library's";
    if (is_its_own_rule(c, variant)) return "";
    if (!a.form) return "shows no state that could be discounted, reset or relieved of a row";
    if (c.window > 0 && !a.downdates) return "takes no row back";
    if (ruled && std::ranges::count(can.rules, c.control) == 0)
        return !a.inflates      ? "takes no P + c a a': its square root of P is no triangle"
               : !a.information ? "has psi'P^-1 psi not at hand: it stores P, or no triangle"
                                : "lacks an operation that the rule needs";
    if (!a.guardable && (c.window > 0 || !c.guard.empty())) return "cannot look at a row before it takes it";
    return "";
}

}  // namespace rlslab
