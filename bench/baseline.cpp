// Ratios from Google Benchmark's JSON, and their file.
#include "bench/baseline.hpp"
#include "bench/results.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <stdexcept>

namespace rlslab::bench {
namespace {

using Json = nlohmann::ordered_json;

Ratio spread(std::vector<double> ratios) {
    std::ranges::sort(ratios);
    return {ratios.front(), ratios[ratios.size() / 2], ratios.back()};
}

/// Four digits: more than a time has.
Json rounded(double x) { return Json::parse(fmt::format("{:.4g}", x)); }

/// Nanoseconds of each row, one for each repetition.
std::map<std::string, std::vector<double>> times_in(Json const& run) {
    std::map<std::string, std::vector<double>> out;
    for (Json const& row : run.at("benchmarks"))
        if (row.value("run_type", "") == "iteration" && !row.value("error_occurred", false))
            out[row.at("run_name")].push_back(row.at("ns_per_update"));
    return out;
}

}  // namespace

Baseline baseline_of(std::string const& run_json) {
    Json const run = parsed_results(run_json);
    auto times = times_in(run);
    auto const scale = times.find(unit_row);
    if (scale == times.end()) throw std::runtime_error(fmt::format("expected the row {} in the run", unit_row));
    Baseline out{machine_of(run), int(scale->second.size()), {}};
    double const unit = spread(scale->second).middle;
    for (auto& [name, of_row] : times) {
        if (name != unit_row && !name.starts_with("update/")) continue;
        if (of_row.size() < 5) throw std::runtime_error(fmt::format("{}: expected at least five repetitions", name));
        for (double& time : of_row) time /= unit;
        out.rows[name] = spread(of_row);
    }
    return out;
}

void record(Baselines& all, Baseline now) {
    auto const same = std::ranges::find(all, now.machine, &Baseline::machine);
    if (same != all.end()) *same = std::move(now);
    else all.push_back(std::move(now));
}

void add(Baselines& all, Baseline const& now) {
    Baseline& before = all[size_t(&of_machine(all, now.machine) - all.data())];
    std::vector<double> factors;
    for (auto const& [name, ratio] : now.rows)
        if (auto const old = before.rows.find(name); old != before.rows.end() && name != unit_row)
            factors.push_back(ratio.middle / old->second.middle);
    if (factors.empty()) throw std::runtime_error("expected rows of the baseline in the run, beside the unit");
    double const factor = spread(factors).middle;
    if (!(std::abs(factor - 1) <= 0.05))
        throw std::runtime_error(
            fmt::format("expected the old rows within 5 % of the baseline; the median of {} is {:.3f} of what it was",
                        factors.size(), factor));
    before.rows.insert(now.rows.begin(), now.rows.end());
}

std::string names_of(Baselines const& all) {
    std::string out;
    for (Baseline const& b : all)
        out += fmt::format("{}{} ({} rows)", out.empty() ? "" : "; ", b.machine, b.rows.size());
    return out.empty() ? "none" : out;
}

Baseline const& of_machine(Baselines const& all, std::string const& machine) {
    auto const found = std::ranges::find(all, machine, &Baseline::machine);
    if (found == all.end())
        throw std::runtime_error(fmt::format("nothing is recorded of {}; recorded are: {}", machine, names_of(all)));
    return *found;
}

std::string written(Baselines const& all) {
    std::string out = fmt::format("{{\n \"unit_row\": \"{}\",\n \"machines\": {{", unit_row);
    char const* between_machines = "\n";
    for (Baseline const& b : all) {
        out += fmt::format("{}  {}: {{\n   \"repetitions\": {},\n   \"rows\": {{", between_machines,
                           Json(b.machine).dump(), b.repetitions);
        char const* between = "\n";
        for (auto const& [name, ratio] : b.rows) {
            Json const three{rounded(ratio.least), rounded(ratio.middle), rounded(ratio.greatest)};
            out += fmt::format("{}    {}: {}", between, Json(name).dump(), three.dump());
            between = ",\n";
        }
        out += "\n   }\n  }";
        between_machines = ",\n";
    }
    return out + "\n }\n}\n";
}

Baselines read_baselines(std::string const& text) {
    Json const file = Json::parse(text);
    if (file.at("unit_row") != unit_row) throw std::runtime_error(fmt::format("expected times over {}", unit_row));
    Baselines out;
    for (auto const& [machine, recorded] : file.at("machines").items()) {
        Baseline& b = out.emplace_back(Baseline{machine, recorded.at("repetitions"), {}});
        for (auto const& [name, three] : recorded.at("rows").items()) {
            if (three.size() != 3) throw std::runtime_error(fmt::format("{}: expected three numbers", name));
            b.rows[name] = {three[0], three[1], three[2]};
        }
    }
    return out;
}

}  // namespace rlslab::bench
