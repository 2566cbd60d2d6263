// One clock a column: hours of a place and hours of another cannot be put in order.
#include <rlslab/input/csv_times.hpp>

#include <fmt/format.h>

namespace rlslab::csv {

std::optional<double> TimeCells::read(Reading reading, std::string_view cell, long line, std::size_t column) {
    auto const time = is_value(reading.kind) ? std::optional(reading.value) : time_in(cell);
    std::string const found = in_quotes(cell);
    if (!time) {
        expected =
            "expected a time (a number, 2024-05-17 06:00:00, 17.05.2024 06:00, 06:00:00, an offset behind as +02:00), "
            "found " +
            found;
        unread = found + " is not read as a time (2024-05-17 06:00:00 is)";
        return {};
    }
    if (reading.kind == Kind::missing) return time;
    if (is_value(reading.kind)) first_.try_emplace(reading.kind, Marks::Cell{line, column, std::string(cell)});
    Written const here = is_value(reading.kind) ? Written::number : written(cell);
    if (written_ == Written::missing) written_ = here, line_ = line;
    if (here == written_) return time;
    char const* const above = written_ == Written::number   ? "a number"
                              : written_ == Written::hour   ? "an hour without a date"
                              : written_ == Written::offset ? "a time with its offset from UTC (Z, +02:00)"
                                                            : "a date without an offset from UTC";
    expected = fmt::format("expected {} as in line {}, found {}", above, line_, found);
    unread = fmt::format("{} in line {} is not {} as in line {}", found, line, above, line_);
    return {};
}

bool TimeCells::in_doubt(Marks of_others, char separator) {
    for (auto const& [kind, at] : first_)
        if (of_others.number(kind, at.line, at.column, at.text)) {
            unread = fmt::format("{} in line {} has another mark than the numbers", in_quotes(at.text), at.line);
            return true;
        }
    auto const fault = of_others.end(separator);
    if (fault)
        unread = fmt::format("{} in line {} may have a decimal mark or one between thousands",
                             in_quotes(fault->at.text), fault->at.line);
    return fault.has_value();
}

}  // namespace rlslab::csv
