// A composition in the arithmetic of that name.
#include <rlslab/catalogue/compose.hpp>

#include <rlslab/arithmetic/arithmetics.hpp>

namespace rlslab {
namespace {

template <class T, int I = 0>
constexpr int place_of() {
    if constexpr (std::same_as<ArithmeticAt<I>, T>) return I;
    else return place_of<T, I + 1>();
}

}  // namespace

std::unique_ptr<ComposedFilter> composed(Composition const& composition, std::string_view variant,
                                         std::string_view arithmetic, Problem<double> const& problem) {
    if (!contradiction(composition).empty() || !obstacle(composition, variant).empty()) return nullptr;
    if (arithmetic == "float") return compose<place_of<float>()>(composition, variant, problem);
    if (arithmetic == "double") return compose<place_of<double>()>(composition, variant, problem);
    if (arithmetic == "reference") return compose<place_of<Reference>()>(composition, variant, problem);
    return nullptr;
}

}  // namespace rlslab
