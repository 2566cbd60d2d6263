// The prior that is taken where none is given: scaled to the data, exact in every arithmetic.
#pragma once

#include <rlslab/core/records.hpp>

namespace rlslab {

/// theta0 = 0 and P0 diagonal, in the units of the data:
///
///   (1)  P0_ii = (c / s_i)^2
///   (2)  s_i = rms(psi_i) rounded to a power of two; 1 for a column of zeros
///   (3)  c = the least power of two >= 32 such that |theta - theta_LS| <= 10^-3 |theta_LS|  in the norm |x|^2 = sum (s_i x_i)^2
///
/// theta is the minimiser with the prior after all rows, theta_LS without it, both certified. (3) holds for the forgetting factor given
/// and for none, so that a prior that has only been forgotten does not pass for a weak one, and c changes little with lambda.
/// In the norm of (3) the bias falls with c whatever the data, so the least c is found, not guessed.
///
/// P0 and its root are powers of two: exact in any arithmetic whose exponents reach them. A column multiplied by a power of two
/// changes s_i and the other numbers by exactly that power, and no digit of anything.
struct DefaultPrior {
    Vector<double> s;     ///< d
    double c;
    double bias;          ///< |theta - theta_LS| / |theta_LS| of (3), the larger of the two; NaN: the data do not determine theta
    bool reached;         ///< bias <= 10^-3; false also where c had to stop lest some P0_ii leave [2^-1000, 2^1000]

    Prior<double> prior() const;
};

/// `formula` says (1) to (3) in one line of text, for people.
inline constexpr char default_prior_formula[] = "P0_ii = (c / s_i)^2, s_i = rms of regressor i rounded to a power of two, c the least power of two that "
                                                "moves theta by at most 1e-3";

/// Cost: about twice to ten times that of `certified` for one step. Throws std::invalid_argument for data that are not finite.
DefaultPrior default_prior(Records const& records, double forgetting);

/// (2): the root mean square of each regressor, rounded to a power of two on a logarithmic scale.
Vector<double> regressor_scales(Records const& records);

}  // namespace rlslab
