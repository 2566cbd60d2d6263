// What a fleet says of its filters: a step each, and counts.
#pragma once

#include <rlslab/core/problem.hpp>

#include <cstdint>
#include <tuple>
#include <vector>

namespace rlslab {

/// What an update of a fleet reports of each of its M filters, as arrays of M, or of M m where they have m outputs
/// each, those of a filter side by side. Made once, and filled by each update.
template <RootedScalar T>
struct FleetSteps {
    Vector<T> innovation, residual;   ///< as Step's, of each output; NaN where no sample was taken
    Vector<RealOf<T>> gamma;          ///< of each filter; likewise
    std::vector<Health> health;       ///< of the step, of each output; nonfinite where no sample was taken
    std::vector<std::uint8_t> taken;  ///< 1; 0 where the sample was missing, or the filter was removed

    explicit FleetSteps(Index filters, Index outputs = 1) { resize(filters, outputs); }
    Index filters() const { return gamma.size(); }
    /// After add(). What was reported before is lost.
    void resize(Index filters, Index outputs = 1) {
        for (Vector<T>* x : {&innovation, &residual}) x->setConstant(filters * outputs, undefined<T>());
        gamma.setConstant(filters, undefined<RealOf<T>>());
        health.assign(size_t(filters * outputs), Health::nonfinite);
        taken.assign(size_t(filters), 0);
    }
};

/// Samples of a filter since it began, or of a fleet since it was made.
struct FleetCounts {
    Index taken = 0;    ///< that it learnt from
    Index missing = 0;  ///< with a number that was not finite
    static auto state(auto& c) { return std::tie(c.taken, c.missing); }
};

}  // namespace rlslab
