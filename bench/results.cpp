// Takes the names apart; the table of times; the times on record.
#include "bench/results.hpp"

#include "bench/choice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

namespace rlslab::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Google Benchmark writes NaN and Infinity, which JSON has not, for the scatter of times that are 0: they become null.
Json parsed(std::string const& text) {
    static std::regex const not_finite("(: *)-?(NaN|nan|Infinity|inf)(?=[,\\s}])");
    return Json::parse(std::regex_replace(text, not_finite, "$1null"));
}

/// The kind of machine of a run, by name: processor, instruction set, compiler.
std::string machine_of(Json const& run) {
    Json const& context = run.at("context");
    return fmt::format("{}, {}, {}", context.value("cpu", "unknown processor"),
                       context.value("instructions", "unknown instruction set"),
                       context.value("compiler", "unknown compiler"));
}

/// The parameters in "64", "200000x10" or, for a limit, the bytes of its square.
double size_of(std::string const& group, std::string const& what) {
    double const last = std::stod(what.substr(what.find('x') + 1));
    return group == "limit" ? std::sqrt(last / sizeof(double)) : last;
}

BenchRow measured(Json const& row) {
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
                 .theta_nanoseconds = {}};
    if (row.contains("ns_theta")) out.theta_nanoseconds = row["ns_theta"].get<double>();
    return out;
}

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

Run run_of(std::string const& run_json) {
    Json const all = parsed(run_json);
    Run run{fmt::format("{}, {}", machine_of(all), all.at("context").value("date", "").substr(0, 10)), {}};
    // Interleaved repetitions end in any order; the page has that of the program.
    std::vector<Json> rows = all.at("benchmarks");
    std::ranges::stable_sort(rows, {}, [](Json const& row) { return row.value("family_index", 0); });
    for (Json const& row : rows) {
        bool const repeated = row.value("repetitions", 1) > 1;
        if (row.value("error_occurred", false) || (repeated && row.value("aggregate_name", "") != "median")) continue;
        run.rows.push_back(measured(row));
    }
    return run;
}

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
    std::stable_partition(names.begin(), names.end(),
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

// --- times on record -------------------------------------------------------------------------------------------------

namespace {

double median(std::vector<double> x) {
    std::ranges::sort(x);
    return x[x.size() / 2];
}

/// A line each row, by name.
std::string written(Json const& file) {
    std::string out = fmt::format("{{\n \"unit_row\": \"{}\",\n \"machines\": {{", unit_row);
    char const* between_machines = "\n";
    for (auto const& [machine, recorded] : file.at("machines").items()) {
        out += fmt::format("{}  {}: {{\n   \"repetitions\": {},\n   \"rows\": {{", between_machines,
                           Json(machine).dump(), recorded.at("repetitions").dump());
        char const* between = "\n";
        for (auto const& [name, three] : recorded.at("rows").get<std::map<std::string, Json>>()) {
            if (three.size() != 3) throw std::runtime_error(fmt::format("{}: expected three numbers", name));
            out += fmt::format("{}    {}: {}", between, Json(name).dump(), three.dump());
            between = ",\n";
        }
        out += "\n   }\n  }";
        between_machines = ",\n";
    }
    return out + "\n }\n}\n";
}

/// Least, median and largest time of each row over the unit's median, to four digits: more than a time has.
Json ratios_of(Json const& run) {
    std::map<std::string, std::vector<double>> times;
    for (Json const& row : run.at("benchmarks"))
        if (row.value("run_type", "") == "iteration" && !row.value("error_occurred", false))
            times[row.at("run_name")].push_back(row.at("ns_per_update"));
    if (!times.contains(unit_row)) throw std::runtime_error(fmt::format("expected the row {} in the run", unit_row));
    double const unit = median(times[unit_row]);
    Json out{{"repetitions", times[unit_row].size()}, {"rows", Json::object()}};
    for (auto const& [name, of_row] : times) {
        if (name != unit_row && !name.starts_with("update/")) continue;
        if (of_row.size() < 5) throw std::runtime_error(fmt::format("{}: expected at least five repetitions", name));
        for (double const time : {std::ranges::min(of_row), median(of_row), std::ranges::max(of_row)})
            out["rows"][name].push_back(Json::parse(fmt::format("{:.4g}", time / unit)));
    }
    return out;
}

/// The rows that are not there.
void add_rows(Json& machines, std::string const& machine, Json const& now) {
    if (!machines.contains(machine)) {
        std::vector<std::string> known;
        for (auto const& one : machines.items()) known.push_back(one.key());
        throw std::runtime_error(
            fmt::format("nothing is recorded of {}; recorded are: {}", machine, fmt::join(known, "; ")));
    }
    Json& before = machines[machine]["rows"];
    std::vector<double> factors;
    for (auto const& [name, three] : now.at("rows").items())
        if (before.contains(name) && name != unit_row)
            factors.push_back(three[1].get<double>() / before[name][1].get<double>());
    if (factors.empty()) throw std::runtime_error("expected rows of the baseline in the run, beside the unit");
    double const factor = median(factors);
    if (!(std::abs(factor - 1) <= 0.05))
        throw std::runtime_error(
            fmt::format("expected the old rows within 5 % of the baseline; the median of {} is {:.3f} of what it was",
                        factors.size(), factor));
    for (auto const& [name, three] : now.at("rows").items())
        if (!before.contains(name)) before[name] = three;
}

}  // namespace

std::string recorded(std::string const& before, std::string const& run_json, bool add) {
    Json const run = parsed(run_json), now = ratios_of(run);
    Json file = before.empty() ? Json{{"unit_row", unit_row}, {"machines", Json::object()}} : Json::parse(before);
    if (file.at("unit_row") != unit_row) throw std::runtime_error(fmt::format("expected times over {}", unit_row));
    if (add) add_rows(file["machines"], machine_of(run), now);
    else file["machines"][machine_of(run)] = now;
    return written(file);
}

}  // namespace rlslab::bench
