// Batch least squares on all cores, for rows in memory or in a file that is larger than memory. Parts are processed
// separately and merged in order.
#pragma once

#include <rlslab/many/threads.hpp>
#include <rlslab/arithmetic/thread_state.hpp>
#include <rlslab/core/process.hpp>
#include <rlslab/core/records.hpp>

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>

namespace rlslab {

/// N rows [psi' y] of binary64 that several threads may read at the same time, in any order.
///   size(), rows()         d and N
///   read(first, block)     writes rows first, first + 1, ... to the columns [psi; y] of the (d + 1) x B block
template <class S>
concept RowSource = requires(S const s, Index first, Matrix<double> block) {
    { s.size() } -> std::convertible_to<Index>;
    { s.rows() } -> std::convertible_to<Index>;
    s.read(first, block);
};

/// A source whose rows are in memory: they are processed where they are, without a copy.
///   psi(first, B), y(first, B)     d x B and B numbers of the rows first, first + 1, ..., as expressions of Eigen
template <class S>
concept RowsInPlace = RowSource<S> && requires(S const s, Index first) {
    s.psi(first, first).cols();
    s.y(first, first).size();
};

/// Records as a source. The records must outlive it. Throws std::invalid_argument unless they have as many outputs as
/// rows.
class RowsInMemory {
    Records const* records_;

public:
    explicit RowsInMemory(Records const& records) : records_(&records) {
        expects(records.y.size() == records.rows(), "as many outputs as regressors");
    }
    Index size() const { return records_->parameters(); }
    Index rows() const { return records_->rows(); }
    auto psi(Index first, Index rows) const { return records_->psi.middleCols(first, rows); }
    auto y(Index first, Index rows) const { return records_->y.segment(first, rows); }
    void read(Index first, Eigen::Ref<Matrix<double>> block) const {
        block.topRows(size()) = psi(first, block.cols());
        block.bottomRows(1) = y(first, block.cols()).transpose();
    }
};

/// Rows of a part: 1.3 MB at 40 parameters. Merging the d rows of a part's triangle then costs a hundredth of
/// processing the part.
inline constexpr Index rows_a_part = 4096;

/// The filter F(problem) after all rows of the source, in order. Rows (i B, (i + 1) B], B = part, are processed by a
/// filter that starts without prior. These filters are merged into F(problem) in order of i, each by the thread that
/// made it:
///
///   ((F(problem) + part 0) + part 1) + ...
///
/// The bits depend on B, not on the number of threads (0: one for each core), also if the arithmetic takes a length or
/// a random stream from the calling thread (ThreadState). Memory: two filters and, unless the rows are in place, one
/// part for each thread, for any N. Throws what the source and F throw; std::invalid_argument if the source does not
/// have the problem's size, or if B < 1. Source: Demmel, Grigori, Hoemmen & Langou 2012 (TSQR).
template <Merges F, RowSource Source>
F fold_all(Problem<typename F::scalar> const& problem, Source const& source, unsigned threads = 0,
           Index part = rows_a_part) {
    expects(problem.size == source.size() && source.rows() >= 0 && part >= 1,
            "rows of the problem's size, in parts of at least one");
    F whole(problem);
    Problem<typename F::scalar> without_prior = problem;
    without_prior.prior.reset();
    Index const rows = source.rows(), parts = rows / part + (rows % part > 0);

    ThreadState<typename F::scalar> const state;
    std::atomic<Index> next = 0;  // part to be taken
    Index merged = 0;             // parts that are in `whole`
    std::exception_ptr failure;
    std::mutex mutex;  // guards whole, merged and failure
    std::condition_variable turn;
    auto const work = [&] {
        try {
            Matrix<double> block(RowsInPlace<Source> ? 0 : source.size() + 1, std::min(part, rows));
            for (Index i = next++; i < parts; i = next++) {
                typename ThreadState<typename F::scalar>::Part const here_as_there(state, std::uint64_t(i));
                F newer(without_prior);
                Index const here = std::min(part, rows - i * part);
                if constexpr (RowsInPlace<Source>) {
                    process(newer, source.psi(i * part, here), source.y(i * part, here));
                } else {
                    source.read(i * part, block.leftCols(here));
                    process(newer, block.topRows(source.size()).leftCols(here),
                            block.row(source.size()).head(here).transpose());
                }
                std::unique_lock lock(mutex);
                turn.wait(lock, [&] { return merged == i || failure; });
                if (failure) return;
                whole.merge(newer);
                ++merged;
                turn.notify_all();
            }
        } catch (...) {
            std::lock_guard const lock(mutex);
            if (!failure) failure = std::current_exception();
            turn.notify_all();
        }
    };
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    detail::among_threads(std::min(Index(threads), parts), [&](Index) { work(); });
    if (failure) std::rethrow_exception(failure);
    return whole;
}

}  // namespace rlslab
