// The prior that is taken where none is given: scaled to the data, exact in every arithmetic.
#pragma once

#include <rlslab/core/records.hpp>

namespace rlslab {

/// theta0 = 0 and P0 diagonal, in the units of the data:
///
///   (1)  P0_ii = (c / s_i)^2
///   (2)  s_i = rms(psi_i) rounded to a power of two; 1 for a column of zeros
///   (3)  |theta - theta_LS| <= 10^-3 |theta_LS|  in the norm |x|^2 = sum (s_i x_i)^2
///   (4)  |theta_i - theta_LS,i| <= 10^-2 max(|theta_LS,i|, 2^-20 |theta_LS| / s_i)  for each i
///   (5)  c = the least power of two >= 32 for which (3) holds, doubled until (4) does
///
/// theta is the minimiser with the prior after all rows, theta_LS without it, both certified. (3) and (4) hold for the forgetting factor
/// given and for none, so that a prior that has only been forgotten does not pass for a weak one, and c changes little with lambda.
/// In the norm of (3) the bias falls with c whatever the data, so the least c is found, not guessed. (4) keeps each parameter, where (3)
/// alone would let the prior decide one that adds little to the prediction.
///
/// P0 and its root are powers of two: exact in any arithmetic whose exponents reach them. A column multiplied by a power of two
/// changes s_i and the other numbers by exactly that power, and no digit of anything.
struct DefaultPrior {
    Vector<double> s;  ///< d
    double c;
    double bias;   ///< |theta - theta_LS| / |theta_LS| of (3), the larger of the two; NaN: the data do not determine theta
    double worst;  ///< the same of (4), of the worst component
    bool reached;  ///< (3) and (4); false also where c had to stop lest some P0_ii leave [2^-1000, 2^1000]

    Prior<double> prior() const;
};

/// (1) to (5) in one line of text, for people.
inline constexpr char default_prior_formula[] =
    "P0_ii = (c / s_i)^2, s_i = rms of regressor i rounded to a power of two, c the least power of two from 32 "
    "on that moves theta by at most 1e-3 and each of its components by at most 1e-2";

/// Cost: about twice to ten times that of `certified` for one step. Throws std::invalid_argument for data that are not finite.
DefaultPrior default_prior(Records const& records, double forgetting);

/// (2): the root mean square of each regressor, rounded to a power of two on a logarithmic scale.
Vector<double> regressor_scales(Records const& records);

}  // namespace rlslab
