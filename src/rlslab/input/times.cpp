// Times are sorted once; the median of their steps is the step.
#include <rlslab/input/times.hpp>

#include <rlslab/input/csv_number.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <numeric>

namespace rlslab {
namespace {

constexpr double longer = 1.5;  // medians, from which on rows are missing

/// A whole number of so many digits at the front of the text, which is taken off; behind it stands `end`, if not 0.
std::optional<int> taken(std::string_view& text, std::size_t digits, char end) {
    int value = 0;
    if (text.size() < digits + (end != 0) || (end != 0 && text[digits] != end)) return {};
    auto const [at, error] = std::from_chars(text.data(), text.data() + digits, value);
    if (error != std::errc() || at != text.data() + digits || value < 0) return {};
    text.remove_prefix(digits + (end != 0));
    return value;
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
    std::chrono::year_month_day const date{std::chrono::year(*year), std::chrono::month(unsigned(*month)),
                                           std::chrono::day(unsigned(*day))};
    if (!date.ok()) return {};
    return 86400.0 * double(std::chrono::sys_days(date).time_since_epoch().count());
}

std::optional<double> hour_in(std::string_view text) {
    if (auto const zone = text.find_first_of("Z+-"); zone != text.npos) text = text.substr(0, zone);
    auto const hour = taken(text, 2, ':');
    auto const minute = hour ? taken(text, 2, 0) : std::nullopt;
    if (!minute || *hour > 24 || *minute > 59) return {};
    double seconds = 0;
    if (!text.empty()) {
        auto const [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), seconds);
        if (text[0] != ':' || error != std::errc() || end != text.data() + text.size() || !(seconds < 62)) return {};
    }
    return 3600.0 * *hour + 60.0 * *minute + seconds;
}

/// The rows by their times; of equal ones in the order of the file.
std::vector<std::size_t> by_time(std::vector<double> const& times) {
    std::vector<std::size_t> out(times.size());
    std::iota(out.begin(), out.end(), std::size_t(0));
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

std::string counted(long n, char const* one, char const* many) { return fmt::format("{} {}", n, n == 1 ? one : many); }

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

std::optional<double> time_in(std::string_view cell) {
    if (auto const [kind, value] = csv::reading_of(cell); csv::is_value(kind)) return value;
    std::string_view rest = cell;
    auto const date = date_in(rest);
    if (date && rest.empty()) return date;
    if (date && rest[0] != ' ' && rest[0] != 'T') return {};
    if (date) rest.remove_prefix(1);
    else rest = cell;
    auto const hour = hour_in(rest);
    return hour ? std::optional(date.value_or(0) + *hour) : std::nullopt;
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
        return fmt::format("{}: {} is not read as a time (2024-05-17 06:00:00 is): gaps between the rows are not seen",
                           printable(data.time), data.unread_time);
    std::vector<double> sorted = data.times;
    std::erase_if(sorted, [](double t) { return std::isnan(t); });
    std::vector<double> const given = sorted;
    std::ranges::sort(sorted);
    std::vector<double> const steps = steps_of(sorted);
    long const all = std::ssize(sorted), doubled = all - 1 - std::ssize(steps);
    if (all < 10 || 4 * (std::ssize(steps) + 1) < 3 * all) return {};
    double const median = median_of(steps);
    auto const near = [&](double step) { return std::abs(step - median) <= 0.1 * median; };
    if (2 * std::ranges::count_if(steps, near) <= std::ssize(steps)) return {};
    long const gaps = std::ranges::count_if(steps, [&](double step) { return step > longer * median; });
    long back = 0;
    for (std::size_t k = 1; k < given.size(); ++k) back += given[k] < given[k - 1];
    if (!named_as_time(data.time) && back > all / 4 && back < all - 1 - all / 4) return {};
    std::vector<std::string> parts;
    if (back == std::ssize(steps)) parts.push_back("the newest row is first");
    else if (back > 0) parts.push_back(fmt::format("{} of {} steps go back", back, all - 1));
    if (gaps > 0)
        parts.push_back(counted(gaps, "step is", "steps are") + fmt::format(" longer than the median, {:.6g}", median));
    if (doubled > 0) parts.push_back(counted(doubled, "row has", "rows have") + " the time of another");
    if (parts.empty()) return {};
    return fmt::format("{}: {}: rows of the file that are no neighbours in time are taken for such; {}",
                       printable(data.time), fmt::join(parts, ", "), time_option(data.time));
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
            for (auto const& x : data.values)
                if (!same(x[row], x[rows.back()]))
                    throw InputError(
                        fmt::format("{}: expected one row for each time, found that of line {} with other "
                                    "values",
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
    double const median = median_of(steps_of(sorted));
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
