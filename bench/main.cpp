// rlslab_bench: times rows, and shows what a run has. Exit code: 0; 1 where `check` finds a row that became slower; 2
// no answer.
#include "bench/limits.hpp"
#include "bench/results.hpp"
#include "bench/verbs.hpp"

#include <rlslab/core/files.hpp>

#include <csignal>
#include <cstdio>
#include <filesystem>

namespace {

using namespace rlslab::bench;

constexpr char verbs[] = R"(expected one of
  run [OPTION...]             times the rows; run --help has the options
  page RUN.json PAGE.html     plots and tables of a run
  check RUN.json BASELINE     what became slower since, on this kind of machine
  record RUN.json BASELINE    makes the run the baseline of its kind of machine
  add RUN.json BASELINE       adds the rows that the baseline of its kind of machine has not
  limits RUN.json BASELINE    the run's machine, those that were recorded, and how the run stands to the limits of
                              docs/speed.md
  table RUN.json              nanoseconds at 4 to 256 parameters beside dlib, and parameters at 48 and 16 kHz, as
                              Markdown
  ranks [RANKS [PARAMETERS [ROWS [GROUP]]]]
                              rows a second of the ranks of an MPI job, which it starts by mpirun
                              (in builds with MPI))";

template <class Make>
auto of_run(char const* path, Make make) {
    return made_from(path, "not there (./lab bench makes it)", make);
}

/// What was recorded so far; nothing where there is no such file.
Baselines recorded(char const* path) {
    return std::filesystem::exists(path) ? made_from(path, "cannot be read", read_baselines) : Baselines{};
}

int check(Baseline const& before, Baseline const& now) {
    int slower = 0, rows = 0;
    for (auto const& [name, ratio] : now.rows) rows += int(before.rows.count(name));
    if (rows == 0) throw std::runtime_error("no row of the baseline is in the run");
    if (size_t(rows) < before.rows.size())
        fmt::print("{} rows of the baseline are not in the run\n", before.rows.size() - size_t(rows));
    for (Moved const& m : moved(before, now)) {
        slower += m.factor() > 1;
        fmt::print("{:<44}{:>7.3f} x  {:.3g} ... {:.3g}, was {:.3g} ... {:.3g}\n", m.name, m.factor(), m.now.least,
                   m.now.greatest, m.before.least, m.before.greatest);
    }
    fmt::print("{} of {} rows became slower, beyond what the repetitions scatter and by more than 5 %\n", slower, rows);
    return slower > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) try {
    std::string const verb = argc > 1 ? argv[1] : "";
    if (verb == "run") {
        argv[1] = argv[0];
        return run_rows(argc - 1, argv + 1);
    }
    if (verb == "--help" || verb == "help") return fmt::print("rlslab_bench: {}\n", verbs), 0;
#ifdef RLSLAB_BENCH_RANKS
    if (verb == "ranks" && argc <= 6) return run_ranks(argv);
#endif
    std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit is an error like any other
    if (verb == "page" && argc == 4) return rlslab::replace_file(argv[3], page_of(of_run(argv[2], run_of))), 0;
    if (verb == "limits" && argc == 4) {
        std::string const machine = of_run(argv[2], machine_of_run), table = table_of_limits(of_run(argv[2], times_of));
        fmt::print("Of {}. Recorded: {}.\n\n{}", machine, names_of(recorded(argv[3])), table);
        return 0;
    }
    if (verb == "table" && argc == 3) return fmt::print("{}", table_of_times(of_run(argv[2], run_of))), 0;
    if ((verb != "check" && verb != "record" && verb != "add") || argc != 4) throw std::runtime_error(verbs);
    Baseline const now = of_run(argv[2], baseline_of);
    Baselines all = recorded(argv[3]);
    if (verb == "check") return check(of_machine(all, now.machine), now);
    verb == "add" ? add(all, now) : record(all, now);
    rlslab::replace_file(argv[3], written(all));
    fmt::print("{} rows recorded of {}\n", of_machine(all, now.machine).rows.size(), now.machine);
    return 0;
} catch (std::exception const& error) {
    fmt::print(stderr, "rlslab_bench: {}\n", error.what());
    return 2;
}
