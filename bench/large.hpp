// How a filter of many parameters is timed and scored.
#pragma once

#include "bench/rows.hpp"

#include <Eigen/Cholesky>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>

namespace rlslab::bench {

inline std::vector<Index> const large_sizes{512, 1024, 2048, 4096};

/// Rows of noise from theta = 0 and P0 = 10 I. After k < d rows theta is in the span of their regressors, and a system
/// of order k gives it: with Psi (d x k), y (k), W = diag(lambda^(k-1), ..., lambda, 1) and v = 10 / lambda^k
///   theta = v Psi (W^-1 + v Psi'Psi)^-1 y,
/// computed in 257 bits.
struct LargeScenario {
    static constexpr Index rows = 16;
    Problem<double> problem;
    Matrix<double> psi;
    Vector<double> y, theta;

    explicit LargeScenario(Index size)
        : problem{.size = size, .forgetting = 0.9921875, .prior = Prior<double>{.variance = 10}}, psi(size, rows),
          y(rows) {
        Seed seed{4};
        for (double& x : psi.reshaped()) x = seed.bell();
        for (double& x : y) x = seed.bell();
        Matrix<Reference> const wide = psi.cast<Reference>();
        Reference weight = 1, v = 10;
        for (Index k = 0; k < rows; ++k) v /= Reference(problem.forgetting);
        Matrix<Reference> dual = v * wide.transpose().lazyProduct(wide);
        for (Index k = rows - 1; k >= 0; --k, weight *= Reference(problem.forgetting)) dual(k, k) += 1 / weight;
        Vector<Reference> const multipliers = dual.ldlt().solve(y.cast<Reference>().eval());
        theta = (v * wide.lazyProduct(multipliers)).template cast<double>();
    }
};

/// large/NAME/double/SIZE: a new filter and a few rows, of which the first is not timed.
template <class F, class Feed = OneByOne>
void add_large_rows(std::string const& name = std::string(F::name)) {
    for (Index size : large_sizes)
        add_row("large/" + name + "/double/" + std::to_string(size), [=](benchmark::State& state) {
            static std::map<Index, LargeScenario> made;
            LargeScenario const& scenario = made.try_emplace(size, size).first->second;
            Index const timed = LargeScenario::rows - 1;
            F start(scenario.problem);
            Feed{}(start, scenario.psi, scenario.y, 0, 1);
            F filter = start;
            time_rows(
                state, timed, [&] { filter = start; },
                [&] { return Feed{}(filter, scenario.psi, scenario.y, 1, LargeScenario::rows); },
                [&] {
                    Vector<double> const theta = filter.theta();
                    double const error =
                        (theta - scenario.theta).cwiseAbs().maxCoeff() / scenario.theta.cwiseAbs().maxCoeff();
                    double const most = std::numeric_limits<double>::digits * std::log10(2.0);
                    return Answer{theta.allFinite() ? std::min(-std::log10(error), most) : 0, theta.allFinite()};
                });
            state.SetLabel(family_of(filter));
        });
}
}  // namespace rlslab::bench
