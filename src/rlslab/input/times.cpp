// Times are sorted once; the median of their steps is the step.
#include <rlslab/input/times.hpp>

#include <rlslab/input/csv_cells.hpp>
#include <rlslab/input/csv_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

namespace rlslab {
namespace {

constexpr double longer = 1.501;  // medians, beyond which rows are missing; 1.5, and the rounding of times
constexpr double nearly = 0.1001;

/// A whole number of so many digits at the front of the text, which is taken off; behind it stands `end`, if not 0.
std::optional<int> taken(std::string_view& text, std::size_t digits, char end) {
    int value = 0;
    if (text.size() < digits + (end != 0) || (end != 0 && text[digits] != end)) return {};
    auto const [at, error] = std::from_chars(text.data(), text.data() + digits, value);
    if (error != std::errc() || at != text.data() + digits || value < 0) return {};
    text.remove_prefix(digits + (end != 0));
    return value;
}

/// The seconds from 1970 to a day; nothing where the calendar has none.
std::optional<double> start_of_day(int year, int month, int day) {
    std::chrono::year_month_day const date{std::chrono::year(year), std::chrono::month(unsigned(month)),
                                           std::chrono::day(unsigned(day))};
    if (!date.ok()) return {};
    return 86400.0 * double(std::chrono::sys_days(date).time_since_epoch().count());
}

/// 2024-05-17, 2024/05/17, or 17.05.2024. 05/17/2024 is another day elsewhere.
std::optional<double> date_in(std::string_view& text) {
    bool const day_first = text.size() > 2 && text[2] == '.';
    char const mark = day_first ? '.' : text.size() > 4 && text[4] == '/' ? '/' : '-';
    auto const first = taken(text, day_first ? 2 : 4, mark);
    auto const month = first ? taken(text, 2, mark) : std::nullopt,
               last = month ? taken(text, day_first ? 4 : 2, 0) : std::nullopt;
    if (!last) return {};
    auto const year = day_first ? last : first, day = day_first ? first : last;
    return start_of_day(*year, *month, *day);
}

/// "Z", "+02:00", "-0330", "+02", in seconds.
std::optional<double> offset_in(std::string_view text) {
    if (text == "Z") return 0.0;
    if (text.empty() || (text[0] != '+' && text[0] != '-')) return {};
    double const sign = text[0] == '-' ? -1 : 1;
    text.remove_prefix(1);
    auto const hour = taken(text, 2, 0);
    if (text.size() == 3 && text[0] == ':') text.remove_prefix(1);
    auto const minute = text.empty() ? std::optional(0) : taken(text, 2, 0);
    if (!hour || *hour > 14 || !minute || *minute > 59 || !text.empty()) return {};
    return sign * (3600.0 * *hour + 60.0 * *minute);
}

constexpr char const* begins_offset = "Z+-";

/// The hour in seconds; with an offset only behind a date: "06:00-07:00" is an interval.
std::optional<double> hour_in(std::string_view text, bool dated) {
    double offset = 0;
    if (auto const zone = text.find_first_of(begins_offset); zone != text.npos) {
        auto const found = offset_in(text.substr(zone));
        if (!found || (!dated && text[zone] != 'Z')) return {};
        offset = *found;
        text = csv::trimmed(text.substr(0, zone));
    }
    auto const hour = taken(text, 2, ':');
    auto const minute = hour ? taken(text, 2, 0) : std::nullopt;
    if (!minute || *hour > 24 || *minute > 59) return {};
    double seconds = 0;
    if (!text.empty()) {
        if (text[0] != ':' || text.find_first_not_of("0123456789.,", 1) != text.npos) return {};
        std::string pointed(text.substr(1));
        std::ranges::replace(pointed, ',', '.');
        char const* const last = pointed.data() + pointed.size();
        auto const [end, error] = std::from_chars(pointed.data(), last, seconds);
        if (error != std::errc() || end != last || !(seconds < 62)) return {};
    }
    return 3600.0 * *hour + 60.0 * *minute + seconds - offset;
}

/// 20240517 and so on, from a number.
std::optional<double> stamp_in(double number) {
    if (!(number >= 19000101 && number < 21010000000000) || number != std::floor(number)) return {};
    std::string const digits = fmt::format("{:.0f}", number);
    std::string_view text = digits;
    if (text.size() != 8 && text.size() != 12 && text.size() != 14) return {};
    int const year = taken(text, 4, 0).value(), month = taken(text, 2, 0).value(), day = taken(text, 2, 0).value();
    int const hour = taken(text, 2, 0).value_or(0), minute = taken(text, 2, 0).value_or(0),
              second = taken(text, 2, 0).value_or(0);
    auto const start = start_of_day(year, month, day);
    if (year < 1900 || year > 2100 || !start || hour > 24 || minute > 59 || second > 61) return {};
    return *start + 3600.0 * hour + 60.0 * minute + second;
}

/// The rows that have a time by their times; of equal ones in the order of the file.
std::vector<std::size_t> by_time(std::vector<double> const& times) {
    std::vector<std::size_t> out;
    for (std::size_t row = 0; row < times.size(); ++row)
        if (!std::isnan(times[row])) out.push_back(row);
    std::ranges::stable_sort(out, {}, [&](std::size_t row) { return times[row]; });
    return out;
}

/// Of times in order: what lies between different ones.
std::vector<double> steps_of(std::vector<double> const& sorted) {
    std::vector<double> out;
    for (std::size_t k = 1; k < sorted.size(); ++k)
        if (sorted[k] > sorted[k - 1]) out.push_back(sorted[k] - sorted[k - 1]);
    return out;
}

double median_of(std::vector<double> steps) {
    auto const middle = steps.begin() + std::ssize(steps) / 2;
    std::ranges::nth_element(steps, middle);
    return *middle;
}

/// The places of steps that are not nearly a whole number of medians, nor off by the one unit to which all are rounded.
std::vector<std::size_t> uneven(std::vector<double> const& steps, double median) {
    std::vector<std::size_t> out;
    double unit = INFINITY;
    for (std::size_t k = 0; k < steps.size(); ++k) {
        if (std::abs(steps[k] - std::max(1.0, std::round(steps[k] / median)) * median) <= nearly * median) continue;
        out.push_back(k);
        unit = std::min(unit, std::abs(steps[k] - median));
    }
    auto const in_units = [&](double step) { return std::abs(std::remainder(step, unit)) <= 1e-3 * unit; };
    if (!out.empty() && std::ranges::all_of(steps, in_units))
        std::erase_if(out, [&](std::size_t k) {
            return std::abs(steps[k] - median) <= 1.001 * unit && steps[k] <= longer * median &&
                   median <= longer * steps[k];
        });
    return out;
}

/// More than these are no record of samples that are evenly apart.
bool too_many(std::vector<std::size_t> const& uneven_ones, std::size_t steps) {
    return 10 * uneven_ones.size() > steps;
}

std::string counted(long n, char const* one, char const* many) { return fmt::format("{} {}", n, n == 1 ? one : many); }

bool same_values(Columns const& data, std::size_t a, std::size_t b) {
    return std::ranges::all_of(data.values, [&](std::vector<double> const& x) {
        return x[a] == x[b] || (std::isnan(x[a]) && std::isnan(x[b]));
    });
}

}  // namespace

std::optional<double> time_in(std::string_view cell) {
    if (auto const [kind, value] = csv::reading_of(cell); csv::is_value(kind)) return value;
    std::string_view rest = cell;
    auto const date = date_in(rest);
    if (date && rest.empty()) return date;
    if (date && rest[0] != ' ' && rest[0] != 'T') return {};
    if (date) rest.remove_prefix(1);
    else rest = cell;
    auto const hour = hour_in(rest, date.has_value());
    return hour ? std::optional(date.value_or(0) + *hour) : std::nullopt;
}

Written written(std::string_view time) {
    if (auto const kind = csv::reading_of(time).kind; csv::is_value(kind))
        return kind == csv::Kind::missing ? Written::missing : Written::number;
    bool const dated = date_in(time).has_value();
    if (time.find_first_of(begins_offset) != time.npos) return Written::offset;
    return dated ? Written::date : Written::hour;
}

void stamps_to_seconds(Columns& data) {
    if (!named_as_time(data.time)) return;
    std::vector<double> seconds;
    for (double const t : data.times) {
        auto const stamp = std::isnan(t) ? std::optional(t) : stamp_in(t);
        if (!stamp) return;
        seconds.push_back(*stamp);
    }
    data.times = std::move(seconds);
}

void expect_times_apart(std::string const& time, std::string const& output, std::vector<std::string> const& inputs) {
    if (time.empty()) return;
    bool const input = std::ranges::find(inputs, time) != inputs.end();
    if (time != output && !input) return;
    throw InputError(fmt::format("--time: expected a column of times, found \"{}\", which is {}", printable(time),
                                 input ? "an input" : "the output"));
}

bool named_as_time(std::string_view column) {
    std::string word;
    for (char const c : column) {
        char const lower = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
        if (lower < 'a' || lower > 'z') break;
        word += lower;
    }
    constexpr std::string_view known[] = {"t",     "time", "times",       "timestamp", "datetime", "date",
                                          "stamp", "zeit", "zeitstempel", "datum",     "temps",    "tiempo"};
    return std::ranges::find(known, word) != std::end(known);
}

std::optional<std::string> sentence_on_times(Columns const& data) {
    if (!data.unread_time.empty())
        return fmt::format("{}: {}: gaps between the rows are not seen", printable(data.time), data.unread_time);
    std::vector<std::size_t> rows = by_time(data.times);
    std::vector<double> sorted, given = data.times;
    for (std::size_t const row : rows) sorted.push_back(data.times[row]);
    std::erase_if(given, [](double t) { return std::isnan(t); });
    std::vector<double> const steps = steps_of(sorted);
    long const all = std::ssize(sorted), doubled = all - 1 - std::ssize(steps);
    long alike = 0;
    for (std::size_t k = 1; k < rows.size(); ++k)
        alike += sorted[k] == sorted[k - 1] && same_values(data, rows[k], rows[k - 1]);
    bool const named = named_as_time(data.time), twice = named && 2 * alike > doubled;
    if (all < 10 || 4 * (std::ssize(steps) + 1) < (twice ? 1 : 3) * all) return {};
    double const median = median_of(steps);
    auto const near = [&](double step) { return std::abs(step - median) <= nearly * median; };
    auto const off = uneven(steps, median);
    bool const irregular = too_many(off, steps.size()),
               plain = 2 * std::ranges::count_if(steps, near) > std::ssize(steps) && doubled <= all / 4 && !irregular;
    long const gaps = std::ranges::count_if(steps, [&](double step) { return step > longer * median; }),
               closer = std::ranges::count_if(steps, [&](double step) { return step * longer < median; });
    long back = 0;
    for (std::size_t k = 1; k < given.size(); ++k) back += given[k] < given[k - 1];
    if (!named && !plain) return {};
    if (!(named && plain) && back > all / 4 && back < all - 1 - all / 4) return {};
    std::vector<std::string> parts;
    if (back == std::ssize(steps)) parts.emplace_back("the newest row is first");
    else if (back > 0) parts.push_back(fmt::format("{} of {} steps go back", back, all - 1));
    auto const than_the_median = [&](long n, char const* what) {
        if (n > 0) parts.push_back(counted(n, "step is ", "steps are ") + fmt::format("{}, {:.6g}", what, median));
    };
    than_the_median(gaps, "longer than the median");
    than_the_median(closer, "shorter than the median");
    if (irregular && gaps + closer == 0) than_the_median(std::ssize(off), "more than a tenth off the median");
    if (doubled > 0) parts.push_back(counted(doubled, "row has", "rows have") + " the time of another");
    if (parts.empty()) return {};
    return fmt::format(
        "{}: {}: {}", printable(data.time), fmt::join(parts, ", "),
        irregular ? "the rows are taken for samples that are evenly apart, and --time refuses them"
                  : "rows of the file that are no neighbours in time are taken for such; " + time_option(data.time));
}

std::string time_option(std::string const& column) {
    std::string const name = printable(column);
    bool const plain = name.find_first_of(" '\"()[]{}$&;|<>*?#") == name.npos;
    return "--time " + (plain ? name : "'" + name + "'");
}

Columns in_order_of_time(Columns data, Index most) {
    std::string const name = printable(data.time);
    auto const at = [&](std::size_t row) {
        return fmt::format("{}:{}: column \"{}\"", data.file, data.lines[row], name);
    };
    for (std::size_t row = 0; row < data.times.size(); ++row)
        if (std::isnan(data.times[row])) throw InputError(at(row) + ": expected a time, found a missing value");
    std::vector<std::size_t> rows;
    for (std::size_t const row : by_time(data.times)) {
        if (!rows.empty() && data.times[row] == data.times[rows.back()]) {
            if (!same_values(data, row, rows.back()))
                throw InputError(fmt::format(
                    "{}: expected one row for each time, as a double holds it, found that of line {} with other values",
                    at(row), data.lines[rows.back()]));
            continue;
        }
        rows.push_back(row);
    }
    if (rows.size() < 3)
        throw InputError(
            fmt::format("{}: column \"{}\": expected 3 times or more, found {}", data.file, name, rows.size()));
    std::vector<double> sorted;
    for (std::size_t const row : rows) sorted.push_back(data.times[row]);
    std::vector<double> const steps = steps_of(sorted);
    double const median = median_of(steps);
    if (auto const off = uneven(steps, median); too_many(off, steps.size()))
        throw InputError(fmt::format(
            "{}: column \"{}\": expected times that are whole steps of {:.6g} apart, found {} steps that are "
            "not (the first at line {})",
            data.file, name, median, off.size(), data.lines[rows[off.front() + 1]]));
    Columns out{.file = data.file, .header = data.header, .names = data.names, .sha256 = data.sha256};
    out.values.resize(data.values.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
        double const step = k > 0 ? sorted[k] - sorted[k - 1] : 0;
        Index const missing = step > longer * median ? Index(std::min(std::round(step / median) - 1, double(most))) : 0;
        if (long(out.lines.size() + std::size_t(missing)) > most_numbers / long(out.values.size() + 1))
            throw InputError(at(rows[k]) + ": expected fewer steps that are longer than the median");
        out.lines.insert(out.lines.end(), std::size_t(missing) + 1, data.lines[rows[k]]);
        for (std::size_t j = 0; j < out.values.size(); ++j) {
            out.values[j].insert(out.values[j].end(), std::size_t(missing), NAN);
            out.values[j].push_back(data.values[j][rows[k]]);
        }
    }
    return out;
}

}  // namespace rlslab
