// rlslab_bench_limits RUN.json: how a run stands to the limits, as a table of Markdown. Exit code 2: the question cannot be answered.
#include "bench/limits.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <stdexcept>

int main(int argc, char** argv) try {
    if (argc != 2) throw std::runtime_error("usage: rlslab_bench_limits RUN.json");
    std::ifstream file(argv[1], std::ios::binary);
    if (!file) throw std::runtime_error(fmt::format("{}: not there (./lab bench makes it)", argv[1]));
    std::string const run{std::istreambuf_iterator<char>(file), {}};
    try {
        fmt::print("{}", rlslab::bench::table_of_limits(rlslab::bench::times_of(run)));
    } catch (std::exception const& error) {
        throw std::runtime_error(fmt::format("{}: {}", argv[1], error.what()));
    }
    return 0;
} catch (std::exception const& error) {
    fmt::print(stderr, "rlslab_bench_limits: {}\n", error.what());
    return 2;
}
