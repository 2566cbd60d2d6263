// What each variant lets others do to its state.
#include <rlslab/catalogue/native/compose.hpp>

#include <rlslab/adapt/rules.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab {

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

}  // namespace rlslab
