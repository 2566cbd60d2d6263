// From a record to a model: order, parameters with their uncertainty, and every check of whether to believe them.
#pragma once

#include "order.hpp"
#include "progress.hpp"

#include <rlslab/erased.hpp>
#include <rlslab/model/difference.hpp>
#include <rlslab/model/excitation.hpp>

#include <optional>

namespace rlslab {

struct IdentifyOptions {
    std::vector<std::string> inputs;
    std::string output;
    int order = 0, max_order = 10;             ///< order 0: chosen among 1 ... max_order
    int delay = 0;
    bool intercept = false;
    bool detrend = true;                       ///< means of the fitted part are taken off first; what is left of a constant is estimated
    std::string variant = "ud";
    double forgetting = 1;
    double p0 = 0x1p40;                        ///< no bias to speak of, and ud does not mind its size (study prior_size)
    double validate = 1.0 / 3;                 ///< the last part of the record, not fitted
    double confidence = 0.95;
};

struct Parameter {
    std::string name;
    double value, sd, low, high;
};

/// theta(k) on its way, with its band.
struct TrajectoryPoint {
    Index row;
    Vector<double> theta, sd;
};

struct Identified {
    std::string file;
    IdentifyOptions options;
    Index samples, fitted, held_out;           ///< rows of the model's equation besides samples
    std::vector<double> means;                 ///< taken off: of each input, then the output
    OrderChoice choice;                        ///< of all orders, also where one was given
    int order;
    std::string why;
    std::vector<Parameter> parameters;
    DifferenceEquation model;
    std::vector<std::complex<double>> poles;
    std::vector<std::vector<std::complex<double>>> zeros;
    double sigma2, quantile;                   ///< quantile: Student's, of the interval
    double fit_one_step, held_out_one_step, held_out_simulated;    ///< percent
    double whiteness;                          ///< tail probability of the residuals' Q
    Signal auto_correlation;                   ///< r_0 = 1, r_1 ... of the residuals
    std::vector<Signal> cross_correlation;     ///< of residuals and each input, lags 0 ...
    double bound;                              ///< that 99 % of a white residual's correlations keep
    std::vector<Excitation> excitation;        ///< of each input over the fitted part
    double digits, digits_worst;               ///< the variant kept of the certified minimiser for its problem
    double condition;                          ///< of the fitted rows
    std::vector<TrajectoryPoint> trajectory;
    Signal measured, one_step, simulated;      ///< from the first row of the equation on, means put back
    std::vector<std::string> warnings;
};

/// The record's columns must have no missing values. Throws InputError for options or a record that do not make sense, and where
/// the regressors are linearly dependent: the message names the order that the input can support.
Identified identify(std::string const& file, IdentifyOptions const& options, Progress const& progress = {});

std::string as_table(Identified const& model);
std::string as_json(Identified const& model);
std::string as_page(Identified const& model);

}  // namespace rlslab
