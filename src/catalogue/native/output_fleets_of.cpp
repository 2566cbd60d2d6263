// Fleets of several outputs of the variants in one kind of numbers, RLSLAB_NUMBERS<RLSLAB_NATIVE>: Complex<float> or
// the like, eight filters at a time.
#include <rlslab/catalogue/native/fleet_of.hpp>

#include <rlslab/many/output_fleet.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::native {

template <class N>
std::unique_ptr<Fleet> output_fleet_named(std::string_view variant, Index filters, Index outputs,
                                          Problem<N> const& problem) {
    using Lanes = RLSLAB_NUMBERS<Pack<RealOf<N>, 8>>;
    std::unique_ptr<Fleet> out;
    for_each(Variants<Lanes>{}, [&]<class F>() {
        if constexpr (InLockstep<F> && (ComplexScalar<N> || ReportsCovariance<F>))
            if (F::name == variant) {
                using Filters = OutputFleet<F>;
                out = std::make_unique<FleetOf<Filters>>(outputs, problem, Filters(filters, problem, outputs));
            }
    });
    return out;
}
template std::unique_ptr<Fleet> output_fleet_named(std::string_view, Index, Index,
                                                   Problem<RLSLAB_NUMBERS<RLSLAB_NATIVE>> const&);

}  // namespace rlslab::native
