// The columns of a record as the model uses them, and which terms the equation has: from an order, from na, nb and
// delay, or from a list of regressors.
#pragma once

#include "src/lab/identify/identify.hpp"

#include <rlslab/model/fit.hpp>

namespace rlslab::identify {

using report::refuse;

/// The inputs and the output less their means; NaN: a missing value.
struct Record {
    std::string file;         ///< printable
    std::string sha256 = {};  ///< of the file
    std::vector<Signal> inputs = {};
    Signal y = {};
    std::vector<Signal> inputs_with_means = {};  ///< whose numbers show their resolution
    std::vector<double> means = {};              ///< subtracted from each input, then from the output
    std::vector<double> resolutions = {};        ///< of each input, then of the output
    std::vector<long> lines = {};                ///< of the file
    std::vector<std::string> warnings = {};      ///< of inputs that count upwards
    std::string of_times = {}, time = {};        ///< what a column of times says, and its name; empty: nothing
    Index samples = 0, fitted = 0;               ///< the first `fitted` samples are fitted, the others held out
};

/// Throws InputError for a record that cannot be read, a column that does not change, too few samples for the widest
/// structure of the options, and numbers that are too small.
Record read_record(DataFile const& file, IdentifyOptions const& options);

/// Samples first ... end - 1; a missing one is 0, the mean.
Signal zero_filled(Signal const& x, Index first, Index end);
/// The longest run without a missing value among the first `count` samples.
Signal longest_run(Signal const& x, Index count);

/// The options with all inputs, a delay for each, and max_order. Throws InputError where options contradict each other.
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

/// y[k] = psi' theta: one row for each sample from the longest lag on, without rows that miss a value (NaN).
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

/// Those of this J, of d parameters over N rows.
Criteria criteria(double J, Index N, Index d);

/// The columns of an ARX model in the order of its recursion, for all orders at once on the same rows (the presample of
/// the largest): X = u_k (each input), 1 if there is an intercept, then -y_{k-1}, u_{k-1} (each input), ...,
/// -y_{k-most}, u_{k-most}; each input later by its delay. Rows in which a value is missing (NaN) are left out.
struct OrderColumns {
    Matrix<double> X;
    Vector<double> y;
    int inputs;
    bool intercept;
    std::vector<Index> samples = {};  ///< k of each row
    /// Columns of order n.
    Index columns(int order) const { return inputs + intercept + Index(order) * (1 + inputs); }
};
OrderColumns order_columns(std::vector<Signal> const& inputs, Signal const& y, int most, std::vector<int> const& delay,
                           bool intercept);

/// Orders 0 ... most by appended columns of a QR factorisation, up to the first whose columns depend on one another;
/// the last held_out rows are not fitted.
/// Source: Söderström & Stoica 1989, 11.5; Ljung & Box 1978.
OrderChoice choose_order(OrderColumns const& columns, int most, Index held_out);

/// Number of lags of the whiteness test for an order.
Index ljung_box_lags(Index rows, int order);
/// Largest J that rounding alone causes, for this number of rows with outputs up to y.
double rounding_alone(Index rows, double y);
/// Nothing but zeros: Q = 0, p = 1. Infinite residuals, or none: NaN. std::invalid_argument unless 1 <= lags < N.
LjungBox ljung_box(Vector<double> const& residuals, Index lags, Index fitted);

}  // namespace rlslab::identify
