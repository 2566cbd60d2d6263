// The data with which every row is timed and scored: made once, the same bits for every variant, arithmetic and peer.
#pragma once

#include <rlslab/core/records.hpp>
#include <rlslab/reference/certified.hpp>

namespace rlslab::bench {

/// One problem and its data. Every number in it is a float, so that float and double solve the same problem and are
/// compared with the same certified solution.
struct Scenario {
    Problem<double> problem;
    Records records;
    Index scored;             ///< theta is scored after this many rows; those that follow are for timing
    CertifiedSolution exact;  ///< the certified solution there
};

/// The filters' scenario: a transversal filter of d taps fed with white noise, psi_k = (x_k, x_{k-1}, ..., x_{k-d+1}),
/// x = 0 before the first row. lambda = 0.99 and P0 = 10 I, for liquid-dsp takes a delay line and has that P0 built in.
Scenario const& tapped_delay_line(Index size);

/// A window over the same rows: its solution is that of the last window_rows(size) of the scored rows, and of the
/// prior, whose weight the rows before them have taken to variance 10 / lambda^20.
Scenario const& window_of_delay_line(Index size);
inline Index window_rows(Index size) { return 2 * size + 80; }
/// The rows that this window holds, as a record with the prior of all scenarios: what factoring them anew has to give.
Scenario const& rows_of_window(Index size);

/// The batches' scenario: the same regressors, so many rows, lambda = 1, no prior; all rows are scored.
Scenario const& batch(Index rows, Index size);

/// How many rows a filter is timed on before it is put back to where it was scored: few enough that the textbook forms
/// stay finite and the data stay in L1, enough that reading the clock does not show.
Index stretch_rows(Index size);

/// The digits of an answer, at most those its arithmetic has; 0 when it is not finite.
double digits(CertifiedSolution const& exact, Vector<double> const& theta, int arithmetic_bits);

}  // namespace rlslab::bench
