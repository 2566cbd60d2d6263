// What a certified Exact holds. Internal: includes arb.h.
#pragma once

#include <rlslab/reference/balls.hpp>
#include <rlslab/reference/certified.hpp>

namespace rlslab {

struct Exact::Enclosure {
    balls::BallMatrix theta;         ///< d x 1
    balls::BallMatrix covariance;    ///< d x d
    long bits;                       ///< working precision
    int digits;                      ///< asked for
};

}  // namespace rlslab
