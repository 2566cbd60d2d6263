// What keeps the wanted digits on a record: arithmetic, scaling, prior, variant and guard, tried on the record itself.
#pragma once

#include "advise/guard_trial.hpp"
#include "compare/compare.hpp"
#include "report/progress.hpp"

namespace rlslab::compare {

struct AdviseOptions {
    double digits = 3;                                        ///< of every parameter, (1) and (2)
    double forgetting = 1;                                    ///< lambda
    std::vector<std::string> arithmetics{"float", "double"};  ///< tried in this order; the first that does is taken
    std::uint64_t seed = 1;                                   ///< of stochastic rounding, and of the orders of rows
    int threads = 0;                                          ///< 0: all cores; the results do not depend on it
};

/// The digits of the worst parameter that a variant keeps in an arithmetic:
///   (1) along   what nine tenths of the counts reach: at checkpoints along each run, of the exact solution there for the prior and the
///               data as stored, as `compare` counts them
///   (2) at_end  after the last row, of the least-squares solution for the data as given: the least of all runs. Prior and rounding of the
///               data are in it
/// A run is an order of the rows, or a draw of the rounding. A parameter whose least-squares value is zero has no digits and is left
/// out of (2).
struct Kept {
    Result const* result;
    double along, at_end;
    double both() const { return std::min(along, at_end); }
};

/// One arithmetic, tried. Moves, for results are pointed at.
struct Tried {
    Tried() = default;
    Tried(Tried&&) = default;
    Tried& operator=(Tried&&) = default;

    std::string arithmetic;
    std::vector<int> exponents;  ///< regressor i was taken times 2^exponents[i]; empty: the columns as they are
    int output_exponent = 0;     ///< likewise y
    std::vector<bool> is_zero;   ///< parameters whose least-squares value is zero: below 1e-38 of the largest in units of the regressors
    Comparison comparison{};     ///< of the columns as they were taken
    bool in_range = true;        ///< whether the stored prior and lambda are positive and finite there
    std::vector<Kept> sound;     ///< the variants that never broke down, by preference (recommend.hpp)
    double wanted = 0;           ///< digits

    Kept const* first_enough() const;  ///< the first that keeps what is wanted, or null
    Kept const* most() const;          ///< the one that keeps the most, or null
};

struct Advice {
    AdviseOptions options;
    std::vector<Tried> tried;         ///< the last one is the one that keeps the digits, if any does
    std::optional<GuardTrial> guard;  ///< around the chosen variant; absent where it cannot have one
    Tried const* chosen() const { return !tried.empty() && tried.back().first_enough() ? &tried.back() : nullptr; }
    Kept const* choice() const { return chosen() ? tried.back().first_enough() : nullptr; }
};

/// For each arithmetic in turn, until one has a variant that keeps the digits:
///   (3) the columns as they are; or, if the largest number of a column or of y has an exponent beyond -e/4 ... e/4, e the arithmetic's
///       largest, each column and y times the power of two that makes its largest number at least 1 and less than 2
///   (4) P0 is the default prior (default_prior.hpp) with c doubled until at the last row it leaves 0.3 digits more than are wanted, or
///       than the arithmetic has, or P0 would leave its range
///   (5) of the variants that keep the digits and never broke down the first by preference: factors, covariance forms, few operations
/// Throws InputError as `compare` does, and for an arithmetic that is not known or named twice.
Advice advise(Records const& records, AdviseOptions const& options, report::Progress const& progress = {});

/// The advice as text, and as JSON.
std::string as_text(Advice const& advice, bool colour, size_t columns = 0);
std::string as_json(Advice const& advice);

}  // namespace rlslab::compare
