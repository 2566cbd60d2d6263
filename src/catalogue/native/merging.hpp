// What a filter must be whose rows another appends to its own.
#pragma once

#include <rlslab/core/concept.hpp>

#include <charconv>
#include <stdexcept>
#include <string>

namespace rlslab {

/// Throws std::invalid_argument, in one line, unless `newer`, of the type and size of `older`, started without a prior
/// and has its forgetting. F, which Merges, names its state: lambda first, and whether it started with a prior.
template <class F>
void expect_newer_part(F const& older, F const& newer) {
    auto const mine = F::state(older), other = F::state(newer);
    if (std::get<bool const&>(other))
        throw std::invalid_argument("expected a newer part without a prior: only the older one's counts, and once");
    auto const shortest = []<class X>(X const& number) {
        std::conditional_t<std::floating_point<X>, X, double> const rounded(number);
        char text[32];
        return std::string(text, std::to_chars(text, text + sizeof text, rounded).ptr);
    };
    if (auto const& lambda = std::get<0>(mine); std::get<0>(other) != lambda)
        throw std::invalid_argument("expected a part of forgetting " + shortest(lambda) + ", found " +
                                    shortest(std::get<0>(other)));
}

}  // namespace rlslab
