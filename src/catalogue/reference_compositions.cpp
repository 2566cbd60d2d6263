// Compositions in 257 bits: the native ones' text, in the arithmetic that they are measured by.
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/catalogue/native/composing.hpp>

namespace rlslab {

using T = Reference;

template std::unique_ptr<AnyAdaptive<T>::Interface> AnyAdaptive<T>::named(std::string_view, Problem<T> const&);
template AnyAdaptive<T> composed_around(Composition const&, GuardOptions<double> const&, std::string_view,
                                        Problem<T> const&);

}  // namespace rlslab
