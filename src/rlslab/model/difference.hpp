// The difference equation of a model: simulation, prediction, poles and zeros.
#pragma once

#include <rlslab/model/regression.hpp>
#include <rlslab/model/signals.hpp>

#include <complex>

namespace rlslab {

/// Where a parameter stands in the equation: with -y[k-lag], with u_j[k-lag] of an input, or with 1.
struct EquationTerm {
    static constexpr int output = -1, constant = -2;
    int signal;   ///< j >= 0 of the input, or one of these
    int lag = 0;  ///< at least 1 of the output
};

/// y_k + a_1 y_{k-1} + ... + a_na y_{k-na} = sum_j (b_{j,0} u_{j,k-delay} + ... + b_{j,nb} u_{j,k-delay-nb}) + c +
/// xi_k.
struct DifferenceEquation {
    std::vector<double> a;               ///< a_1 ... a_na
    std::vector<std::vector<double>> b;  ///< one polynomial b_0 ... b_nb for each input
    int delay = 0;
    double c = 0;

    /// Parameter theta_i belongs to terms[i]; a coefficient without a term is 0. The delay is the shortest lag of any
    /// input, 0 without one. Throws std::invalid_argument unless there is a term for each parameter, of one of the
    /// inputs.
    static DifferenceEquation of(std::span<EquationTerm const> terms, Vector<double> const& theta, std::size_t inputs);
    /// The equation of a model, theta in the order of its regressors.
    static DifferenceEquation of(Arx const& model, Vector<double> const& theta);
};

/// y from rest, as many samples as xi has; sums in the order written. Throws std::invalid_argument unless the inputs
/// and xi are equally long.
Signal simulate(DifferenceEquation const& model, std::vector<Signal> const& inputs, Signal const& xi);
/// Without noise, from measured outputs instead of rest: the first `lead` numbers are those of y.
Signal simulate_from(DifferenceEquation const& model, std::vector<Signal> const& inputs, Signal const& y, Index lead);

/// The roots of z^n + p_1 z^{n-1} + ... + p_n for exactly these coefficients, the largest in magnitude first. Each part
/// is rounded from 256 bits. All are NaN if a coefficient is not finite.
std::vector<std::complex<double>> roots(std::vector<double> const& p);
/// The roots of the a-polynomial, and of the b-polynomial of one input without its leading zeros.
std::vector<std::complex<double>> poles(DifferenceEquation const& model);
std::vector<std::complex<double>> zeros(DifferenceEquation const& model, size_t input = 0);

}  // namespace rlslab
