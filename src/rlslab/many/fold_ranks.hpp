// Batch least squares on several machines: groups of rows are folded by ranks that share no memory, and merged in order
// by the first.
#pragma once

#include <rlslab/many/fold_all.hpp>
#include <rlslab/state/state.hpp>

#include <optional>
#include <stdexcept>
#include <string>

namespace rlslab {

/// Processes numbered 0 ... ranks() - 1 that send bytes to each other. What one rank sends to another arrives in the
/// order it was sent.
///   send(bytes, to)      returns when the bytes may be reused
///   receive(from)        waits for the next bytes of that rank
template <class R>
concept Ranks = requires(R const& r, std::span<std::byte const> bytes) {
    { r.rank() } -> std::convertible_to<int>;
    { r.ranks() } -> std::convertible_to<int>;
    r.send(bytes, 0);
    { r.receive(0) } -> std::convertible_to<std::vector<std::byte>>;
};

namespace detail {
/// Some rows of a source, one after another.
template <RowSource Source>
class RowsFromTo {
    Source const* source_;
    Index first_, rows_;

public:
    RowsFromTo(Source const& source, Index first, Index rows) : source_(&source), first_(first), rows_(rows) {}
    Index size() const { return source_->size(); }
    Index rows() const { return rows_; }
    void read(Index first, Eigen::Ref<Matrix<double>> block) const { source_->read(first_ + first, block); }
};
}  // namespace detail

/// Rows of a group: 168 MB at 20 parameters. Sending a group's state, 7 kB there, then costs nothing beside folding it.
inline constexpr Index rows_a_group = Index{1} << 20;

/// The filter F(problem) after all rows of the source, on rank 0; nothing on the others. Every rank calls it with the
/// same problem and lengths, and with a source of the same rows (a file that all see, or the rank's own groups alone: a
/// rank reads no others). Group g, the rows (g G, (g + 1) G], is folded by rank g mod ranks, without a prior and on its
/// threads, as fold_all does. Rank 0 merges the groups in order of g:
///
///   ((F(problem) + group 0) + group 1) + ...
///
/// The bits depend on G and B = part, not on the number of ranks or threads. They are those of fold_all where there is
/// one group and F starts without prior. Memory: as fold_all, on each rank. Throws as fold_all; std::runtime_error on
/// rank 0 if what a rank sent is no state of its filter. What one rank throws the others do not see: end the job then
/// (MPI_Abort). Source: Demmel, Grigori, Hoemmen & Langou 2012 (TSQR).
template <Merges F, RowSource Source, Ranks R>
std::optional<F> fold_ranks(R const& ranks, Problem<typename F::scalar> const& problem, Source const& source,
                            unsigned threads = 0, Index group = rows_a_group, Index part = rows_a_part) {
    expects(problem.size == source.size() && source.rows() >= 0 && group >= 1,
            "rows of the problem's size, in groups of at least one");
    Problem<typename F::scalar> without_prior = problem;
    without_prior.prior.reset();
    std::optional<F> whole;
    if (ranks.rank() == 0) whole.emplace(problem);
    Index const rows = source.rows(), groups = rows / group + (rows % group > 0);
    for (Index g = 0; g < groups; ++g) {
        int const owner = int(g % ranks.ranks());
        if (owner == ranks.rank()) {
            detail::RowsFromTo const own(source, g * group, std::min(group, rows - g * group));
            F const folded = fold_all<F>(without_prior, own, threads, part);
            if (whole) whole->merge(folded);
            else ranks.send(state_of(folded), 0);
        } else if (whole) {
            F folded(without_prior);
            if (StateFault const fault = load(folded, ranks.receive(owner)); fault != StateFault::none)
                throw std::runtime_error("rank " + std::to_string(owner) + " sent a state that is " +
                                         std::string(name_of(fault)));
            whole->merge(folded);
        }
    }
    return whole;
}

}  // namespace rlslab
