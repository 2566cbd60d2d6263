// rlslab_mpi: `mpirun rlslab_mpi study ...` deals the trials to the ranks; the first one then writes the tables.
#include "program/commands.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <mpi.h>

namespace {

/// The exit code. What is wrong with the command line is said once, anything else by the rank that it befell.
int run(std::vector<std::string> const& words, int rank) {
    bool understood = false;
    try {
        auto const command = rlslab::parse(words);
        understood = true;
        return command();
    } catch (std::bad_alloc const&) {
        std::fprintf(stderr, "rlslab: rank %d: out of memory\n", rank);
    } catch (std::exception const& error) {
        if (understood || rank == 0) std::fprintf(stderr, "rlslab: %s\n", error.what());
    }
    return 2;
}

}  // namespace

int main(int argc, char** argv) {
    MPI_Init(&argc, &argv);
    int rank = 0, ranks = 1, code = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    std::vector<std::string> words{argv + (argc > 0), argv + argc};
    if (words.empty() || words.front() != "study") {
        if (rank == 0) std::fputs("rlslab: expected rlslab_mpi study ...: other commands need no ranks\n", stderr);
        code = 2;
    } else if (ranks > 1) {
        std::vector<std::string> part = words;
        part.insert(part.end(), {"--part", fmt::format("{}/{}", rank + 1, ranks), "--quiet"});
        int const own = run(part, rank);
        MPI_Allreduce(&own, &code, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);  // behind it the journals are complete
    }
    if (code == 0 && rank == 0) code = run(words, rank);
    MPI_Finalize();
    return code;
}
