// Compositions in one arithmetic, RLSLAB_NATIVE: float or double.
#include <rlslab/catalogue/native/composing.hpp>

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

}  // namespace rlslab
