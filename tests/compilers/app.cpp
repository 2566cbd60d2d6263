// An app of every estimator, of fixed and of free size: it must compile without a warning, and find the line.
#include <rlslab/variants/variants.hpp>

template <template <class, int> class Filter>
bool finds_the_line() {
    Filter<double, rlslab::Dynamic> free({.size = 2, .forgetting = 0.99});
    Filter<float, 5> fixed({.size = 5});
    for (int k = 0; k < 100; ++k) {
        free.update(Eigen::Vector2d(1, k), 3 + 2.0 * k);
        fixed.update({1.0f, float(k % 2), float(k % 3), float(k % 5), float(k % 7)}, float(k % 7));
    }
    return Eigen::VectorXd(free.theta()).isApprox(Eigen::Vector2d(3, 2), 1e-3) && fixed.theta()[4] > 0.9f &&
           fixed.theta()[4] < 1.1f;
}

int main() {
    using namespace rlslab;
    bool const found = finds_the_line<Conventional>() && finds_the_line<ConventionalTwoSided>() &&
                       finds_the_line<Symmetric>() && finds_the_line<Joseph>() && finds_the_line<JosephRankTwo>() &&
                       finds_the_line<Potter>() && finds_the_line<Carlson>() && finds_the_line<Ud>() &&
                       finds_the_line<InverseQr>() && finds_the_line<CarlsonDelta>() && finds_the_line<UdDelta>() &&
                       finds_the_line<InverseQrDelta>() && finds_the_line<Kalman>() && finds_the_line<Information>() &&
                       finds_the_line<Qr>() && finds_the_line<Gentleman>() && finds_the_line<ExtendedQr>() &&
                       finds_the_line<QrBlock>();
    return found ? 0 : 1;
}
