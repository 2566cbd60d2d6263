// The digits that a composition keeps around a variant, against what it would answer without rounding. What the probes
// of a running filter show of its error of P, beside that error in 257 bits.
#pragma once

#include "src/lab/compare/score.hpp"

#include <map>
#include <mutex>

namespace rlslab::compare {

/// One recursion in 257 bits at each checkpoint, and how far to trust it: the digits in which a second variant agrees.
struct Recursion {
    std::vector<Vector<Reference>> theta;
    std::vector<Matrix<Reference>> P;
    std::vector<double> agreement;
};

/// What a composition is compared with, for one rounded problem. Computed when needed; several threads may use it.
///
///   (1) minimiser: theta and P of the least-squares problem that the rows in the window pose, or all rows so far where
///       there is none, with weights lambda^i and the prior; proven
///   (2) recursion: what the same composition answers in 257 bits. In exact arithmetic all variants are one recursion:
///       here it is ud's, and qr's beside it, whose agreement bounds the digits that are counted. Not proven. (`kalman`
///       with a walk of its own: kalman's)
class CompositionReference {
    Composition composition_;
    RoundedProblem const& rounded_;
    int digits_;
    std::vector<Index> checkpoints_;
    std::mutex one_at_a_time_;
    std::map<std::pair<size_t, Index>, CertifiedSolution> minimisers_;
    std::map<std::string, Recursion, std::less<>> recursions_;

public:
    /// `composition` with its numbers as the arithmetic stores them; `rounded` outlives this. `digits`: to which (1) is
    /// certified.
    CompositionReference(Composition const& composition, RoundedProblem const& rounded, int digits);
    /// (1) at a checkpoint. `aged`: rows whose lambda the prior has met, which a window that factors anew starts from.
    CertifiedSolution const& minimiser(size_t checkpoint, Index aged);
    /// (2) for this variant.
    Recursion const& recursion(std::string_view variant);
    Composition const& composition() const { return composition_; }
    /// The prior's age in a filter after k rows to which that happened.
    Index age_of_prior(Index k, CompositionCounts const& happened) const;
};

/// Whether a guard changed a filter's rows or state: from there on only (2) is what it would answer without rounding.
bool intervened(Composition const& composition, CompositionCounts const& happened);

/// The result of an entry with a composition around it, in the record's own order. Where the variant cannot be composed
/// so, Result::obstacle gives the reason.
Result score_composed(CatalogueEntry const& entry, RoundedProblem const& rounded, CompositionReference& reference);

/// Probes that --certify gives each filter.
inline constexpr Index probes_of_compare = 3;

/// Result::probed of each form in float or double that takes probes. `rounded`: by the name of the arithmetic.
void probe(std::vector<Result>& results, std::map<std::string_view, RoundedProblem> const& rounded);

}  // namespace rlslab::compare
