// rlslab_bench_check RUN.json BASELINE.json [--record]: what moved since the baseline. Exit code: 0 nothing became slower, 1 something did,
// 2 the question cannot be answered. With --record the run becomes the baseline.
#include "bench/baseline.hpp"
#include "bench/results.hpp"

#include <rlslab/core/files.hpp>

#include <csignal>
#include <cstdio>
#include <fmt/format.h>
#include <stdexcept>

namespace {

using namespace rlslab::bench;

constexpr char missing[] = "not there (./lab bench --record makes a baseline)";

}  // namespace

int main(int argc, char** argv) try {
    bool const record = argc == 4 && std::string(argv[3]) == "--record";
    if (argc != 3 && !record) throw std::runtime_error("usage: rlslab_bench_check RUN.json BASELINE.json [--record]");
    std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit is an error like any other
    Baseline const now = made_from(argv[1], missing, baseline_of);
    if (record) {
        rlslab::replace_file(argv[2], written(now));
        fmt::print("{} rows recorded\n", now.rows.size());
        return 0;
    }
    Baseline const before = made_from(argv[2], missing, read_baseline);
    if (before.machine != now.machine)
        throw std::runtime_error(
            fmt::format("the baseline is of another machine or compiler ({}); this one is {}", before.machine, now.machine));
    int slower = 0, rows = 0;
    for (auto const& [name, ratio] : now.rows) rows += int(before.rows.count(name));
    if (rows == 0) throw std::runtime_error("no row of the baseline is in the run");
    if (size_t(rows) < before.rows.size()) fmt::print("{} rows of the baseline are not in the run\n", before.rows.size() - size_t(rows));
    for (Moved const& m : moved(before, now)) {
        slower += m.factor() > 1;
        fmt::print("{:<44}{:>7.3f} x  {:.3g} ... {:.3g}, was {:.3g} ... {:.3g}\n", m.name, m.factor(), m.now.least, m.now.greatest,
                   m.before.least, m.before.greatest);
    }
    fmt::print("{} of {} rows became slower, beyond what the repetitions scatter and by more than 5 %\n", slower, rows);
    return slower > 0 ? 1 : 0;
} catch (std::exception const& error) {
    fmt::print(stderr, "rlslab_bench_check: {}\n", error.what());
    return 2;
}
