// What compare names of a record of a random problem, and what a form loses on another record.
#pragma once

#include "src/lab/compare/answer.hpp"
#include "studies/published/drawn_problem.hpp"

#include <rlslab/studies/judgements.hpp>

#include <cmath>

namespace rlslab::studies::naming {

using compare::Comparison;

/// The forms that compare may name (dense, a row at a time), in the problem's word, by its lambda and prior. `orders`:
/// the seed of the orders of rows. Nothing where the rows do not determine theta.
std::optional<Comparison> compared(Records const& records, DrawnProblem const& problem, std::uint64_t orders);

/// "none" where compare names none.
std::string named_in(std::optional<Comparison> const& comparison);

/// The losses of the forms, infinite for those that broke down. They point into the comparison.
struct Losses {
    std::vector<compare::Result const*> sound;
    double least = INFINITY;

    explicit Losses(Comparison const& comparison);
    double of(std::string const& variant) const;
};

/// Whether the rows, so forgotten, determine theta: compare refuses those that do not.
bool determine_theta(Records const& records, double forgetting);

/// In parts of a digit, without the rounding of a difference.
inline double in_parts(double digits, int of_a_digit) { return std::round(of_a_digit * digits) / of_a_digit + 0.0; }
inline double in_tenths(double digits) { return in_parts(digits, 10); }

/// Of the rows, the share for which it holds; estimated over the values of a factor.
Statistic share(std::string column, bool (*holds)(double), std::string const& over = "problem",
                Estimate estimate = Estimate::share);
inline bool is_half_a_digit(double loss) { return loss <= 0.5; }
inline bool is_a_digit(double loss) { return loss <= 1; }
inline bool is_infinite(double loss) { return loss == INFINITY; }
inline bool is_one(double x) { return x == 1; }
/// By how much more often what compare names is within half a digit than this form always, over the problems.
Statistic more_often_than(std::string form);
/// `within`, undecided without rows: some kinds of problems are rare.
Judge in_band(Selection const& rows, Statistic const& of, double from, double to,
              std::vector<std::string> const& by = {});

}  // namespace rlslab::studies::naming
