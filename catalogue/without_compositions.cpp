// A catalogue without compositions, for the program that is compiled in a fraction of the time.
#include <rlslab/catalogue/composed.hpp>

#include <rlslab/core/input_error.hpp>

namespace rlslab {

std::unique_ptr<ComposedFilter> composed(Composition const&, std::string_view, std::string_view,
                                         Problem<double> const&) {
    throw InputError("--control, --window, --guard, --digits: not in this program: use rlslab");
}

}  // namespace rlslab
