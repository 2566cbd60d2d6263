// Compositions in 257 bits.
#include <rlslab/catalogue/reference_compositions.hpp>

#include <rlslab/catalogue/native/composing.hpp>

namespace rlslab {

template <>
std::unique_ptr<AnyAdaptive<Reference>::Interface> AnyAdaptive<Reference>::named(std::string_view variant,
                                                                                 Problem<Reference> const& problem) {
    return detail::adaptive_named<Reference>(variant, problem);
}
template <>
AnyAdaptive<Reference> composed_around(Composition const& composition, GuardOptions<double> const& guard_options,
                                       std::string_view variant, Problem<Reference> const& problem) {
    return detail::composition_around<Reference>(composition, guard_options, variant, problem);
}

}  // namespace rlslab
