// Rows folded by ranks that send each other states: the same bits for any number of ranks and threads, here and as an
// MPI job.
#include "tests/common/laws.hpp"
#include "tests/common/program.hpp"

#include <rlslab/many/fold_ranks.hpp>
#include <rlslab/variants/qr_block.hpp>

#include <condition_variable>
#include <deque>
#include <map>
#include <set>

namespace rlslab {
namespace {

using F = QrBlock<double>;

/// What the ranks of one process send each other.
struct Mail {
    std::mutex mutex;
    std::condition_variable arrived;
    std::map<std::pair<int, int>, std::deque<std::vector<std::byte>>> from_to;
};
struct RanksHere {
    Mail* mail;
    int number, of;
    int rank() const { return number; }
    int ranks() const { return of; }
    void send(std::span<std::byte const> bytes, int to) const {
        std::lock_guard const lock(mail->mutex);
        mail->from_to[{number, to}].emplace_back(bytes.begin(), bytes.end());
        mail->arrived.notify_all();
    }
    std::vector<std::byte> receive(int from) const {
        std::unique_lock lock(mail->mutex);
        auto& queue = mail->from_to[{from, number}];
        mail->arrived.wait(lock, [&] { return !queue.empty(); });
        auto out = std::move(queue.front());
        queue.pop_front();
        return out;
    }
};
static_assert(Ranks<RanksHere>);

/// Which rows were read.
struct Watched {
    RowsInMemory rows_;
    std::set<Index>* read_;
    Index size() const { return rows_.size(); }
    Index rows() const { return rows_.rows(); }
    void read(Index first, Eigen::Ref<Matrix<double>> block) const {
        for (Index k = 0; k < block.cols(); ++k) read_->insert(first + k);
        rows_.read(first, block);
    }
};

std::vector<std::byte> folded(Problem<double> const& p, Records const& records, int ranks, unsigned threads,
                              Index group, Index part) {
    Mail mail;
    std::vector<std::byte> out;
    std::vector<std::set<Index>> read(size_t(ranks), std::set<Index>{});
    {
        std::vector<std::jthread> jobs;
        for (int rank = 0; rank < ranks; ++rank)
            jobs.emplace_back([&, rank] {
                Watched const source{RowsInMemory(records), &read[size_t(rank)]};
                auto const filter = fold_ranks<F>(RanksHere{&mail, rank, ranks}, p, source, threads, group, part);
                EXPECT_EQ(filter.has_value(), rank == 0);
                if (filter) out = state_of(*filter);
            });
    }
    size_t all = 0;
    for (auto const& rows : read) all += rows.size();
    EXPECT_EQ(all, size_t(records.rows())) << "each row is read by one rank";
    return out;
}

TEST(FoldRanks, TheBitsAreTheSameForAnyNumberOfRanksAndThreads) {
    for (std::uint64_t const seed : {71, 72, 73}) {
        Records const records = laws::noise_records(5, 1003, Seed{seed});
        for (auto const& p : {laws::problem(5, 0.999), Problem<double>{.size = 5, .prior = std::nullopt}}) {
            auto const one = folded(p, records, 1, 1, 100, 30);
            for (int const ranks : {2, 3, 4, 7, 20}) EXPECT_EQ(folded(p, records, ranks, 1, 100, 30), one) << ranks;
            EXPECT_NE(folded(p, records, 2, 1, 200, 30), one) << "a saboteur: other groups round otherwise";
        }
    }
    Records const records = laws::noise_records(5, 1003, Seed{74});
    auto const one = folded(laws::problem(5), records, 1, 1, 250, 30);
    Mail mail;
    auto const two = fold_ranks<F>(RanksHere{&mail, 0, 1}, laws::problem(5), RowsInMemory(records), 3, 250, 30);
    EXPECT_EQ(state_of(*two), one);
}

TEST(FoldRanks, OneGroupWithoutAPriorIsFoldAll) {
    Records const records = laws::noise_records(4, 500, Seed{75});
    Problem<double> const p{.size = 4, .prior = std::nullopt};
    Mail mail;
    auto const ranks = fold_ranks<F>(RanksHere{&mail, 0, 1}, p, RowsInMemory(records), 1, 1000, F::block);
    EXPECT_EQ(state_of(*ranks), state_of(fold_all<F>(p, RowsInMemory(records), 1, F::block)));
}

TEST(FoldRanks, WhatIsNoStateIsRefused) {
    Records const records = laws::noise_records(4, 500, Seed{76});
    Mail mail;
    mail.from_to[{1, 0}].emplace_back(100, std::byte{7});
    EXPECT_THROW(fold_ranks<F>(RanksHere{&mail, 0, 2}, laws::problem(4), RowsInMemory(records), 1, 100, 64),
                 std::runtime_error);
    auto damaged = state_of(F(Problem<double>{.size = 4}));
    damaged[120] ^= std::byte{1};
    mail.from_to[{1, 0}] = {damaged};
    EXPECT_THROW(fold_ranks<F>(RanksHere{&mail, 0, 2}, laws::problem(4), RowsInMemory(records), 1, 100, 64),
                 std::runtime_error);
    EXPECT_THROW(fold_ranks<F>(RanksHere{&mail, 0, 1}, laws::problem(4), RowsInMemory(records), 1, 0),
                 std::invalid_argument);
    EXPECT_THROW(fold_ranks<F>(RanksHere{&mail, 0, 1}, laws::problem(3), RowsInMemory(records)), std::invalid_argument);
}

#ifdef RLSLAB_MPI_FOLD
TEST_F(Program, RanksOfAnMpiJobFoldToTheSameBits) {
    std::string one;
    for (int const ranks : {1, 2, 3, 4}) {
        ::Outcome const run = shell(on_ranks(ranks, RLSLAB_MPI_FOLD));
        ASSERT_EQ(run.code, 0) << run.err;
        EXPECT_GT(run.out.size(), 2 * StateHeader::size);
        if (one.empty()) one = run.out;
        EXPECT_EQ(run.out, one) << ranks;
    }
}
#else
TEST(Mpi, Folds) { GTEST_SKIP() << "MPI was not found (Debian: libopenmpi-dev, openmpi-bin)"; }
#endif

}  // namespace
}  // namespace rlslab
