// The records of studies/data/survey: the list, those in the program, and those that lay_out.py there wrote.
#pragma once

#include <rlslab/core/records.hpp>

#include <string>
#include <string_view>
#include <vector>

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
