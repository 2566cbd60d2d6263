// Which terms the equation has: from an order, from na, nb and delay, or from a list of regressors.
#pragma once

#include "identify/identify.hpp"

namespace rlslab::identify {

/// The options complete: inputs and a delay for each, max_order set. Throws InputError for options that do not go together.
IdentifyOptions completed(IdentifyOptions options);

/// Whether options name one structure, so that no order is chosen.
bool structure_given(IdentifyOptions const& options);

/// The terms of an order; of the structure given where order is 0. Outputs first, then each input, then the constant.
std::vector<Term> terms_of(IdentifyOptions const& options, int order);
/// "order 4", "na = 2, nb = 3, delay 1", "4 regressors".
std::string structure_text(IdentifyOptions const& options, int order);

Index presample(std::vector<Term> const& terms);
/// The longest lag of the output, and of any input past its delay.
int order_of(std::vector<Term> const& terms, std::vector<int> const& delay);
Index past_outputs(std::vector<Term> const& terms);

/// y[k] = psi' theta, one row for each sample from the longest lag on that misses no value (NaN).
struct Rows {
    Records records;
    std::vector<Index> samples;  ///< k of each row
    /// The rows before this sample.
    Rows before(Index sample) const;
};
Rows rows_of(std::vector<Term> const& terms, std::vector<Signal> const& inputs, Signal const& y);

/// "y[k] + a1 y[k-1] + ... + a4 y[k-4] = b0 u[k] + ... + b4 u[k-4] + c + e[k]".
std::string equation_text(std::vector<Term> const& terms, std::string const& output);

/// The equation with numbers; its delay is the shortest lag of any input.
DifferenceEquation equation_of(std::vector<Term> const& terms, Vector<double> const& theta, size_t inputs);

}  // namespace rlslab::identify
