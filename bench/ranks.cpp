// rlslab_bench_ranks: what one rank folds in a second, and what merging costs: the figures of the model in docs/scale.md.
#include <rlslab/many/mpi_ranks.hpp>
#include <rlslab/variants/qr_block.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace {

using rlslab::Index;
using F = rlslab::QrBlock<double>;

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Rows in memory, again and again: reading a file is another question.
struct Rows {
    rlslab::Matrix<double> block;
    Index all;
    Index size() const { return block.rows() - 1; }
    Index rows() const { return all; }
    void read(Index first, Eigen::Ref<rlslab::Matrix<double>> to) const {
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
        if (load(part, state) != rlslab::StateFault::none) std::abort();
        whole.merge(part);
    }
    return (seconds() - before) / times;
}

}  // namespace

int main(int argc, char** argv) {
    MPI_Init(&argc, &argv);
    {
        Index const size = argc > 1 ? std::atol(argv[1]) : 20, all = argc > 2 ? std::atol(argv[2]) : 20'000'000;
        Index const group = argc > 3 ? std::atol(argv[3]) : rlslab::rows_a_group;
        rlslab::Seed seed{1};
        Rows rows{rlslab::Matrix<double>(size + 1, 65536), all};
        for (Index k = 0; k < rows.block.cols(); ++k)
            for (Index i = 0; i <= size; ++i) rows.block(i, k) = seed.uniform() - 0.5;
        rlslab::MpiRanks const ranks;
        MPI_Barrier(MPI_COMM_WORLD);
        double const before = seconds();
        auto const filter = rlslab::fold_ranks<F>(ranks, {.size = size}, rows, 1, group);
        double const took = seconds() - before;
        if (filter)
            std::printf(
                "%d ranks, %ld parameters, %ld rows in groups of %ld: %.2f s, %.3g rows/s a rank; merging a group %.3g s; |theta| %.6g\n",
                ranks.ranks(), long(size), long(all), long(group), took, double(all) / took / ranks.ranks(), merging(rows),
                filter->theta().norm());
    }
    MPI_Finalize();
}
