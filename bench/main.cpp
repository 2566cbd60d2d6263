// Runs the rows and prints one line for each: the median, where there are repetitions.
#include <benchmark/benchmark.h>

namespace {

class Medians : public benchmark::ConsoleReporter {
public:
    Medians() : ConsoleReporter(OO_Tabular) {}
    void ReportRuns(std::vector<Run> const& runs) override {
        std::vector<Run> shown;
        for (Run const& run : runs)
            if (run.repetitions <= 1 || run.aggregate_name == "median" || run.error_occurred) shown.push_back(run);
        if (!shown.empty()) ConsoleReporter::ReportRuns(shown);
    }
};

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    Medians medians;
    benchmark::RunSpecifiedBenchmarks(&medians);
}
