// The limits that the authors set for times against times (docs/speed.md), and how a run stands to them.
#pragma once

#include "bench/baseline.hpp"

#include <string>
#include <vector>

namespace rlslab::bench {

/// A ratio of medians over the repetitions, and its 95 % interval by bootstrap: the repetitions of each row drawn
/// again, 4000 times.
struct Interval {
    double middle, low, high;
};
/// The sum of the medians of `rows` over that of `over`; each has at least one number. The same numbers give the same
/// interval.
Interval ratio_of(std::vector<std::vector<double>> const& rows, std::vector<std::vector<double>> const& over);

/// Where an interval lies: within the limit, on both sides of it, beyond it.
enum class Verdict { held, open, missed };
struct Limit {
    double value;
    bool least = false;  ///< the ratio is to be at least the value, not at most
};
Verdict verdict(Interval const& interval, Limit const& limit);

/// One line of Markdown's tables for each limit whose rows are all in the run, with a verdict for each size.
std::string table_of_limits(Times const& times);

}  // namespace rlslab::bench
