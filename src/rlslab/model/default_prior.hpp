// The default prior: scaled to the data, exact in every arithmetic.
#pragma once

#include <rlslab/core/records.hpp>

namespace rlslab {

/// theta0 = 0 and P0 diagonal, in the units of the data:
///
///   (1)  P0_ii = (c / s_i)^2
///   (2)  s_i = rms(psi_i) rounded to a power of two; 1 for a column of zeros
///   (3)  |theta - theta_LS| <= 10^-3 |theta_LS|  in the norm |x|^2 = sum (s_i x_i)^2
///   (4)  |theta_i - theta_LS,i| <= 10^-2 max(|theta_LS,i|, t |theta_LS| / s_i)  for each i, t = 2^-40, 2^-20 where
///     theta_LS,i = 0
///   (5)  c = the least power of two >= 32 for which (3) holds, doubled until (4) does
///
/// theta is the minimiser with the prior after all rows, theta_LS without it, both certified. (3) and (4) hold for the
/// given forgetting factor and for lambda = 1: otherwise a strong prior that is forgotten by the last row would pass,
/// and c would change much with lambda. In the norm of (3) the bias falls with c for any data, so that the least c can
/// be found. (4) protects each parameter: (3) alone would let the prior decide a parameter that adds little to the
/// prediction.
///
/// P0 and its root are powers of two: exact in any arithmetic with such exponents. If a column is multiplied by a power
/// of two, s_i and all other numbers change by powers of two exactly, and no digit changes.
struct DefaultPrior {
    Vector<double> s;  ///< d
    double c;
    double
        bias;  ///< |theta - theta_LS| / |theta_LS| of (3), the larger of the two; NaN: the data do not determine theta
    double worst;  ///< the same of (4), of the worst component
    bool reached;  ///< whether (3) and (4) hold; false also if c was stopped before some P0_ii left [2^-1000, 2^1000]

    Prior<double> prior() const;
};

/// (1) to (5) as one line of text.
inline constexpr char default_prior_formula[] =
    "P0_ii = (c / s_i)^2, s_i = rms of regressor i rounded to a power of two, c the least power of two from 32 "
    "on that moves theta by at most 1e-3 and each of its components by at most 1e-2";

/// The default prior of these records. Costs about twice to ten times as much as `certified` for one step. Throws
/// std::invalid_argument for data that are not finite.
DefaultPrior default_prior(Records const& records, double forgetting);

/// s (d) of (2): the root mean square of each regressor, rounded to a power of two on a logarithmic scale.
Vector<double> regressor_scales(Records const& records);

}  // namespace rlslab
