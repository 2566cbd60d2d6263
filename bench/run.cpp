// Runs the rows and prints one line for each: the time by which it is quoted, and its median if there are repetitions.
// Where a user chose: a table for each size, with the times of single updates.
#include "bench/choice.hpp"
#include "bench/rows.hpp"

#include <rlslab/core/files.hpp>
#include <rlslab/linalg/isa_name.hpp>

#include <csignal>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace rlslab::bench {
namespace {

using Run = benchmark::BenchmarkReporter::Run;
double counter(Run const& run, char const* name) { return run.counters.at(name).value; }

class OneLineEach : public benchmark::BenchmarkReporter {
    bool failed_ = false;

    virtual void show_error(Run const& run) { fmt::print("{:<44}{}\n", run.run_name.str(), run.error_message); }

    virtual void show(Run const& run) {
        fmt::print("{:<44}{:>14.1f}{:>9.1f}{:>8}", run.run_name.str(), counter(run, "ns_per_update"),
                   counter(run, "digits"), counter(run, "finite") != 0 ? "yes" : "no");
        if (run.counters.contains("ns_theta"))
            fmt::print("{:>12.1f}{:>12.1f}", counter(run, "ns_theta"), counter(run, "ns_longest"));
        else if (run.counters.contains("over_ud"))
            fmt::print("  {:.2f} of ud alone, a check {:.1f}", counter(run, "over_ud"), counter(run, "check"));
        fmt::print("\n");
    }

public:
    bool ReportContext(Context const&) override {
        fmt::print("{:<44}{:>14}{:>9}{:>8}{:>12}{:>12}\n", "", "ns/update", "digits", "finite", "ns/theta", "longest");
        return true;
    }
    void ReportRuns(std::vector<Run> const& runs) override {
        for (Run const& run : runs) {
            if (run.error_occurred) {
                if (run.repetition_index <= 0) show_error(run);
                failed_ = true;
            } else if (run.repetitions <= 1 || run.aggregate_name == "median") show(run);
        }
        std::fflush(stdout);
    }
    bool failed() const { return failed_; }
};

/// A text as a field of CSV.
std::string quoted(std::string const& text) {
    std::string out = "\"";
    for (char const c : text) out += c == '"' ? "\"\"" : c == '\n' ? " " : std::string(1, c);
    return out + '"';
}

/// Interleaved repetitions end in any order: the tables come when all have ended.
class ByTheSize : public OneLineEach {
    struct Row {
        std::string name, arithmetic;
        Index size;
        bool peer;
        Run run;
    };
    std::string machine_;
    std::vector<Row> rows_;

    void show_error(Run const& run) override { show(run); }
    void show(Run const& run) override {
        auto const parts = split(run.run_name.str(), '/');
        rows_.push_back({parts[1], parts[2], std::stol(parts[3]), parts[0] == "peer", run});
    }

    /// What 99.99 % of single updates take at most, or `none` where too few were timed.
    static std::string p9999(Run const& run, char const* none) {
        double const time = counter(run, "ns_p9999");
        return time == 0 ? none : fmt::format("{:.0f}", time);
    }

public:
    explicit ByTheSize(std::string machine) : machine_(std::move(machine)) {}
    std::string csv() const {
        std::string out = fmt::format(
            "# {}\n# ns: one update, the least over stretches of rows; theta: solving for it, "
            "where that is asked; p50, p99, p99_99, largest: of single updates\n"
            "parameters,arithmetic,name,ns,theta,p50,p99,p99_99,largest,digits,finite,error\n",
            machine_);
        for (auto const& [name, arithmetic, size, peer, run] : rows_) {
            if (run.error_occurred) {
                out += fmt::format("{},{},{},,,,,,,,,{}\n", size, arithmetic, name, quoted(run.error_message));
                continue;
            }
            out += fmt::format("{},{},{},{:.2f},{:.2f},{:.1f},{:.1f},{},{:.0f},{:.2f},{},\n", size, arithmetic, name,
                               counter(run, "ns_per_update"), counter(run, "ns_theta"), counter(run, "ns_p50"),
                               counter(run, "ns_p99"), p9999(run, ""), counter(run, "ns_largest"),
                               counter(run, "digits"), int(counter(run, "finite")));
        }
        return out;
    }

    bool ReportContext(Context const&) override { return true; }
    void Finalize() override {
        std::ranges::stable_sort(rows_, {}, [](Row const& row) {
            return std::tuple(row.size, row.peer,
                              row.peer || row.run.error_occurred ? 0 : counter(row.run, "ns_per_update"));
        });
#ifndef __OPTIMIZE__
        fmt::print("compiled without optimisation: these times are nobody's\n");
#endif
        fmt::print("{}\nns of one update; of single updates half take no more than p50, 99 % than p99\n", machine_);
        Index size = 0;
        for (Row const& row : rows_) {
            if (row.size != size)
                fmt::print("\n{:<31}{:>8}{:>8}{:>8}{:>8}{:>9}{:>8}\n", fmt::format("{} parameters", size = row.size),
                           "ns", "p50", "p99", "p99.99", "largest", "digits");
            std::string const name = row.name + (row.arithmetic == "float" ? ", float" : "");
            if (row.run.error_occurred) {
                fmt::print("  {:<29}{}\n", name, row.run.error_message);
                continue;
            }
            fmt::print("  {:<29}{:>8.0f}{:>8.0f}{:>8.0f}{:>8}{:>9.0f}{:>8}\n", name, counter(row.run, "ns_per_update"),
                       counter(row.run, "ns_p50"), counter(row.run, "ns_p99"), p9999(row.run, "-"),
                       counter(row.run, "ns_largest"),
                       counter(row.run, "finite") != 0 ? fmt::format("{:.1f}", counter(row.run, "digits")) : "broke");
        }
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

constexpr char run_options[] = R"(      --sizes 5,12            one filter at a time, of these sizes (or 4,16,64)
      --double, --float       in these arithmetics (or in double)
      --fixed                 variants whose size the compiler knows: 2, 3, 4, 6, 8
      --mine                  a class of one's own, where one is compiled in (docs/bench.md)
      --csv FILE              the table as CSV, too
)";

}  // namespace

int run_rows(int argc, char** argv) {
    for (int i = 1; i < argc; ++i)
        if (std::string_view(argv[i]) == "--help")
            fmt::print("{} [OPTION...]: times the rows. Our options, then those of Google Benchmark:\n{}\n", argv[0],
                       run_options);
    std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit is an error like any other
    take_choice(argc, argv);
    if (std::string const& csv = choice().csv; !csv.empty()) {  // before minutes are spent
        std::filesystem::path const path(csv), folder = path.parent_path();
        if (std::filesystem::is_directory(path) || (!folder.empty() && !std::filesystem::is_directory(folder)))
            throw std::runtime_error(fmt::format("--csv {}: cannot be written", csv));
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    Rows::add_all();
    if (choice().mine && !has_mine)
        throw std::runtime_error(
            "--mine: no class is compiled into this program; expected ./lab bench --mine FILE.cpp,"
            " or a program by rlslab_add_bench");
    // The name alone is that of several generations.
    std::string const cpu = fmt::format("{} (family {}, model {})", processor("model name"), processor("cpu family"),
                                        processor("model")),
                      instructions(name_of(kernels::isa)), compiler = "g++ " __VERSION__;
    benchmark::AddCustomContext("cpu", cpu);
    benchmark::AddCustomContext("instructions", instructions);
    benchmark::AddCustomContext("compiler", compiler);
    // With JSON or CSV, standard output has nothing else; otherwise it has one line for each row, or the tables.
    benchmark::BenchmarkReporter* const chosen = benchmark::CreateDefaultDisplayReporter();
    OneLineEach lines;
    ByTheSize tables(fmt::format("{}, {}, {}", cpu, instructions, compiler));
    bool const for_people = dynamic_cast<benchmark::ConsoleReporter*>(chosen) != nullptr;
    if (choice().made && !for_people && !choice().csv.empty())
        throw std::runtime_error("--csv: does not go with --benchmark_format");
    OneLineEach& ours = choice().made ? static_cast<OneLineEach&>(tables) : lines;
    if (benchmark::RunSpecifiedBenchmarks(for_people ? &ours : chosen) == 0)
        throw std::runtime_error("no row has these sizes, arithmetic and filter");
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) throw std::runtime_error("standard output: cannot be written");
    if (!choice().csv.empty()) replace_file(choice().csv, tables.csv());
    return ours.failed() ? 2 : 0;
}

}  // namespace rlslab::bench
