// The ranks of an MPI job, for fold_ranks. Without MPI's header on the include path this file is empty.
#pragma once

#if __has_include(<mpi.h>)
#include <rlslab/many/fold_ranks.hpp>

#include <mpi.h>

namespace rlslab {

/// MPI_COMM_WORLD between MPI_Init and MPI_Finalize. Messages of up to 2 GiB; errors end the job, as MPI does of
/// itself.
class MpiRanks {
    static constexpr int tag = 0x725;
    int rank_ = 0, ranks_ = 1;

public:
    MpiRanks() {
        MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
        MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
    }
    int rank() const { return rank_; }
    int ranks() const { return ranks_; }
    void send(std::span<std::byte const> bytes, int to) const {
        expects(bytes.size() <= size_t(std::numeric_limits<int>::max()), "a message of at most 2 GiB");
        MPI_Send(bytes.data(), int(bytes.size()), MPI_BYTE, to, tag, MPI_COMM_WORLD);
    }
    std::vector<std::byte> receive(int from) const {
        MPI_Status status;
        MPI_Probe(from, tag, MPI_COMM_WORLD, &status);
        int size = 0;
        MPI_Get_count(&status, MPI_BYTE, &size);
        std::vector<std::byte> bytes(size_t(size), std::byte{});
        MPI_Recv(bytes.data(), size, MPI_BYTE, from, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        return bytes;
    }
};
static_assert(Ranks<MpiRanks>);

}  // namespace rlslab
#endif
