// The least c: a lower bound is raised until (3) holds. Sizes are computed from exponents only.
#include <rlslab/model/default_prior.hpp>

#include <rlslab/reference/certified.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rlslab {
namespace {

constexpr double most_bias = 1e-3, most_component = 1e-2;
constexpr int least_exponent = 5, largest_exponent = 500;  // of c, and of every c / s_i

/// k of s = 2^k, where mean squares in [2^(2k-1), 2^(2k+1)) share s.
int scale_exponent(Eigen::Ref<Eigen::RowVectorXd const> const& row) {
    double largest = 0;
    for (Index k = 0; k < row.size(); ++k) largest = std::max(largest, std::abs(row[k]));
    if (largest == 0) return 0;
    int of_largest = 0, of_mean = 0;
    std::frexp(largest, &of_largest);
    double sum = 0;  // squares of numbers below 1: no overflow, and terms that underflow are negligible
    for (Index k = 0; k < row.size(); ++k) {
        double const x = std::ldexp(row[k], -of_largest);
        sum += x * x;
    }
    std::frexp(sum / double(row.size()), &of_mean);  // the mean square lies in [2^(e-1), 2^e)
    return of_largest + (of_mean >> 1);              // floor(e / 2)
}

}  // namespace

Vector<double> regressor_scales(Records const& records) {
    Vector<double> s(records.parameters());
    for (Index i = 0; i < records.parameters(); ++i)
        s[i] = std::ldexp(1.0, std::clamp(scale_exponent(records.psi.row(i)), -largest_exponent, largest_exponent));
    return s;
}

Prior<double> DefaultPrior::prior() const {
    Prior<double> out;
    out.covariance = Matrix<double>::Zero(s.size(), s.size());
    for (Index i = 0; i < s.size(); ++i) {
        double const root = std::clamp(c / s[i], std::ldexp(1.0, -largest_exponent), std::ldexp(1.0, largest_exponent));
        (*out.covariance)(i, i) = root * root;
    }
    return out;
}

DefaultPrior default_prior(Records const& records, double forgetting) {
    expects(records.psi.allFinite() && records.y.allFinite(), "finite data");
    DefaultPrior out{regressor_scales(records), std::ldexp(1.0, least_exponent), 0, 0, false};
    Problem<double> problem{.size = records.parameters(), .prior = std::nullopt};
    auto const minimiser = [&] { return certified(problem, records, {records.rows()}).front(); };
    struct Free {
        double lambda;
        CertifiedSolution theta;  // without a prior
    };
    std::vector<Free> free;
    for (double const lambda : {1.0, forgetting}) {
        if (!free.empty() && lambda == 1) break;
        problem.forgetting = lambda;
        free.push_back({lambda, minimiser()});
    }
    struct Moved {
        double theta, component;
    };
    auto const moved_by = [&](Free const& without) {
        problem.forgetting = without.lambda, problem.prior = out.prior();
        CertifiedSolution const with = minimiser();
        return Moved{relative_change(with, without.theta, out.s), largest_relative_change(with, without.theta, out.s)};
    };
    auto const room = [&] {
        return largest_exponent - std::ilogb(out.c) + std::ilogb(out.s.minCoeff());
    };  // for doublings of c
    // t times c divides the bias by t^2 at most: its part along an axis of the scaled data is proportional to 1 / (1 +
    // c^2 sigma_j).
    for (Free const& without : free)
        for (;;) {
            double const bias = moved_by(without).theta;
            if (!(bias > most_bias) || room() <= 0) break;
            int doublings = 0;
            bool const power = std::frexp(std::sqrt(bias / most_bias), &doublings) == 0.5;  // t in [2^(e-1), 2^e)
            out.c *= std::ldexp(1.0, std::clamp(doublings - power, 1, room()));
        }
    // There is no such law for a component: c is doubled until (4) holds.
    for (Free const& without : free)
        while (moved_by(without).component > most_component && room() > 0) out.c *= 2;
    for (Free const& without : free) {
        Moved const moved = moved_by(without);
        out.bias = std::isnan(moved.theta) ? moved.theta : std::max(out.bias, moved.theta);
        out.worst = std::isnan(moved.component) ? moved.component : std::max(out.worst, moved.component);
        if (std::isnan(moved.theta)) break;
    }
    out.reached = out.bias <= most_bias && out.worst <= most_component;
    return out;
}

}  // namespace rlslab
