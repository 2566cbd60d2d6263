// What a CertifiedSolution holds. Internal: includes arb.h.
#pragma once

#include <rlslab/reference/balls.hpp>
#include <rlslab/reference/certified.hpp>

#include <functional>

namespace rlslab {

struct CertifiedSolution::Enclosure {
    balls::BallMatrix theta;       ///< d x 1
    balls::BallMatrix covariance;  ///< d x d
    long bits;                     ///< working precision
    int digits;                    ///< that `certified` was called with
};

/// `certified`, where `pause` is called between pieces of the work: what it throws ends the computation. The longest
/// piece is the solution of the normal equations at one precision.
std::vector<CertifiedSolution> certified(Problem<double> const& problem, Records const& data,
                                         std::vector<Index> const& steps, int digits,
                                         std::function<void()> const& pause);

/// What `certified` promises of theta, and of P, read off the balls:
///   rad theta_i <= 10^-digits max(|theta_i|, 10^-40 max|theta|)      rad P_ij <= 10^-digits max|P|
/// May be false for an enclosure that is accurate enough, but less than twice as accurate.
bool theta_is_accurate(CertifiedSolution::Enclosure const& enclosure);
bool covariance_is_accurate(CertifiedSolution::Enclosure const& enclosure);

}  // namespace rlslab
