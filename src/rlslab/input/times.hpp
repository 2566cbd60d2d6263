// A column of times: whether its rows follow one another, and the rows as they follow one another.
#pragma once

#include <rlslab/input/csv.hpp>

#include <optional>

namespace rlslab {

/// A number as it stands, "2024-05-17", "2024-05-17 08:15:30.25", "2024-05-17T08:15Z" or "08:15:30" in seconds, the day
/// also as "2024/05/17" or "17.05.2024" ("05/17/2024" is another day elsewhere), the seconds also with a decimal comma;
/// NaN for a missing value. Nothing for what is none of these. A date may have an offset from UTC behind its hour (Z,
/// +02:00, +0200, +02), which is taken off.
std::optional<double> time_in(std::string_view cell);

/// In which of these ways a time (of time_in) is written. date: without an offset.
enum class Written { missing, number, hour, date, offset };
Written written(std::string_view time);

/// Numbers like 20240517, 202405170600 and 20240517060000 become seconds, if the column of times is called as one and
/// each of them is such a date of the years 1900 to 2100.
void stamps_to_seconds(Columns& data);

/// Throws InputError where the column of times is the output or an input.
void expect_times_apart(std::string const& time, std::string const& output, std::vector<std::string> const& inputs);

/// Whether people call a column of times so: t, time [s], Timestamp, Zeit ...
bool named_as_time(std::string_view column);

/// What the times of these columns (Columns::time) say against taking row after row for sample after sample, in one
/// sentence: "t: 14 steps are longer than the median, 0.01: ...", or that a column called so is not read. None: they
/// count evenly, or are no times: fewer than 10, fewer than three quarters of them different, more than a tenth of the
/// steps uneven (in_order_of_time), or less than half of them within a tenth of the median. In a column called as one
/// that is in order, these are told; so are times that repeat with the values of their rows.
std::optional<std::string> sentence_on_times(Columns const& data);

/// "--time t", for a shell.
std::string time_option(std::string const& column);

/// The rows in the order of their times, a row that stands twice once, and where a step is n times the median, n - 1
/// rows of missing values, but `most` at one place: what reaches across it by a lag is then left out. Throws InputError
/// with file and line for a time that is missing, for one time over different values, for fewer than 3 times, and where
/// more than a tenth of the steps is uneven: not within a tenth of the median of a whole number of medians. Times that
/// are rounded to a unit may be off by that unit.
Columns in_order_of_time(Columns data, Index most);

}  // namespace rlslab
