// The part of the compositions that the object library of one arithmetic defines.
#pragma once

#include <rlslab/catalogue/adaptive.hpp>
#include <rlslab/catalogue/composed.hpp>

namespace rlslab {

/// `composed` in one arithmetic. catalogue/compose.cpp, compiled for that I, defines it.
template <int I>
std::unique_ptr<ComposedFilter> compose(Composition const& composition, std::string_view variant,
                                        Problem<double> const& problem);

/// What a variant can do, in double; `relays`: it knows how near to singular its P is, and can hand over.
struct VariantAbilities {
    Abilities abilities;
    bool single_rows = false;                  ///< exists where compositions do, and takes single rows
    bool relays = false, walks = false;        ///< walks: has a Q of its own
    std::vector<std::string_view> rules = {};  ///< of forgetting that it can follow
};
VariantAbilities abilities_of(std::string_view variant);

}  // namespace rlslab
