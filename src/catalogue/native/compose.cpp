// The variants and their compositions in one arithmetic, RLSLAB_NATIVE: float or double.
#include <rlslab/catalogue/native/composing.hpp>

namespace rlslab {

using T = RLSLAB_NATIVE;

template std::unique_ptr<AnyAdaptive<T>::Interface> AnyAdaptive<T>::named(std::string_view, Problem<T> const&);
template AnyAdaptive<T> composed_around(Composition const&, GuardOptions<double> const&, std::string_view,
                                        Problem<T> const&);

}  // namespace rlslab
