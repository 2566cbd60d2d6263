// From a record to a model: structure, parameters with their uncertainty, and checks of both.
#pragma once

#include <rlslab/catalogue/composition.hpp>
#include "identify/order.hpp"
#include "identify/tracking.hpp"
#include "report/progress.hpp"

#include <rlslab/catalogue/any_filter.hpp>
#include <rlslab/model/default_prior.hpp>
#include <rlslab/model/difference.hpp>
#include <rlslab/input/formats/open.hpp>
#include <rlslab/model/excitation.hpp>

#include <optional>

namespace rlslab::identify {

/// The structure is one of: the best order up to max_order, an order, na and nb, a list of regressors.
struct IdentifyOptions {
    std::vector<std::string> inputs = {};  ///< with a list of regressors: none
    std::string output = {};
    int order = 0, max_order = 0;  ///< order 0: chosen among 1 ... max_order; max_order 0: 10
    std::optional<int> na = {};
    std::vector<int> nb = {};                  ///< with na; one for all inputs, or one for each
    std::vector<int> delay = {};               ///< none: 0; one for all inputs, or one for each
    std::vector<std::string> regressors = {};  ///< as lagged_of takes them
    bool intercept = false;
    bool detrend = true;  ///< means of the fitted part are taken off first; what is left of a constant is estimated
    std::string variant = "ud";
    double forgetting = 1;
    std::optional<double> p0 = {};  ///< c^2 of P0 = c^2 I; none: scaled to the data
    double validate = 1.0 / 3;      ///< the last part of the record, not fitted
    double confidence = 0.95;
    Composition composition = {};  ///< around the variant, beside the model: Identified::tracked
};

/// A term of the equation: theta times -y[k-lag], u[k-lag] of an input, or 1.
struct Term {
    std::string name;  ///< of its parameter: a1, b0, b0[u2], c
    std::string of;    ///< what it stands with: y[k-1], u[k-3], 1
    int input, lag;    ///< input: -1 the output, -2 the constant
};

struct Parameter {
    std::string name, of;
    double value, sd, lower, upper;  ///< lower and upper: of the confidence interval; NaN where the variant gave no number
};

/// theta(k) on its way, with its band.
struct TrajectoryPoint {
    Index row;
    Vector<double> theta, sd;
};

/// When the variant's stored P was no longer positive definite, or something was no longer finite: after which row.
struct Failure {
    Index row;
    Health kind;  ///< indefinite or nonfinite
};

/// A pole and a zero (of every input) that the record cannot tell apart.
struct Cancellation {
    std::complex<double> pole, zero;  ///< the zero of the first input
    double distance, sd;              ///< |pole - zero|, and its standard deviation
};

/// What was found wrong with the record or the model, or what may make the model better.
struct Remark {
    /// The first makes all that follow doubtful, and so on down.
    enum class Rank { dependence, breakdown, outlier, excitation, arithmetic, delay, nothing, order, whiteness, held_out, structure };
    Rank rank;
    std::string sentence;
    std::string next;   ///< what to do first, options if there are any; empty: nothing
    bool hint = false;  ///< nothing is wrong
};

/// Residuals that follow past values of an input: they are not independent of it.
struct Followed {
    int input;
    Index lag;           ///< of the largest correlation
    double correlation;  ///< there
    double bound;        ///< 99 % bound of all lags of all inputs together
    Index begins;        ///< the first lag that counts with all lags to this one in the equation; this one where none does
};

/// A residual that is too large for its row to be like the others.
struct Outlier {
    Index row;  ///< of the record, from 1
    long line;  ///< of the file
    bool held_out;
    double deviations, share;  ///< in root mean squares of its part's residuals; of their sum of squares
};

struct Identified {
    std::string file;
    IdentifyOptions options;
    Index samples, fitted, held_out;  ///< rows of the model's equation that are fitted, samples of the part held out
    Index skipped;                    ///< rows of the equation that miss a value
    std::vector<double> means;        ///< taken off: of each input, then the output
    OrderChoice choice;               ///< of all orders, also where one was given; empty for another structure
    int order;                        ///< the longest lag of the output, or of an input past its delay
    std::vector<Term> terms;
    std::string structure, why;  ///< "order 4", "na = 2, nb = 3" ...
    double c;                    ///< of the prior, P0_ii = (c / s_i)^2
    std::vector<double> scales;  ///< s_i
    double prior_move;           ///< by the prior, of any parameter, in its standard deviations; NaN: not known
    std::vector<Parameter> parameters;
    std::optional<Failure> failure;
    DifferenceEquation model;  ///< empty where theta is not finite
    std::vector<std::complex<double>> poles;
    std::vector<std::vector<std::complex<double>>> zeros;
    std::vector<Cancellation> cancellations;
    std::vector<double> gain, gain_sd;                           ///< steady state, of each input; NaN: a pole at 1
    double sigma2, freedom, quantile;                            ///< quantile: Student's, of the interval
    bool noise_free;                                             ///< the least squares leave rounding alone
    double aic, bic, fpe;                                        ///< of the model as fitted, lambda = 1; else NaN
    double fit_one_step, held_out_one_step, held_out_simulated;  ///< percent; NaN: not known
    double fit_error = 0, held_out_error = 0;                    ///< one step ahead, root mean square; in the unit of y
    LjungBox ljung_box;                                          ///< of the residuals over the fitted rows
    Signal auto_correlation;                                     ///< r_0 = 1, r_1 ... of the residuals
    std::vector<Signal> cross_correlation;                       ///< of residuals and each input, lags 0 ...
    double bound;  ///< 99 % bound: a white residual's correlations exceed it with probability 0.01 each
    std::vector<Followed> followed;
    std::vector<Outlier> outliers;       ///< the largest of the fitted part, and of the part held out
    std::vector<Excitation> excitation;  ///< of each input over the fitted part
    double digits, digits_worst;         ///< the variant kept of the certified minimiser for its problem; NaN: none
    double condition;                    ///< of the fitted rows
    std::vector<TrajectoryPoint> trajectory;
    std::optional<Tracked> tracked;        ///< where there is a composition
    Signal measured, one_step, simulated;  ///< from the first row of the equation on, means put back; NaN: not known
    std::vector<Remark> remarks;           ///< warnings before hints, each by rank

    std::vector<std::string> warnings() const, hints() const;  ///< their sentences
    std::string next() const;                                  ///< of the first finding that has one; "" if none has
};

/// Rows of the equation that miss a value are skipped. Throws InputError for options or a record that do not make sense, and where
/// the regressors are linearly dependent: the message names the order that the input can support.
Identified identify(DataFile const& file, IdentifyOptions const& options, report::Progress const& progress = {});

std::string as_table(Identified const& model, size_t columns = 0);
std::string as_json(Identified const& model);
std::string as_page(Identified const& model);

}  // namespace rlslab::identify
