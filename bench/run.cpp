// Runs the rows and prints one line for each: the time by which it is quoted, and its median if there are repetitions.
#include "bench/verbs.hpp"

#include <rlslab/linalg/isa_name.hpp>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <fstream>
#include <string>

namespace rlslab::bench {
namespace {

class OneLineEach : public benchmark::BenchmarkReporter {
public:
    bool ReportContext(Context const&) override {
        fmt::print("{:<44}{:>14}{:>9}{:>8}{:>12}{:>12}\n", "", "ns/update", "digits", "finite", "ns/theta", "longest");
        return true;
    }
    void ReportRuns(std::vector<Run> const& runs) override {
        for (Run const& run : runs) {
            if (run.error_occurred) fmt::print("{:<44}{}\n", run.run_name.str(), run.error_message);
            if (run.error_occurred || (run.repetitions > 1 && run.aggregate_name != "median")) continue;
            auto const counter = [&](char const* name) { return run.counters.at(name).value; };
            fmt::print("{:<44}{:>14.1f}{:>9.1f}{:>8}", run.run_name.str(), counter("ns_per_update"), counter("digits"),
                       counter("finite") != 0 ? "yes" : "no");
            if (run.counters.contains("ns_theta"))
                fmt::print("{:>12.1f}{:>12.1f}", counter("ns_theta"), counter("ns_longest"));
            fmt::print("\n");
        }
        std::fflush(stdout);
    }
};

/// What Linux says of the processor after this key; "?" where it says nothing.
std::string processor(std::string const& key) {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with(key + '\t') && line.find(": ") != std::string::npos)
            return line.substr(line.find(": ") + 2);
    return "?";
}

}  // namespace

int run_rows(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    // The name alone is that of several generations.
    benchmark::AddCustomContext("cpu", fmt::format("{} (family {}, model {})", processor("model name"),
                                                   processor("cpu family"), processor("model")));
    benchmark::AddCustomContext("instructions", name_of(kernels::isa));
    benchmark::AddCustomContext("compiler", "g++ " __VERSION__);
    // With JSON or CSV, standard output has nothing else; otherwise it has one line for each row.
    benchmark::BenchmarkReporter* const chosen = benchmark::CreateDefaultDisplayReporter();
    OneLineEach lines;
    bool const for_people = dynamic_cast<benchmark::ConsoleReporter*>(chosen) != nullptr;
    benchmark::RunSpecifiedBenchmarks(for_people ? &lines : chosen);
    return 0;
}

}  // namespace rlslab::bench
