// The second moments of the known system's regressors, from its own responses.
#include "studies/theory/second_order.hpp"

#include <rlslab/arithmetic/multiprecision.hpp>

#include <algorithm>
#include <vector>

namespace rlslab::studies::second_order {

Matrix<Reference> second_moments(System const& system) {
    Index const d = system.size();
    if (!system.recursive) return Matrix<Reference>::Identity(d, d);
    auto const theta = system.theta();
    constexpr size_t terms = 400;
    std::vector<Reference> g(terms), h(terms);  // responses of y
    for (size_t k = 0; k < terms; ++k) {
        auto const fed_back = [&](std::vector<Reference> const& r) {
            Reference sum = 0;
            for (size_t i = 1; i <= std::min<size_t>(k, 2); ++i) sum -= Reference(theta[i - 1]) * r[k - i];
            return sum;
        };
        g[k] = fed_back(g) + (k < 3 ? Reference(theta[2 + k]) : Reference(0));
        h[k] = fed_back(h) + (k == 0 ? Reference(sigma) : Reference(0));
    }
    // psi = (-y_{k-1}, -y_{k-2}, u_k, u_{k-1}, u_{k-2})
    auto const of_y = [&](size_t lag) {
        Reference sum = 0;
        for (size_t k = 0; k + lag < terms; ++k) sum += g[k] * g[k + lag] + h[k] * h[k + lag];
        return sum;
    };
    Matrix<Reference> R = Matrix<Reference>::Identity(d, d);
    for (Index i = 0; i < 2; ++i) {
        for (Index j = 0; j < 2; ++j) R(i, j) = of_y(size_t(std::abs(i - j)));
        for (Index j = 0; j < 3; ++j)  // E[-y_{k-1-i} u_{k-j}] = -g_{j-1-i}
            R(i, 2 + j) = R(2 + j, i) = j >= 1 + i ? Reference(-g[size_t(j - 1 - i)]) : Reference(0);
    }
    return R;
}

}  // namespace rlslab::studies::second_order
