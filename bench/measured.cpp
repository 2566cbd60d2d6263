// Takes the names apart; one unit of time for every order of magnitude; the table of times.
#include "bench/measured.hpp"

#include "bench/choice.hpp"
#include "bench/results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <set>

namespace rlslab::bench {
namespace {

using nlohmann::json;

/// The parameters in "64", "200000x10" or, for a limit, the bytes of its square.
double size_of(std::string const& group, std::string const& what) {
    double const last = std::stod(what.substr(what.find('x') + 1));
    return group == "limit" ? std::sqrt(last / sizeof(double)) : last;
}

BenchRow measured(json const& row) {
    std::vector<std::string> const parts = split(row.at("run_name"), '/');
    if (parts.size() < 2)
        throw std::runtime_error("not a row of these benchmarks: " + row.at("run_name").get<std::string>());
    BenchRow out{.group = parts.front(),
                 .name = parts.size() > 2 ? parts[1] : parts.front(),
                 .arithmetic = parts.size() > 3 ? parts[2] : "",
                 .what = parts.back(),
                 .family = row.value("label", parts.front()),
                 .size = size_of(parts.front(), parts.back()),
                 .nanoseconds = row.at("ns_per_update"),
                 .digits = row.at("digits"),
                 .finite = row.at("finite") != 0,
                 .theta_nanoseconds = {},
                 .longest_nanoseconds = {}};
    if (row.contains("ns_theta")) out.theta_nanoseconds = row["ns_theta"].get<double>();
    if (row.contains("ns_longest")) out.longest_nanoseconds = row["ns_longest"].get<double>();
    return out;
}

}  // namespace

Run run_of(std::string const& run_json) {
    json const all = parsed_results(run_json);
    Run run{fmt::format("{}, {}", machine_of(all), all.at("context").value("date", "").substr(0, 10)), {}};
    // Interleaved repetitions end in any order; the page has that of the program.
    std::vector<json> rows = all.at("benchmarks");
    std::ranges::stable_sort(rows, {}, [](json const& row) { return row.value("family_index", 0); });
    for (json const& row : rows) {
        bool const repeated = row.value("repetitions", 1) > 1;
        if (row.value("error_occurred", false) || (repeated && row.value("aggregate_name", "") != "median")) continue;
        run.rows.push_back(measured(row));
    }
    return run;
}

std::string time_for_people(double nanoseconds) {
    static constexpr char const* units[] = {"ns", "µs", "ms", "s"};
    int unit = 0;
    for (; unit < 3 && nanoseconds >= 999.5; ++unit) nanoseconds /= 1000;
    int const decimals = nanoseconds < 9.995 ? 2 : nanoseconds < 99.95 ? 1 : 0;
    std::string number = fmt::format("{:.{}f}", nanoseconds, decimals);
    if (number.find('.') != std::string::npos) number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') number.pop_back();
    return number + " " + units[unit];
}

namespace {

/// Times of one name, by the number of parameters.
using Times = std::map<double, double>;

/// The most parameters whose update ends within the period: between two measured sizes a straight line in logarithms.
std::string most_parameters(Times const& times, double period) {
    if (times.begin()->second > period) return fmt::format("< {}", times.begin()->first);
    for (auto next = times.begin(), at = next++; next != times.end(); at = next++) {
        if (next->second <= period) continue;
        double const share = std::log(period / at->second) / std::log(next->second / at->second);
        return fmt::format("{:.0f}", std::floor(at->first * std::pow(next->first / at->first, share)));
    }
    return fmt::format("> {}", times.rbegin()->first);
}

}  // namespace

std::string table_of_times(Run const& run) {
    static constexpr std::array shown{4, 8, 16, 32, 64, 128, 256};
    std::map<std::string, Times> times;
    std::set<std::string> solving;
    std::vector<std::string> names;
    for (BenchRow const& row : run.rows) {
        bool const ours = row.group == "update" || (row.group == "large" && !row.name.ends_with("_rows_known")),
                   dlib = row.name == "dlib";
        if ((!ours && !dlib) || row.arithmetic != "double") continue;
        std::string const name = dlib ? "dlib's `rls`" : "`" + row.name + "`";
        if (!times.contains(name)) names.push_back(name);
        times[name][row.size] = row.nanoseconds;
        if (row.solves_for_theta()) solving.insert(name);
    }
    if (names.empty()) throw std::runtime_error("expected rows update/VARIANT/double/SIZE in the run");
    std::ranges::stable_partition(names,
                                  [](std::string const& name) { return name.starts_with('`'); });  // dlib comes last
    std::string out = fmt::format("| ns an update, `double` | {} | taps at 48 kHz | at 16 kHz |\n{}\n",
                                  fmt::join(shown, " | "), "|---|---|---|---|---|---|---|---|---|---|");
    for (std::string const& name : names) {
        out += fmt::format("| {}{} |", name, solving.contains(name) ? " *" : "");
        for (int const size : shown)
            out += times[name].contains(size) ? fmt::format(" {:.0f} |", times[name][size]) : " |";
        for (double const rate : {48000.0, 16000.0})
            out += fmt::format(" {} |", most_parameters(times[name], 1e9 / rate));
        out += '\n';
    }
    return out + fmt::format(
                     "\n{}. *: without solving for theta. Taps: the most parameters whose update ends before "
                     "the next sample, one core doing nothing else; > where larger filters were not timed.\n",
                     run.machine);
}

}  // namespace rlslab::bench
