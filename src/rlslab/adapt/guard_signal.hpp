// What a guard says: a signal for each row, and counts.
#pragma once

#include <rlslab/core/problem.hpp>

#include <string_view>
#include <tuple>

namespace rlslab {

/// What a guard saw of a row, the worst first.
enum class GuardSignal : unsigned char { none, unusable, breakdown, change, outlier, windup };

constexpr std::string_view name_of(GuardSignal signal) {
    constexpr std::string_view names[] = {"none", "unusable", "breakdown", "change", "outlier", "windup"};
    return names[static_cast<int>(signal)];
}

template <class N>
struct GuardCountsOf {
    N rows = 0;        ///< offered
    N unusable = 0;    ///< not finite, or out of range: skipped
    N outliers = 0;    ///< failed the innovation test
    N changes = 0;     ///< 5 outliers among 6 rows
    N windups = 0;     ///< P_jj > largest_variance
    N breakdowns = 0;  ///< a step that is indefinite, not finite, or again undetermined; P_jj <= 0 or not finite;
                       ///< asymmetry

    GuardCountsOf<Index> of_lane(int i) const {
        return {rows[i], unusable[i], outliers[i], changes[i], windups[i], breakdowns[i]};
    }
    static auto state(auto& c) { return std::tie(c.rows, c.unusable, c.outliers, c.changes, c.windups, c.breakdowns); }
};
using GuardCounts = GuardCountsOf<Index>;

}  // namespace rlslab
