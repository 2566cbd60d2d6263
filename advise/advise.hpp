// What keeps the wanted digits on a record: arithmetic, scaling, prior, variant and guard, tried on the record itself.
#pragma once

#include "advise/guard_trial.hpp"
#include "compare/compare.hpp"

namespace rlslab {

struct AdviseOptions {
    double digits = 3;                                        ///< of every parameter, (2)
    double forgetting = 1;                                    ///< lambda
    std::vector<std::string> arithmetics{"float", "double"};  ///< tried in this order; the first that does is taken
    std::uint64_t seed = 1;                                   ///< of stochastic rounding, and of the orders of rows
    int threads = 0;                                          ///< 0: all cores; the results do not depend on it
};

/// One arithmetic, tried as `compare` does: all variants, checkpoints along the record, orders of its rows.
struct Tried {
    Comparison comparison;              ///< of the record as it was taken
    Vector<double> scaling;             ///< column i was taken times this power of two; empty: as it is
    double output_scaling = 1;          ///< likewise y
    double from_prior, from_data;       ///< digits that the prior, and rounding the data, leave of the worst parameter and of theta
    std::vector<Result const*> enough;  ///< variants that keep the digits, by preference (recommend.hpp)
    Result const* nearest;              ///< of those that never broke down the one that keeps the most; null: all broke down
};

/// Digits of the worst parameter that a variant keeps:
///   (1) along the record, in nine tenths of checkpoints and orders of rows, of the exact solution for the data and the prior as stored
///   (2) of the least-squares solution for the data as given: (1), but no more than the prior and the rounding of the data leave
double kept(Tried const& tried, Result const& result);

struct Advice {
    AdviseOptions options;
    ModelText model;
    std::vector<Tried> tried;         ///< where enough is empty in all of them, nothing does
    std::optional<GuardTrial> guard;  ///< around the chosen variant; absent where it cannot have one
    Tried const* chosen() const { return !tried.empty() && !tried.back().enough.empty() ? &tried.back() : nullptr; }
    Result const* choice() const { return chosen() ? tried.back().enough.front() : nullptr; }
};

/// For each arithmetic in turn, until one has a variant that keeps the digits:
///   (3) P0 is the default prior (default_prior.hpp) with c doubled until it leaves the digits, and a third of one more
///   (4) the columns as they are; if nothing keeps the digits and the arithmetic's range is in the way, each column and y times a power of
///       two that makes its root mean square about 1
///   (5) of the variants that keep the digits and never broke down the first by preference: factors, covariance forms, few operations
/// Throws InputError as `compare` does.
Advice advise(Records const& records, AdviseOptions const& options, Progress const& progress = {});

/// The advice as text, and as JSON.
std::string as_text(Advice const& advice, bool colour);
std::string as_json(Advice const& advice);

}  // namespace rlslab
