// Compositions in one arithmetic, RLSLAB_NATIVE: float or double.
#include <rlslab/catalogue/native/composing.hpp>

#include <rlslab/catalogue/native/filter_of.hpp>
#include <rlslab/catalogue/native/makers.hpp>

namespace rlslab {

using T = RLSLAB_NATIVE;

template <>
std::unique_ptr<AnyAdaptive<T>::Interface> AnyAdaptive<T>::named(std::string_view variant, Problem<T> const& problem) {
    return detail::adaptive_named<T>(variant, problem);
}
template <>
AnyAdaptive<T> composed_around(Composition const& composition, GuardOptions<double> const& guard_options,
                               std::string_view variant, Problem<T> const& problem) {
    return detail::composition_around<T>(composition, guard_options, variant, problem);
}

namespace native {

template <>
std::unique_ptr<Filter> composed(Composition const& composition, GuardOptions<double> const& guard_options,
                                 std::string_view variant, Problem<T> const& problem) {
    return std::make_unique<FilterOf<AnyAdaptive<T>>>(
        [=, name = std::string(variant)] { return composed_around<T>(composition, guard_options, name, problem); });
}

}  // namespace native
}  // namespace rlslab
