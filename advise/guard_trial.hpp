// A guarded filter on a record: whether a guard finds anything there that is none of its business.
#pragma once

#include <rlslab/adapt/guard.hpp>
#include <rlslab/core/records.hpp>

#include <optional>
#include <string_view>

namespace rlslab::compare {

/// Guarded<F> with its default options and the policy `resetting`, once through the record.
struct GuardTrial {
    GuardCounts counts;
    bool same_bits;  ///< after every row theta equals that of F alone, number for number
};

/// Data and prior are rounded to the arithmetic first. nullopt for an arithmetic other than float and double, and for variants that cannot
/// be guarded.
std::optional<GuardTrial> guard_trial(std::string_view variant, std::string_view arithmetic, Problem<double> const& problem,
                                      Records const& records);

}  // namespace rlslab::compare
