// The laws of docs/theory.md 107 to 110: what rounding leaves of theta and P in each family of forms, and where a form
// that stores P loses definiteness.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rlslab::studies {

/// Rows psi = V diag(sigma) w, w white of variance 1, sigma_1 = 1; y = psi'theta + noise v, |theta| = 1; P0 = c2 I.
struct MapCell {
    int bits;       ///< of the significand: u = 2^-bits
    double lambda;  ///< as the word stores it
    double rows;    ///< N at which the errors are read
    double c2;      ///< prior variance
    double noise;   ///< its deviation
    std::vector<double> sigma;
    bool rotated;       ///< V is a rotation; otherwise the columns have the units sigma
    std::string theta;  ///< "generic", "v_1", "v_d": its direction
    double u() const;
};

/// Relative errors; broken: P is no longer definite.
struct MapLaw {
    double theta, covariance;
    bool broken = false;
};
/// As registered before the run, or as corrected after it (items 107 to 110 say how).
enum class Laws { registered, corrected };
MapLaw law_of(std::string_view form, MapCell const& at, Laws laws = Laws::registered);

/// "stored": P in a form that subtracts; "joseph"; "factor"; "delta": of item 91; "information".
std::string_view family_in_map(std::string_view form);

}  // namespace rlslab::studies
