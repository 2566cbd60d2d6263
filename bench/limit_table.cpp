// rlslab_bench_limits RUN.json: how a run stands to the limits, as a table of Markdown. Exit code 2: the question cannot be answered.
#include "bench/limits.hpp"
#include "bench/results.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <stdexcept>

int main(int argc, char** argv) try {
    if (argc != 2) throw std::runtime_error("usage: rlslab_bench_limits RUN.json");
    auto const times = rlslab::bench::made_from(argv[1], "not there (./lab bench makes it)", rlslab::bench::times_of);
    fmt::print("{}", rlslab::bench::table_of_limits(times));
    return 0;
} catch (std::exception const& error) {
    fmt::print(stderr, "rlslab_bench_limits: {}\n", error.what());
    return 2;
}
