// rlslab_bench: times rows, and shows what a run has. Exit code: 0; 2 no answer.
#include "bench/choice.hpp"
#include "bench/results.hpp"

#include <rlslab/core/files.hpp>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace {

using namespace rlslab::bench;

constexpr char verbs[] = R"(expected one of
  run [OPTION...]             times the rows; run --help has the options
  page RUN.json PAGE.html     plots and tables of a run
  record RUN.json BASELINE    makes the run the baseline of its kind of machine
  add RUN.json BASELINE       adds the rows that the baseline of its kind of machine has not
  table RUN.json              nanoseconds at 4 to 256 parameters beside dlib, and parameters at 48 and 16 kHz, as
                              Markdown
  ranks [RANKS [PARAMETERS [ROWS [GROUP]]]]
                              rows a second of the ranks of an MPI job, which it starts by mpirun
                              (in builds with MPI))";

/// make(the file's text). Throws std::runtime_error that begins with the file's name; `missing` where there is none.
template <class Make>
auto made_from(char const* path, char const* missing, Make make) {
    try {
        std::ifstream file(path, std::ios::binary);
        if (!file) throw std::runtime_error(missing);
        return make(std::string{std::istreambuf_iterator<char>(file), {}});
    } catch (std::exception const& error) {
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    }
}
auto of_run(char const* path, auto make) { return made_from(path, "not there (./lab bench makes it)", make); }

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
    if (verb == "table" && argc == 3) return fmt::print("{}", table_of_times(of_run(argv[2], run_of))), 0;
    if ((verb != "record" && verb != "add") || argc != 4) throw std::runtime_error(verbs);
    std::string const before = std::filesystem::exists(argv[3])
                                   ? made_from(argv[3], "cannot be read", [](std::string const& text) { return text; })
                                   : "";
    auto const with_it = [&](std::string const& run) { return recorded(before, run, verb == "add"); };
    rlslab::replace_file(argv[3], of_run(argv[2], with_it));
    return 0;
} catch (std::exception const& error) {
    fmt::print(stderr, "rlslab_bench: {}\n", error.what());
    return 2;
}
