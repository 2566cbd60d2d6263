// Division of many numbers by one that is near 1, such as sqrt(lambda).
#pragma once

#include <rlslab/core/complex.hpp>

#include <tuple>

namespace rlslab {

/// x / r for 1/2 <= r <= 1, computed as x + x c with c = (1 - r) / r: no division in the loop. 1 - r is exact there, so
/// that the error of c adds at most about (1 - r) / r units in the last place. The product of x with the rounded 1 / r
/// would repeat one and the same error at every step, which sums to u / (1 - r) in a stationary filter. r = 1 leaves x
/// as it is. For r < 1/2 the result is x / r to a few u.
template <Field T>
class DivisorNearOne {
    T correction_;

public:
    explicit DivisorNearOne(T const& r) : correction_((T(1) - r) / r) {}
    T operator()(T const& x) const { return x + x * correction_; }
    template <ComplexScalar C>
        requires std::same_as<RealOf<C>, T>
    C operator()(C const& x) const {
        return x + x * correction_;
    }
    T const& correction() const { return correction_; }
    static auto state(auto& divisor) { return std::tie(divisor.correction_); }
};

}  // namespace rlslab
