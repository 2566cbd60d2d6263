// Fleets of several outputs, and of complex numbers, of the variants in one arithmetic, RLSLAB_NATIVE: float or double,
// eight filters at a time.
#include <rlslab/catalogue/native/fleet_of.hpp>

#include <rlslab/many/output_fleet.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::native {
namespace {

template <class C, class N>
std::unique_ptr<Fleet> named(std::string_view variant, Index filters, Index outputs, Problem<N> const& problem) {
    std::unique_ptr<Fleet> out;
    for_each(Variants<C>{}, [&]<class F>() {
        if constexpr (InLockstep<F> && (ComplexScalar<N> || ReportsCovariance<F>))
            if (F::name == variant) {
                using Filters = OutputFleet<F>;
                out = std::make_unique<FleetOf<Filters>>(outputs, problem, Filters(filters, problem, outputs));
            }
    });
    return out;
}

}  // namespace

template <class T>
std::unique_ptr<Fleet> output_fleet_named(std::string_view variant, Index filters, Index outputs, bool is_complex,
                                          Problem<T> const& problem) {
    if (!is_complex) return named<Pack<T, 8>>(variant, filters, outputs, problem);
    Problem<Complex<T>> in_complex{.size = problem.size, .forgetting = problem.forgetting};
    if (problem.prior) in_complex.prior->variance = problem.prior->variance;
    else in_complex.prior.reset();
    return named<Complex<Pack<T, 8>>>(variant, filters, outputs, in_complex);
}
template std::unique_ptr<Fleet> output_fleet_named(std::string_view, Index, Index, bool, Problem<RLSLAB_NATIVE> const&);

}  // namespace rlslab::native
