// From a record to a model: structure, parameters with their uncertainty, and checks of both.
#pragma once

#include <rlslab/catalogue/composition.hpp>
#include "src/lab/report/messages.hpp"
#include "src/lab/report/provenance.hpp"

#include <rlslab/catalogue/any_filter.hpp>
#include <rlslab/model/default_prior.hpp>
#include <rlslab/model/difference.hpp>
#include <rlslab/model/doubts.hpp>
#include <rlslab/input/formats/open.hpp>
#include <rlslab/model/excitation.hpp>
#include <rlslab/model/signals.hpp>

#include <cmath>
#include <complex>
#include <optional>

namespace rlslab::identify {

/// Residuals pass for white at this tail probability or above; an order improves on the one before below it.
inline constexpr double white_level = 0.01, improvement_level = 0.01;

/// J = sum of squared residuals of d parameters over N rows:
///   AIC = N ln(J/N) + 2 d      BIC = N ln(J/N) + d ln N      FPE = (J/N) (N + d)/(N - d)
struct Criteria {
    double aic, bic, fpe;
};

/// One order's fit, on the N rows that all orders share.
struct OrderFit {
    int order;
    Index parameters;      ///< d
    double J;              ///< sum of squared residuals
    double aic, bic, fpe;  ///< Criteria
    double p;              ///< F-test against the order before: the tail probability of its improvement
    double ljung_box;      ///< tail probability of Ljung and Box's Q of the residuals
    double held_out;       ///< percent of one-step fit on the held-out rows; NaN without such rows
};

/// The order that each criterion suggests, order 0 included, and the choice. Candidates are the orders from that of the
/// least BIC on, at least 1, whose residuals pass for white: the one of least BIC is chosen. Without a candidate it is
/// the least BIC from order 1 on. `why` names the case. Below the order of the least BIC residuals may pass only
/// because missing terms make them large.
struct OrderChoice {
    Index rows = 0;
    std::vector<OrderFit> fits = {};
    int aic = 0, bic = 0, fpe = 0, f_test = 0;  ///< f_test: the last order that improves on the one before
    double static_p = 1;                        ///< F-test of order 0 against the constant alone: the tail probability
    int order = 0;
    std::string why = {};
};

/// Ljung and Box: Q = N (N + 2) sum over tau = 1 ... lags of r_tau^2 / (N - tau), of N residuals after so many
/// parameters of past outputs were fitted; p is its tail probability, chi-squared with `freedom` = lags - fitted, 1 at
/// least. Where residuals are missing (NaN), N - tau counts complete pairs, and lags without a pair do not count.
struct LjungBox {
    double Q, p;
    Index lags, freedom;
    bool zeros = false;  ///< nothing but zeros: Q is 0 also where no residual meets another
    bool white() const { return p >= white_level; }
};

/// cov of (re, im) of a complex number: [rr ri; ri ii].
struct Spread {
    double rr = 0, ri = 0, ii = 0;
    double sd() const { return std::sqrt(rr + ii); }
};

/// A pole or a zero. first_order: its covariance, to first order in the errors of theta, is believable.
struct RootSpread {
    std::complex<double> value;
    Spread spread;
    bool first_order;
};

/// A number and its standard deviation, NaN: not known.
struct Uncertain {
    double value = NAN, sd = NAN;
};

/// A real pole, or a pair p = e^s, in samples; a Hertz number is natural_frequency over the sample time:
///
///   s = ln p = sigma + i omega,   |omega| <= pi
///   time_constant = -1/sigma      natural_frequency = |s| / (2 pi)      damping = -sigma / |s|
///
/// Standard deviations to first order: ds = dp/p. NaN: p = 0, which decays at once; a time constant for |p| >= 1; a
/// standard deviation where that of p is not first order.
struct Mode {
    std::complex<double> pole;
    Uncertain time_constant, natural_frequency, damping;
};

/// A curve and its interval. An unknown end is NaN, a lower end without bound is -infinity.
struct Band {
    Signal value, sd, lower, upper;
};

/// Of one input; unit step from k = 0 on.
struct InputResponse {
    Band step;                     ///< k = 0, 1, ...
    Band magnitude_db, phase_deg;  ///< at Validation::frequencies; sd of the phase in degrees, of the magnitude in dB
};

/// A path of a test of constancy and its lines at 5 %, numbers m of recursive residuals long.
struct ConstancyPath {
    Signal value, lower, upper;
    std::optional<Index> crosses = {};  ///< first number outside the lines at 5 %
    Index farthest = 0;                 ///< from the middle of the lines
    bool surely = false;                ///< it leaves the lines at 1 %, too
};

/// Whether one theta holds for all fitted rows. Empty: too few rows, or nothing is left beyond rounding.
struct Constancy {
    std::vector<Index> samples = {};  ///< k of each recursive residual
    Signal residuals = {};            ///< w
    ConstancyPath cusum = {}, squares = {};
    double c0 = NAN;  ///< half the distance of the lines of the squares, 5 %
    Index row(Index number) const { return samples[size_t(number)] + 1; }  ///< of the record, from 1
};

/// The structure is one of: the best order up to max_order, an order, na and nb, a list of regressors. Without an input
/// the model is y's own past: an order, or na.
struct IdentifyOptions {
    std::vector<std::string> inputs = {};  ///< with a list of regressors: none
    std::string output = {};
    int order = 0, max_order = 0;  ///< order 0: chosen among 1 ... max_order; max_order 0: 10
    std::optional<int> na = {};
    std::vector<int> nb = {};                  ///< with na; one for all inputs, or one for each
    std::vector<int> delay = {};               ///< none: 0; one for all inputs, or one for each
    std::vector<std::string> regressors = {};  ///< as lagged_of takes them
    bool intercept = false;
    bool detrend = true;  ///< subtract the means of the fitted part first, and estimate the remaining constant
    std::string variant = "ud";
    double forgetting = 1;
    std::optional<double> p0 = {};  ///< c^2 of P0 = c^2 I; nullopt: P0 is scaled to the data
    double validate = 1.0 / 3;      ///< the last part of the record, not fitted
    double confidence = 0.95;
    std::string time = {};  ///< column of times, in whose order the rows are taken (times.hpp); empty: the file's order
    std::optional<double> sample_time = {};  ///< seconds, 1e-15 to 1e15; nullopt: time is in samples
    Composition composition = {};            ///< around the variant, beside the model: Identified::tracked
    std::optional<int> noise_model = {};     ///< n of C = 1 + c1 q^-1 + ... + cn q^-n: Identified::noise_model
    std::optional<int> instruments = {};     ///< further past lags of each input: Identified::instruments
};

/// A term of the equation: theta times -y[k-lag], u[k-lag] of an input, or 1.
struct Term {
    std::string name;       ///< of its parameter: a1, b0, b0[u2], c
    std::string regressor;  ///< y[k-1], u[k-3], 1
    int input, lag;         ///< input: -1 the output, -2 the constant
};

struct Parameter {
    std::string name, regressor;
    double value, sd, lower, upper;  ///< lower, upper: of the confidence interval; NaN: the variant gave no number
    double p = NAN;                  ///< P(|T| >= |value| / sd), T of Student's distribution
};

/// theta(k) and its standard deviations at one row.
struct TrajectoryPoint {
    Index row;
    Vector<double> theta, sd;
};

/// The first row after which the variant's stored P was not positive definite, or a number was not finite.
struct Failure {
    Index row;
    Health kind;  ///< indefinite or nonfinite
};

/// A pole and a zero (of every input) that the record cannot distinguish.
struct Cancellation {
    std::complex<double> pole, zero;  ///< the zero of the first input
    double distance, sd;              ///< |pole - zero|, and its standard deviation
};

/// A warning about the record or the model, or a hint how to make the model better.
struct Remark {
    /// In order of importance: a remark makes all that follow it doubtful.
    enum class Rank {
        time,
        dependence,
        breakdown,
        outlier,
        excitation,
        arithmetic,
        delay,
        nothing,
        order,
        whiteness,
        constancy,
        held_out,
        structure
    };
    Rank rank;
    std::string sentence;
    std::string next;   ///< what to do first, as options if possible; empty: nothing
    bool hint = false;  ///< nothing is wrong
};

/// A correlation of the residuals with past values of an input that exceeds its bound.
struct PastInput {
    int input;
    Index lag;           ///< of the largest correlation
    double correlation;  ///< at this lag
    double bound;        ///< 99 % bound of all lags of all inputs together
    Index first_lag;     ///< first significant one with all up to `lag` in the equation; `lag`: none significant
};

/// The terms of the equation, and how they were chosen.
struct Structure {
    OrderChoice choice = {};  ///< of all orders, also if one was given; empty for a structure without an order
    int largest_order = 0;    ///< that could be chosen; 0: the structure was given
    int order = 0;            ///< the longest lag of the output, or of an input past its delay
    std::vector<Term> terms = {};
    std::string structure = {}, why = {};  ///< "order 4", "na = 2, nb = 3" ...
};

/// The variant's estimate, and its distance from the certified minimiser.
struct Estimate {
    double c = 0;                     ///< of the prior, P0_ii = (c / s_i)^2
    std::vector<double> scales = {};  ///< s_i
    double prior_effect = 0;  ///< largest move of a parameter by the prior, in its standard deviations; NaN: not known
    std::vector<Parameter> parameters = {};
    std::optional<Failure> failure = {};
    double sigma2 = 0, freedom = 0;
    double student = 0, quantile = 0;     ///< Student's degrees of freedom and its quantile, of the interval
    bool noise_free = false;              ///< the residuals of the least squares are rounding errors
    double digits = 0, digits_worst = 0;  ///< that the variant shares with the certified minimiser; NaN: none
    double condition = 0;                 ///< of the fitted rows
    std::vector<TrajectoryPoint> trajectory = {};
};

/// The model's properties, and its errors on both parts of the record. NaN and empty: theta is not finite, or unknown.
struct Validation {
    DifferenceEquation model = {};
    std::vector<std::complex<double>> poles = {};
    std::vector<std::vector<std::complex<double>>> zeros = {};
    std::vector<RootSpread> pole_spreads = {};               ///< in the order of the poles
    std::vector<std::vector<RootSpread>> zero_spreads = {};  ///< likewise
    std::vector<Mode> modes = {};
    std::vector<double> frequencies = {};       ///< of the responses, cycles per sample
    std::vector<InputResponse> responses = {};  ///< of each input
    Constancy constancy = {};                   ///< of the fitted rows
    std::vector<Cancellation> cancellations = {};
    std::vector<double> gain = {}, gain_sd = {};  ///< steady state, of each input; NaN: a pole at 1
    double fit_one_step = NAN, held_out_one_step = NAN, held_out_simulated = NAN;  ///< percent
    double fit_error = 0, held_out_error = 0;    ///< root mean square one step ahead, in the unit of y
    LjungBox ljung_box = {NAN, NAN, 0, 0};       ///< of the residuals over the fitted rows
    Signal auto_correlation = {};                ///< r_0 = 1, r_1 ... of the residuals
    std::vector<Signal> cross_correlation = {};  ///< of residuals and each input, lags 0 ...
    double bound = 0;  ///< 99 % bound: a white residual's correlations exceed it with probability 0.01 each
    std::vector<PastInput> past_inputs = {};
    std::vector<Outlier> outliers = {};   ///< the largest of the fitted part, and of the held-out part
    Signal measured = {}, one_step = {};  ///< with means, from the first row of the equation on
    /// Likewise; from the first outputs, and from those just before the held-out part; empty without an input.
    Signal simulated = {}, simulated_held_out = {};
};

struct TrackedRow {
    Index row;                ///< of the record, from 1
    double y, predicted, sd;  ///< prediction from the rows before, and its standard deviation; NaN: not known yet
    double noise_variance;    ///< after the row
    Vector<double> theta, theta_sd;  ///< after the row
    CompositionCounts happened;
};

/// The composition around a variant in double, over all rows: the fitted ones and those held out. Formulas: Assessed.
struct Tracked {
    std::string text;  ///< "window of 60 rows; guard reset"
    std::vector<TrackedRow> rows;
    double fit;        ///< of the predictions, percent, without the guard's outliers; NaN: not known
    double covered;    ///< share of the outputs within their interval
    double quantile;   ///< of the intervals: the normal distribution's
    Index broken = 0;  ///< first row after which the stored P was not positive definite, or a number not finite
    Health kind = Health::sound;  ///< what broke
    std::vector<std::string> warnings = {};
};

/// A parameter beside the model's least squares estimate; NaN: it has none.
struct CuredParameter {
    std::string name, regressor;
    double value, sd, least_squares;
    double shift() const { return (least_squares - value) / sd; }  ///< of least squares
};

/// The equation's parameters by a method that coloured noise does not bias (coloured.cpp).
struct Cured {
    bool of_noise = false;                        ///< by a model of the noise; else by instruments
    int order = 0;                                ///< of the noise; or the further lags of each input
    Index rows = 0;                               ///< fitted
    std::vector<CuredParameter> parameters = {};  ///< the equation's; then those of the noise
    double sigma2 = NAN;                          ///< variance of its residuals
    LjungBox ljung_box = {NAN, NAN, 0, 0};        ///< of its residuals
    double farthest = NAN;                        ///< max |C(e^iw) - 1| of the noise model
    Health health = Health::sound;                ///< the worst of all rows
};

struct Identified : Structure,
                    Estimate,
                    Criteria,
                    Validation {  ///< Criteria: of the model as fitted, lambda = 1; else NaN
    std::string file = {};
    std::string sha256 = {};  ///< of the file
    IdentifyOptions options = {};
    Index samples = 0, fitted = 0, held_out = 0;              ///< fitted: rows of the equation; held_out: samples
    Index skipped = 0;                                        ///< rows of the equation that miss a value
    std::vector<double> means = {};                           ///< subtracted from each input, then from the output
    std::vector<Excitation> excitation = {};                  ///< of each input over the fitted part
    std::optional<Tracked> tracked = {};                      ///< if a composition was given
    std::optional<Cured> noise_model = {}, instruments = {};  ///< if their options were given
    std::string cure = {};             ///< the options to try where residuals are not white; empty: none (cure_for)
    std::vector<Remark> remarks = {};  ///< warnings before hints, each by rank
    std::optional<report::Provenance> run = {};  ///< with it JSON and page say which run they are from

    std::vector<std::string> warnings() const, hints() const;  ///< their sentences
    std::string next() const;                                  ///< of the first remark that has one; "" if none has
};

/// The model of a record. Rows of the equation that miss a value are skipped. Throws InputError for options that
/// contradict one another, for a record that cannot be modelled, and for linearly dependent regressors: the message
/// names the order that the input supports.
Identified identify(DataFile const& file, IdentifyOptions const& options, report::Progress const& progress = {});

std::string as_table(Identified const& model, size_t columns = 0);
std::string as_json(Identified const& model);
std::string as_page(Identified const& model);
/// A line for each row: row, y, predicted, sd, noise_variance, each theta and its standard deviation, and the events.
std::string tracked_csv(Tracked const& tracked, std::vector<std::string> const& names);

}  // namespace rlslab::identify
