// A column of times: whether its rows follow one another, and the rows as they follow one another.
#pragma once

#include <rlslab/input/csv.hpp>

#include <optional>

namespace rlslab {

/// A number as it stands, "2024-05-17", "2024-05-17 08:15:30.25", "2024-05-17T08:15Z" or "08:15:30" in seconds, the day
/// also as "2024/05/17" or "17.05.2024" ("05/17/2024" is another day elsewhere); NaN for a missing value. Nothing for
/// what is none of these. An hour is that of its own clock: an offset behind it drops.
std::optional<double> time_in(std::string_view cell);

/// Whether people call a column of times so: t, time [s], Timestamp, Zeit ...
bool named_as_time(std::string_view column);

/// What the times of these columns (Columns::time) say against taking row after row for sample after sample, in one
/// sentence: "t: 14 steps are longer than the median, 0.01: ...", or that a column called so is not read. None: they
/// count evenly, or are no times: fewer than 10, fewer than three quarters of them different, or less than half of the
/// steps within a tenth of the median.
std::optional<std::string> sentence_on_times(Columns const& data);

/// "--time t", for a shell.
std::string time_option(std::string const& column);

/// The rows in the order of their times, a row that stands twice once, and where a step is n times the median, n - 1
/// rows of missing values, but `most` at one place: what reaches across it by a lag is then left out. Throws InputError
/// with file and line for a time that is missing, for one time over different values, for fewer than 3 times.
Columns in_order_of_time(Columns data, Index most);

}  // namespace rlslab
