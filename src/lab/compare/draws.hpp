// Draws of the roundings: the same rows in other units round anew. How many a comparison takes.
#pragma once

#include "src/lab/compare/compare.hpp"
#include "src/lab/compare/score.hpp"

namespace rlslab::compare {

/// Draw i of the roundings: every psi and y times a factor near 1 (draw 0: 1; then 15/16, 31/32, 29/32 ...; none below
/// 27/32). theta is the same and every intermediate result is rounded at another place. P0 stays as it is. The factors
/// have few bits, so that whole numbers stay whole numbers of few bits.
Records drawn(Records records, size_t draw);

/// Draws are taken four at a time, until `settled`; at most 16, and at most as many as make 2^17 rows. One
/// with a composition.
inline constexpr size_t draws_at_a_time = 4;
size_t most_draws(Index rows, CompareOptions const& options = {});

/// Whether a further draw could change what is named: a form for single rows that never broke down, whose loss is at
/// most two digits.
bool is_contender(Result const& result, std::vector<Result const*> const& sound);

/// Whether the draws tell enough. `runs` are those of `results`, entry by entry, of one arithmetic; `before` is what
/// the draws before the last four named. They do
///   (1) where nothing is named
///   (2) where what is named was named before
///   (3) where in each measure the mean over the draws of what it lacks to the best, by medians, and two standard
///       errors of that mean are at most half a digit
bool settled(std::vector<Result const*> const& results, std::vector<Runs const*> const& runs,
             std::vector<Index> const& checkpoints, std::string const& named, std::string const& before);

}  // namespace rlslab::compare
