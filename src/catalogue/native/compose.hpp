// Compositions around a variant, both named while the program runs, in one arithmetic.
#pragma once

#include <rlslab/catalogue/native/adaptive.hpp>

namespace rlslab {

/// The composition around the variant, numbers rounded to T. Throws std::invalid_argument where they are then no
/// options: a variance that is 0 or infinite there. There is no contradiction and no obstacle. Exists in float,
/// double and Reference (compose.cpp).
template <Real T>
AnyAdaptive<T> composed_around(Composition const& composition, GuardOptions<double> const& guard_options,
                               std::string_view variant, Problem<T> const& problem);

/// What a variant can do, in double.
struct VariantAbilities {
    Abilities abilities;
    bool single_rows = false;                  ///< exists where compositions do, and takes single rows
    bool walks = false;                        ///< has a Q of its own
    std::vector<std::string_view> rules = {};  ///< of forgetting that it can follow
};
VariantAbilities abilities_of(std::string_view variant);

}  // namespace rlslab
