// What the filters of a fleet can do besides an update, and how one is made.
#pragma once

#include <rlslab/state/lanes.hpp>

namespace rlslab::detail {

template <class F>
concept TakesWeights = requires(F& f, Regressor<typename F::scalar> psi, typename F::scalar x) { f.update(psi, x, x); };
/// The filter of numbers beside F, or F where there is none.
template <class F>
struct Beside {
    using type = F;
};
template <HasOneLane F>
struct Beside<F> {
    using type = OneLaneOf<F>;
};
/// A filter of a problem, without options.
template <class F>
struct MakesFilters {
    F operator()(Problem<typename F::scalar> const& problem) const { return F(problem); }
    auto operator()(Problem<typename F::scalar::lane_type> const& problem) const
        requires HasOneLane<F>
    {
        return OneLaneOf<F>(problem);
    }
};

}  // namespace rlslab::detail
