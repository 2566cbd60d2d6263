// The linear regression sets of NIST's Statistical Reference Datasets: the files of studies/data/nist, compiled in.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/records.hpp>

#include <map>
#include <string>
#include <string_view>

namespace rlslab::studies::strd {

/// A file of studies/data/nist by its name, "longley.csv". Throws std::logic_error where there is none.
std::string_view file(std::string_view name);

/// The set as stored in binary64. Powers are those of a program that multiplies in double.
Records records_of(std::string const& set);
/// The solution of the published decimals, component i.
Reference decimal(std::string const& set, Index i);

/// Digits of the worst parameter at c^2 = 1e20 in file order, by set and variant: the recursive table of
/// docs/literature.md 3.5, where a digit is left.
std::map<std::string, std::map<std::string, double>> const& listed_digits();

}  // namespace rlslab::studies::strd
