// rlslab_mpi: `mpirun rlslab_mpi study ...` deals the trials to the ranks; the first one then writes the tables.
#include "program/run.hpp"

#include <cstdio>
#include <mpi.h>

int main(int argc, char** argv) {
    rlslab::prepare_process();
    MPI_Init(&argc, &argv);
    int rank = 0, ranks = 1, code = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    std::vector<std::string> const words{argv + (argc > 0), argv + argc};
    if (words.empty() || words.front() != "study") {
        if (rank == 0) std::fputs("rlslab: expected rlslab_mpi study ...: other commands need no ranks\n", stderr);
        code = 2;
    } else if (ranks > 1) {
        std::vector<std::string> part = words;
        part.insert(part.end(), {"--part", std::to_string(rank + 1) + "/" + std::to_string(ranks), "--quiet"});
        int const own = rlslab::run(part, rank);
        MPI_Allreduce(&own, &code, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);  // behind it the journals are complete
    }
    if (code == 0 && rank == 0) code = rlslab::run(words);
    MPI_Finalize();
    return code;
}
