// Difference equations to draw records from.
#pragma once

#include <rlslab/model/difference.hpp>

namespace rlslab {

/// A random stable system of order n with one input: pairs of poles (and one real pole if n is odd) with 0.3 <= |z| <=
/// 0.95, b uniform in [-1, 1) and not all small.
inline DifferenceEquation random_stable(int order, Seed seed) {
    std::vector<double> a{1};
    auto const times = [&a](std::vector<double> const& factor) {
        std::vector<double> product(a.size() + factor.size() - 1, 0.0);
        for (size_t i = 0; i < a.size(); ++i)
            for (size_t j = 0; j < factor.size(); ++j) product[i + j] += a[i] * factor[j];
        a = product;
    };
    for (int left = order; left > 0; left -= 2) {
        double const radius = 0.3 + 0.65 * seed.uniform();
        if (left == 1) times({1, seed.uniform() < 0.5 ? radius : -radius});
        else  // a pair at radius, cos of its angle uniform
            times({1, -2 * radius * (2 * seed.uniform() - 1), radius * radius});
    }
    DifferenceEquation out{.a = {a.begin() + 1, a.end()}, .b = {{}}, .delay = 0, .c = 0};
    for (int i = 0; i <= order; ++i) out.b[0].push_back(2 * seed.uniform() - 1);
    if (std::abs(out.b[0][0]) < 0.1) out.b[0][0] = 0.5;
    return out;
}

}  // namespace rlslab
