// What one rank folds in a second, and what merging costs: the figures of the model in docs/scale.md.
#include "bench/results.hpp"

#include <rlslab/many/mpi_ranks.hpp>
#include <rlslab/variants/qr_block.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <vector>

namespace rlslab::bench {
namespace {

using F = QrBlock<double>;

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Rows in memory, again and again: reading a file is another question.
struct Rows {
    Matrix<double> block;
    Index all;
    Index size() const { return block.rows() - 1; }
    Index rows() const { return all; }
    void read(Index first, Eigen::Ref<Matrix<double>> to) const {
        to = block.middleCols(first % (block.cols() - to.cols() + 1), to.cols());
    }
};

double merging(Rows const& rows) {
    F whole({.size = rows.size()}), part({.size = rows.size(), .prior = std::nullopt});
    process(part, rows.block.topRows(rows.size()).leftCols(1024), rows.block.row(rows.size()).head(1024).transpose());
    auto const state = state_of(part);
    int const times = 1000;
    double const before = seconds();
    for (int i = 0; i < times; ++i) {
        if (load(part, state) != StateFault::none) std::abort();
        whole.merge(part);
    }
    return (seconds() - before) / times;
}

/// Whether this is a rank of an MPI job, whichever of the usual launchers (Open MPI, MPICH, Slurm) started it.
bool under_mpirun() {
    return std::getenv("OMPI_COMM_WORLD_SIZE") || std::getenv("PMI_SIZE") || std::getenv("PMIX_RANK");
}

void fold(Index size, Index all, Index group) {
    Seed seed{1};
    Rows rows{Matrix<double>(size + 1, 65536), all};
    for (Index k = 0; k < rows.block.cols(); ++k)
        for (Index i = 0; i <= size; ++i) rows.block(i, k) = seed.uniform() - 0.5;
    MpiRanks const ranks;
    MPI_Barrier(MPI_COMM_WORLD);
    double const before = seconds();
    auto const filter = fold_ranks<F>(ranks, {.size = size}, rows, 1, group);
    double const took = seconds() - before;
    if (filter)
        std::printf(
            "%d ranks, %ld parameters, %ld rows in groups of %ld: %.2f s, %.3g rows/s a rank; merging a group %.3g s; "
            "|theta| %.6g\n",
            ranks.ranks(), long(size), long(all), long(group), took, double(all) / took / ranks.ranks(), merging(rows),
            filter->theta().norm());
}

}  // namespace

int run_ranks(char** argv) {
    auto const number = [&](int i, Index otherwise) {
        for (int k = 2; k <= i; ++k)
            if (!argv[k]) return otherwise;
        Index const given = std::atol(argv[i]);
        if (given < 1)
            throw std::runtime_error("expected ranks [RANKS [PARAMETERS [ROWS [GROUP]]]], numbers from 1 on");
        return given;
    };
    std::string const ranks = std::to_string(number(2, 2));
    Index const size = number(3, 20), rows = number(4, 20'000'000), group = number(5, rows_a_group);
    if (!under_mpirun()) {
        std::vector<char const*> words{"mpirun", "-n", ranks.c_str()};
        for (char** word = argv; *word; ++word) words.push_back(*word);
        words.push_back(nullptr);
        ::execvp(words.front(), const_cast<char**>(words.data()));
        throw std::runtime_error("mpirun does not start");
    }
    MPI_Init(nullptr, nullptr);
    fold(size, rows, group);
    MPI_Finalize();
    return 0;
}

}  // namespace rlslab::bench
