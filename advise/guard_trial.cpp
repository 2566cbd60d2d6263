// Every variant that can be guarded, in float and double.
#include "advise/guard_trial.hpp"

#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::compare {
namespace {

template <class F>
GuardTrial tried(Problem<double> const& problem, Records const& records) {
    using T = typename F::scalar;
    F alone(problem_as<T>(problem));
    Guarded<F> guarded(problem_as<T>(problem));
    bool same_bits = true;
    for (Index k = 0; k < records.rows(); ++k) {
        Vector<T> const psi = records.psi.col(k).unaryExpr(&round_to<T>);
        alone.update(psi, round_to<T>(records.y[k]));
        guarded.update(psi, round_to<T>(records.y[k]));
        same_bits = same_bits && Vector<T>(alone.theta()) == Vector<T>(guarded.theta());
    }
    return {guarded.counts(), same_bits};
}

template <class T>
std::optional<GuardTrial> tried_in(std::string_view variant, Problem<double> const& problem, Records const& records) {
    std::optional<GuardTrial> out;
    for_each(Variants<T>{}, [&]<class F>() {
        if constexpr (Guardable<F>)
            if (F::name == variant) out = tried<F>(problem, records);
    });
    return out;
}

}  // namespace

std::optional<GuardTrial> guard_trial(std::string_view variant, std::string_view arithmetic, Problem<double> const& problem,
                                      Records const& records) {
    if (arithmetic == "float") return tried_in<float>(variant, problem, records);
    if (arithmetic == "double") return tried_in<double>(variant, problem, records);
    return {};
}

}  // namespace rlslab::compare
