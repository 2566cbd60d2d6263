// y = 3 + 2i without noise: whatever the filter's arithmetic, it must find the line.
#include <rlslab/variants/ud.hpp>

#include <cmath>
#include <cstdio>

int main() {
    rlslab::Ud<double> filter({.size = 2, .forgetting = 0.99});
    for (int i = 0; i < 100; ++i) filter.update(Eigen::Vector2d(1, i), 3 + 2.0 * i);
    std::printf("%.6f + %.6f i\n", double(filter.theta()[0]), double(filter.theta()[1]));
    return std::abs(filter.theta()[0] - 3) < 1e-3 && std::abs(filter.theta()[1] - 2) < 1e-3 ? 0 : 1;
}
