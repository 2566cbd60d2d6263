// The distributions that tests of hypotheses need. Each result is the double nearest to the exact number: the precision
// of Arb's balls rises until only one double is left.
#pragma once

namespace rlslab::correctly {

/// P(X > x) of chi-squared with `freedom` degrees of freedom, not necessarily whole. NaN unless freedom > 0.
double chi_squared_tail(double freedom, double x);

/// P(X > x) of Fisher's F with these degrees of freedom of its numerator and denominator. NaN unless both > 0.
double fisher_tail(double numerator, double denominator, double x);

/// t for which P(T <= t) = p of Student's distribution, 0 < p < 1. NaN unless freedom > 0 and p is in range.
double student_quantile(double freedom, double p);

}  // namespace rlslab::correctly
