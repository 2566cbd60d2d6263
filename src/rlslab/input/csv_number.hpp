// From a cell to a number, with a decimal point or comma. Internal to the reader of CSV files.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace rlslab::csv {

/// What a cell contains. A mark is decimal (`point`, `comma`), or certainly between thousands (`grouped`: "1,234,567",
/// "1,234.5"), or may be either (`point_or_group`, `comma_or_group`: "1.234", "1,234").
enum class Kind { whole, point, point_or_group, comma, comma_or_group, grouped, missing, infinite, out_of_range, text };

struct Reading {
    Kind kind;
    double value = std::numeric_limits<double>::quiet_NaN();  // a mark that may be either read as decimal
};
/// words: what stands for a missing value besides the usual words; "-999" also for "-999.0".
Reading reading_of(std::string_view cell, std::vector<std::string> const& words = {});
/// Whether one of the words is that number.
bool is_among(std::vector<std::string> const& words, double value);
/// "-999.9" where that is the value and two words that follow one another are its halves: -999,9 was written for one
/// word. Empty: it is none.
std::string torn(std::vector<std::string> const& words, double value);

/// Whether the cell has a value or is missing.
bool is_value(Kind kind);
/// "expected a number, found ...", for a cell without a value.
std::string complaint(Kind kind, std::string_view cell);

}  // namespace rlslab::csv
