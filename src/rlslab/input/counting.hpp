// Columns that are dates or numbers of rows, by how they count.
#pragma once

#include <rlslab/input/csv.hpp>

#include <optional>

namespace rlslab {

/// The step by which most of these numbers grow, if each is larger than the one before (NaN: missing, left out) and
/// there are 10 at least: more than half of the steps are that, to a millionth.
std::optional<double> counting_step(std::vector<double> const& x);

/// A warning for each of these columns that counts upwards. Throws std::invalid_argument for one that was not read.
std::vector<std::string> counting_warnings(Columns const& data, std::vector<std::string> const& columns);

}  // namespace rlslab
