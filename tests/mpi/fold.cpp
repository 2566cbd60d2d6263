// A rank of a job that folds the same rows on any number of ranks: the first prints the state's bytes, in hexadecimal.
#include <rlslab/many/mpi_ranks.hpp>
#include <rlslab/variants/qr_block.hpp>

#include <cstdio>

/// Made where they are read: a rank needs its own rows alone.
struct Rows {
    rlslab::Index size() const { return 4; }
    rlslab::Index rows() const { return 100003; }
    void read(rlslab::Index first, Eigen::Ref<rlslab::Matrix<double>> block) const {
        for (rlslab::Index k = 0; k < block.cols(); ++k) {
            rlslab::Seed seed{std::uint64_t(first + k)};
            for (rlslab::Index i = 0; i < block.rows(); ++i) block(i, k) = seed.uniform() - 0.5;
        }
    }
};

int main(int argc, char** argv) {
    MPI_Init(&argc, &argv);
    using F = rlslab::QrBlock<double>;
    {
        auto const filter =
            rlslab::fold_ranks<F>(rlslab::MpiRanks{}, {.size = 4, .forgetting = 0.9999}, Rows{}, 1, 10000, 1000);
        if (filter) {
            for (std::byte const b : rlslab::state_of(*filter)) std::printf("%02x", unsigned(b));
            std::printf("\n");
        }
    }
    MPI_Finalize();
}
