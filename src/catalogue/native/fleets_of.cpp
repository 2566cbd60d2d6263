// Fleets of the variants in one arithmetic, RLSLAB_NATIVE: float or double, eight filters at a time.
#include <rlslab/catalogue/native/fleet_of.hpp>

#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::native {

template <class T>
std::unique_ptr<Fleet> fleet_named(std::string_view variant, Index filters, Problem<T> const& problem) {
    std::unique_ptr<Fleet> out;
    for_each(Variants<Pack<T, 8>>{}, [&]<class F>() {
        if constexpr (KeepsLanesApart<F>)
            if (F::name == variant) {
                using Filters = rlslab::Fleet<F>;
                out = std::make_unique<FleetOf<Filters>>(1, problem, Filters(filters, problem));
            }
    });
    return out;
}
template std::unique_ptr<Fleet> fleet_named(std::string_view, Index, Problem<RLSLAB_NATIVE> const&);

}  // namespace rlslab::native
