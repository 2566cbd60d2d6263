// The model's modes, step responses and frequency responses, with intervals.
#pragma once

#include "src/lab/identify/estimate.hpp"

namespace rlslab::identify {

/// The mode of each pole with imag >= 0.
std::vector<Mode> modes_of(std::vector<RootSpread> const& poles);

/// Where responses are drawn: samples until the slowest pole has fallen to 1 %, or grown a hundredfold, 20 to 1000;
/// frequencies in cycles per sample from a twentieth of the slowest pole's corner to 1/2, evenly in their logarithm,
/// and the angles of poles and zeros.
Index response_length(std::vector<std::complex<double>> const& poles, std::vector<Term> const& terms);
std::vector<double> response_frequencies(std::vector<std::complex<double>> const& poles,
                                         std::vector<std::vector<std::complex<double>>> const& zeros);

/// Intervals by the delta method: with x's gradient g by theta (response.hpp) and C = cov theta, t the quantile,
///
///   (1) step        var g_k = g' C g                     g_k +- t sd
///   (2) magnitude   d|G| = Re(conj(G) dG) / |G|          20 log10(|G| +- t sd)
///   (3) phase       d arg G = Im(conj(G) dG) / |G|^2     arg G +- t sd
///
/// Where 0 is within t standard deviations of G, the phase has no interval, and the magnitude no lower end. Each
/// interval is for itself, not for the whole curve. Cost n d^2.
InputResponse response_of(DifferenceEquation const& model, std::vector<Term> const& terms, Vector<double> const& theta,
                          Uncertainty const& uncertainty, size_t input, double quantile, Index length,
                          std::vector<double> const& frequencies);

/// The ellipse about a complex root that covers it with this probability, as (re, im) of points; of a real root the two
/// ends of its interval. q = (x - p)' S^-1 (x - p) is 2 F with (2, nu) degrees of freedom: nu ((1 - confidence)^(-2/nu)
/// - 1) at its quantile. Empty where the first order does not hold. Source: derived (F's tail with 2 degrees of freedom
/// is a power).
std::vector<std::complex<double>> region_of(RootSpread const& root, double confidence, double quantile, double freedom);

}  // namespace rlslab::identify
