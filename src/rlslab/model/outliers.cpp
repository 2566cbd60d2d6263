// Each value is compared with statistics of the others, without itself.
#include <rlslab/model/outliers.hpp>

#include <rlslab/reference/distributions.hpp>

#include <cmath>

namespace rlslab {

std::optional<LargestResidual> outlier_in(Signal residuals, Index lags) {
    double J = 0, count = 0, largest = 0;
    for (double const e : residuals)
        if (largest < std::abs(e)) largest = std::abs(e);
    if (!(largest > 0) || std::isinf(largest)) return {};
    for (double& e : residuals) e = std::ldexp(e, -std::ilogb(largest));  // so that no square is lost
    Index at = 0;
    for (size_t k = 0; k < residuals.size(); ++k) {
        double const e = residuals[k];
        if (std::isnan(e)) continue;
        J += e * e, ++count;
        if (!(std::abs(e) <= std::abs(residuals[size_t(at)]))) at = Index(k);
    }
    double const e = residuals[size_t(at)], F = e * e / ((J - e * e) / (count - 1));  // against the others
    if (count < 2 || !(J - e * e > 0 ? correctly::fisher_tail(1, count - 1, F) * count < 0.001 : count > 2)) return {};
    // As a past output it makes the residuals after it large, too.
    for (Index before = at; before >= std::max<Index>(0, at - lags); --before)
        if (std::abs(residuals[size_t(before)]) >= std::abs(e) / 2) at = before;
    double const square = residuals[size_t(at)] * residuals[size_t(at)];
    return LargestResidual{at, std::sqrt(square / (J / count)), square / J};
}

Spike largest_spike(Signal const& u, Index count) {
    double sum = 0, n = 0;
    for (Index k = 0; k < count; ++k)
        if (double const x = u[size_t(k)]; !std::isnan(x)) sum += x, ++n;
    Spike out;
    double most = 0, squares = 0;
    for (Index k = 0; k < count; ++k)
        if (double const off = u[size_t(k)] - sum / n; !std::isnan(off)) {
            squares += off * off;
            if (std::abs(off) > most) most = std::abs(off), out.row = k + 1;
        }
    // Without it the mean moves by most / (n - 1), and the squares lose it.
    double const others = squares - most * most * n / (n - 1);
    if (n > 2) out.deviations = others > 0 ? most * n / (n - 1) / std::sqrt(others / (n - 2)) : 0;
    return out;
}

}  // namespace rlslab
