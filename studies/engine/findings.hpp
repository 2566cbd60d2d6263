// The functions with which claims are written: numbers computed from tables, and whether they lie where they should.
#pragma once

#include "studies/engine/study.hpp"

namespace rlslab {

using Number = std::function<double(Table const&)>;

/// The least-squares slope of log10 y against log10 x over rows where both are positive and finite; NaN for fewer than two.
Number slope(std::string x, std::string y);
/// The same of ln y against x: the rate of an exponential.
Number rate(std::string x, std::string y);
/// The least-squares slope of y against x.
Number linear_slope(std::string x, std::string y);
Number median(std::string column);
Number least(std::string column);
Number greatest(std::string column);
Number root_mean_square(std::string column);

double median(std::vector<double> values);

/// Holds if the number of every group lies in [from, to]; NaN does not. The finding reads "0.99 (joseph, lambda 0.9) ... 1.01 (symmetric,
/// lambda 1)". A table without rows does not hold: such a claim is a mistake.
Finding within(Table const& table, std::vector<std::string> const& by, Number const& number, double from, double to);

/// Holds if every row's cell in this column is the value; for claims such as "never indefinite".
Finding everywhere(Table const& table, std::string const& column, Cell const& value);

}  // namespace rlslab
