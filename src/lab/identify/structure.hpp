// Which terms the equation has: from an order, from na, nb and delay, or from a list of regressors.
#pragma once

#include "src/lab/identify/identify.hpp"

namespace rlslab::identify {

struct Record;

/// The options with all inputs, a delay for each, and max_order. Throws InputError for options that contradict one
/// another.
IdentifyOptions completed(IdentifyOptions options);

/// Whether the options name one structure. Otherwise an order is chosen.
bool structure_given(IdentifyOptions const& options);
/// The largest order to choose from; 0 if the structure is given.
int widest_order(IdentifyOptions const& options);

/// The structure that the options give, or that of the order which choose_order chooses up to `supported`. Throws
/// InputError if too few rows miss no value, or if the columns of order 1 are linearly dependent.
Structure choose_structure(Record const& record, IdentifyOptions const& options, Index supported);

/// The terms of an order, or of the given structure if `order` is 0: outputs first, then each input, then the constant.
std::vector<Term> terms_of(IdentifyOptions const& options, int order);
/// "order 4", "na = 2, nb = 3, delay 1", "4 regressors".
std::string structure_text(IdentifyOptions const& options, int order);

Index presample(std::vector<Term> const& terms);
/// The longest lag of the output, and of any input past its delay.
int order_of(std::vector<Term> const& terms, std::vector<int> const& delay);
/// The shortest lag of an input; 0 if it has no term.
int delay_of(std::vector<Term> const& terms, int input);
Index past_outputs(std::vector<Term> const& terms);

/// y[k] = psi' theta: one row for each sample from the longest lag on, without the rows in which a value is missing
/// (NaN).
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
