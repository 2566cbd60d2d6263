// Every variant in every arithmetic on one set of records, against the certified reference: what `rlslab compare` shows.
#pragma once

#include "progress.hpp"

#include <rlslab/erased.hpp>

#include <functional>
#include <string>
#include <vector>

namespace rlslab {

/// A prior that moves theta by more than this: which variant computes that theta best is then not the question.
inline constexpr double most_prior_bias = 0.01;

struct CompareOptions {
    double forgetting = 1;                      ///< lambda
    double p0 = 16384;                          ///< c^2 of P0 = c^2 I
    std::vector<std::string> variants = {};     ///< empty: all
    std::vector<std::string> arithmetics = {};  ///< empty: all
    std::uint64_t seed = 1;                     ///< of stochastic rounding
    int threads = 0;                            ///< 0: all cores; the results do not depend on it
    bool timings = true;                        ///< false: ns_per_update is left out
};

/// The first step at which P (as stored: decided exactly) was not positive definite, or something was not finite.
struct Breakdown {
    Index step;            ///< from 1; 0: the prior itself, as this arithmetic stores it
    std::string kind;      ///< "indefinite" or "nonfinite"
};

/// One row of the table. Digits are -log10 of a relative error, at most those the arithmetic has, negative when the
/// error exceeds the answer; absent when there is no finite answer or, for the arithmetic's rounded data, no reference.
struct Result {
    Entry const* entry;
    std::optional<double> theta_digits, theta_digits_worst, covariance_digits;
    std::optional<Breakdown> breakdown = {};
    std::optional<double> asymmetry = {};              ///< max |F_ij - F_ji| / max |F_ij| of what is stored; 0 for factors
    std::optional<long> operations = {};               ///< a row: the update, and theta where it is solved for on request
    std::optional<double> ns_per_update = {};
};

/// What storing the problem costs in an arithmetic shorter than binary64, before any variant computes with it.
struct Storage {
    std::string_view arithmetic;
    double forgetting;                       ///< lambda as stored
    Index rank;                              ///< exact, of the regressors as stored
    std::optional<double> theta_digits;      ///< of the exact theta for binary64 data, left in the exact theta for the stored
    double prior_bias;                       ///< of the stored problem; NaN when the prior alone makes it one
};

struct Recommendation {
    std::string arithmetic;
    std::string variant;    ///< empty: none
    std::string why;
};

struct Comparison {
    Index rows, skipped, size;
    std::vector<std::string> names;            ///< of the parameters
    std::vector<std::string> theta;            ///< the exact minimiser for the data as binary64, 30 digits
    double radius;                             ///< proven relative error of theta
    int bits;                                  ///< working precision at which it was certified
    double condition;                          ///< kappa_2 of the weighted data matrix
    double prior_bias;                         ///< |theta - theta without prior| / |theta without prior|
    CompareOptions options;                    ///< as asked for
    std::optional<double> better_p0;           ///< with it the bias is at most 1e-3; sought where it is above most_prior_bias
    std::vector<Storage> storage;
    std::vector<Result> results;
    std::vector<Recommendation> recommendations;
};

/// Throws InputError when the options name what does not exist, or the regressors are linearly dependent (exact rank).
Comparison compare(Records const& records, CompareOptions const& options, Progress const& progress = {});

/// The comparison for people (colour: ANSI codes), and for programs.
std::string as_table(Comparison const& comparison, bool colour);
std::string as_json(Comparison const& comparison);
std::string as_csv(Comparison const& comparison);

}  // namespace rlslab
