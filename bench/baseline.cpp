// Ratios from Google Benchmark's JSON, their file, and the comparison.
#include "bench/baseline.hpp"
#include "bench/results.hpp"

#include <algorithm>
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

Times times_in(Json const& run) {
    Times out;
    for (Json const& row : run.at("benchmarks"))
        if (row.value("run_type", "") == "iteration" && !row.value("error_occurred", false))
            out[row.at("run_name")].push_back(row.at("ns_per_update"));
    return out;
}

}  // namespace

Times times_of(std::string const& run_json) { return times_in(parsed_results(run_json)); }

Baseline baseline_of(std::string const& run_json) {
    Json const run = parsed_results(run_json);
    Times times = times_in(run);
    auto const scale = times.find(unit_row);
    if (scale == times.end()) throw std::runtime_error(fmt::format("expected the row {} in the run", unit_row));
    Baseline out{fmt::format("{}, {}", run.at("context").value("cpu", "unknown processor"),
                             run.at("context").value("compiler", "unknown compiler")),
                 int(scale->second.size()),
                 {}};
    double const unit = spread(scale->second).middle;
    for (auto& [name, of_row] : times) {
        if (of_row.size() < 5) throw std::runtime_error(fmt::format("{}: expected at least five repetitions", name));
        for (double& time : of_row) time /= unit;
        out.rows[name] = spread(of_row);
    }
    return out;
}

std::string written(Baseline const& baseline) {
    std::string out = fmt::format("{{\n \"machine\": {},\n \"unit_row\": \"{}\",\n \"repetitions\": {},\n \"rows\": {{",
                                  Json(baseline.machine).dump(), unit_row, baseline.repetitions);
    char const* between = "\n";
    for (auto const& [name, ratio] : baseline.rows) {
        Json const three{rounded(ratio.least), rounded(ratio.middle), rounded(ratio.greatest)};
        out += fmt::format("{}  {}: {}", between, Json(name).dump(), three.dump());
        between = ",\n";
    }
    return out + "\n }\n}\n";
}

Baseline read_baseline(std::string const& text) {
    Json const all = Json::parse(text);
    if (all.at("unit_row") != unit_row) throw std::runtime_error(fmt::format("expected times over {}", unit_row));
    Baseline out{all.at("machine"), all.at("repetitions"), {}};
    for (auto const& [name, three] : all.at("rows").items()) {
        if (three.size() != 3) throw std::runtime_error(fmt::format("{}: expected three numbers", name));
        out.rows[name] = {three[0], three[1], three[2]};
    }
    return out;
}

std::vector<Moved> moved(Baseline const& before, Baseline const& now) {
    std::vector<Moved> out;
    for (auto const& [name, ratio] : now.rows) {
        auto const old = before.rows.find(name);
        if (old == before.rows.end()) continue;
        bool const disjoint = ratio.greatest < old->second.least || old->second.greatest < ratio.least;
        double const factor = ratio.middle / old->second.middle;
        if (disjoint && (factor > 1.05 || factor < 1 / 1.05)) out.push_back({name, old->second, ratio});
    }
    return out;
}

}  // namespace rlslab::bench
