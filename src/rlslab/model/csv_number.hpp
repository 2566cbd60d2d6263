// Numbers out of cells, with a point or a comma. Internal to the reader of CSV files.
#pragma once

#include <limits>
#include <string>
#include <string_view>

namespace rlslab::csv {

/// What a cell holds. A comma is decimal, or (`grouped`) certainly between thousands as in "1,234,567" and "1,234.5", or
/// (`comma_or_group`) either, as in "1,234".
enum class Kind { whole, point, comma, comma_or_group, grouped, missing, infinite, out_of_range, text };

struct Reading {
    Kind kind;
    double value = std::numeric_limits<double>::quiet_NaN();  // a comma read as decimal
};
Reading reading_of(std::string_view cell);

/// Has a value, or stands for none.
bool is_value(Kind kind);
/// "expected a number, found ..." for what has none.
std::string complaint(Kind kind, std::string_view cell);

}  // namespace rlslab::csv
