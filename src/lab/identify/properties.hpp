// What a model does, as numbers with their uncertainty: roots, modes, responses, constancy.
#pragma once

#include <rlslab/model/signals.hpp>

#include <cmath>
#include <complex>
#include <optional>

namespace rlslab::identify {

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
};

}  // namespace rlslab::identify
