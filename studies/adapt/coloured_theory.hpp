// Random systems in coloured noise, and what theory says of their estimates, from their impulse responses.
#pragma once

#include <rlslab/core/matrices.hpp>
#include <rlslab/core/random.hpp>

#include <array>
#include <string_view>

namespace rlslab::studies::coloured {

constexpr Index na = 2, nb = 3, nc = 2, d = na + nb, instruments = 8;

/// y_k + a_1 y_{k-1} + a_2 y_{k-2} = b_0 u_k + b_1 u_{k-1} + b_2 u_{k-2} + sigma (e_k + c_1 e_{k-1} + c_2 e_{k-2}),
/// u_k = pole u_{k-1} + white, of variance 1; e white of variance 1.
struct System {
    std::array<double, 2> a, c;
    std::array<double, 3> b;
    double pole, sigma;
    /// a, b, c.
    std::array<double, d + nc> theta() const { return {a[0], a[1], b[0], b[1], b[2], c[0], c[1]}; }
};

/// C of a name: "white" 1, "positive real" 1 + 0.3 q^-1 + 0.1 q^-2, "not positive real" 1 + 1.5 q^-1 + 0.75 q^-2:
/// whether 1/C - 1/2 is (docs/theory.md 89).
std::array<double, 2> colour(std::string_view name);
/// System `number` in noise of this colour: poles below 0.8, the noise's share of y of a quarter of the input's
/// variance, a white input where the number is odd, of pole 0.7 where it is even. Drawn again while an instrument is
/// weak: where the variance of a_i by instruments is above 5/N in noise of any of the colours.
System system_of(int number, std::string_view colour, Seed seed);

/// Of a, b (and c, for extended least squares): asymptotic biases, and variances times N.
struct Theory {
    Vector<double> least_squares_bias;  ///< R^-1 E psi v
    Vector<double> extended;            ///< diagonal of Sigma, docs/theory.md 89; NaN where it does not exist
    Vector<double> by_instruments;      ///< Q^-1 Pi' S_v Pi Q^-1, docs/theory.md 90
    Vector<double> plain;               ///< the same with S_v + S_{w'theta}
    /// N times the first-order bias by instruments.
    Vector<double> instruments_bias(double rows) const;
    Vector<double> at_first, with_log;  ///< its parts
};
Theory theory_of(System const& system);

}  // namespace rlslab::studies::coloured
