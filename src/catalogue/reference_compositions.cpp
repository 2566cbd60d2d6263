// Compositions in 257 bits: the native ones' text, in the arithmetic that they are measured by.
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/catalogue/native/composing.hpp>

namespace rlslab {

template std::unique_ptr<AnyAdaptive<Reference>::Interface> AnyAdaptive<Reference>::named(std::string_view,
                                                                                          Problem<Reference> const&);
template AnyAdaptive<Reference> composed_around(Composition const&, GuardOptions<double> const&, std::string_view,
                                                Problem<Reference> const&);

}  // namespace rlslab
