// What a fleet says of its filters: a step each, and counts.
#pragma once

#include <rlslab/core/problem.hpp>

#include <cstdint>
#include <tuple>
#include <vector>

namespace rlslab {

/// What an update of a fleet reports of each of its M filters, as arrays of M. Made once, and filled by each update.
template <Real T>
struct FleetSteps {
    Vector<T> innovation, residual, gamma;  ///< as Step's; NaN where no sample was taken
    std::vector<Health> health;             ///< of the step; nonfinite where no sample was taken
    std::vector<std::uint8_t> taken;        ///< 1; 0 where the sample was missing, or the filter was removed

    explicit FleetSteps(Index filters) { resize(filters); }
    Index filters() const { return innovation.size(); }
    /// After add(). What was reported before is lost.
    void resize(Index filters) {
        for (Vector<T>* x : {&innovation, &residual, &gamma}) x->setConstant(filters, undefined<T>());
        health.assign(size_t(filters), Health::nonfinite);
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
