// The step response and the frequency response of a difference equation, with their derivatives by its parameters.
#pragma once

#include <rlslab/model/difference.hpp>

namespace rlslab {

/// Numbers of a model along time or frequency, and their derivatives.
template <class T>
struct Response {
    std::vector<T> value;               ///< n
    Eigen::Matrix<T, -1, -1> gradient;  ///< d x n: column k is d value_k / d theta
};

/// The output for u = 1 from k = 0 on, from rest, without constant and noise, of one input; the other inputs are 0.
/// theta_i = a_l stands with -y[k-l], theta_i = b_l with u[k-l]:
///
///   (1) h_k = 1 - sum_l a_l h_{k-l}                 h = 0 for k < 0: the step response of 1/A
///   (2) g_k = sum_l b_l h_{k-l}
///   (3) v_k = -g_k - sum_l a_l v_{k-l}              v = 0 for k < 0
///   (4) dg_k/db_l = h_{k-l},   dg_k/da_l = v_{k-l}
///
/// (4): dg/da_l obeys A dg/da_l = -q^-l g, and dg/db_l obeys A dg/db_l = q^-l u, the equation of g with another right
/// side; its solutions are one another's shifts. So d derivatives of n numbers cost n d, not n d na. Sums run in the
/// order of the terms. A response that grows beyond binary64 is infinite, then NaN. Throws std::invalid_argument unless
/// there is a term for each parameter and 0 <= input. Cost n d. Source: derived.
Response<double> step_response(std::span<EquationTerm const> terms, Vector<double> const& theta, int input,
                               Index count);

/// The transfer function of one input at frequencies f in cycles per sample, z = e^(2 pi i f):
///
///   (1) A = 1 + sum_l a_l z^-l,   B = sum_l b_l z^-l,   G = B/A
///   (2) dG/db_l = z^-l / A,   dG/da_l = -G z^-l / A
///
/// NaN where A = 0. Exceptions as above. Cost n d, and a sine and a cosine for each term. Source: derived.
Response<std::complex<double>> frequency_response(std::span<EquationTerm const> terms, Vector<double> const& theta,
                                                  int input, std::vector<double> const& frequencies);

/// arg G along the frequencies in radians, without jumps: the angles of the factors z - z_i of B and of A are
/// continuous in f, and their sum says which multiple of 2 pi arg G lacks, however far apart the frequencies are:
///
///   arg G = arg b - 2 pi f lag + sum over zeros of phi(z_i) - sum over poles of phi(p_i)
///   phi(r) = arg(1 - r/z) if |r| < 1,   otherwise arg(-r) - 2 pi f + arg(1 - z/r)
///
/// b and lag: of the first term of B that is not 0. A multiple of 2 pi is added to all, so that the phase at f = 0 is
/// in (-pi, pi]. NaN if there is no such term. A root on the unit circle makes a jump of pi: none of the formula's, the
/// phase has it. Source: derived.
Signal continuous_phase(DifferenceEquation const& model, size_t input, std::vector<double> const& frequencies,
                        std::vector<std::complex<double>> const& G);

}  // namespace rlslab
