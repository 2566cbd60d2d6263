// Records in the program, and those that lay_out.py of studies/data/survey wrote: the linear regression sets of NIST's
// Statistical Reference Datasets, the files of studies/data/nist; and the records of studies/data/survey.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/records.hpp>

#include <map>
#include <string>
#include <string_view>
#include <vector>

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

namespace rlslab::studies::survey_data {

/// A file of studies/data/survey or of its folder records by its name; empty where there is none.
std::string_view file(std::string_view name);

/// The names of the used records of records.csv, in its order.
std::vector<std::string> used();
/// Whether the record is in the program.
bool in_program(std::string const& record);
/// The record in natural units: of the program, or of the folder that the environment's RLSLAB_RECORDS names. Throws
/// InputError where that is not set, or the file cannot be read.
Records records_of(std::string const& record);

/// Each regressor that is not constant: its mean off, over its standard deviation. y over its standard deviation.
Records scaled(Records records);
/// The first half of the rows, of an odd number one more.
Records first_half(Records const& records);

}  // namespace rlslab::studies::survey_data
