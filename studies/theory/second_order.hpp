// The known system of the studies of the estimate: order 2, binary white input, white noise of a given shape or
// coloured.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/core/matrices.hpp>
#include <rlslab/core/random.hpp>

#include <array>
#include <vector>

namespace rlslab::studies::second_order {

using P = Pack<double, 8>;
constexpr double sigma = 0.5;

/// y_k + a_1 y_{k-1} + a_2 y_{k-2} = b_0 u_k + b_1 u_{k-1} + b_2 u_{k-2} + xi_k; without a: a finite impulse response.
struct System {
    bool recursive;
    double colour;  ///< xi_k = colour xi_{k-1} + white
    Index size() const { return recursive ? 5 : 3; }
    std::array<double, 5> theta() const {
        return recursive ? std::array{-1.5, 0.7, 1.0, 0.5, -0.3} : std::array{1.0, 0.5, -0.3, 0.0, 0.0};
    }
};

/// Runs eight records from rest; after 50 samples (0.84^50) `row(psi, y)` is called `rows` times. `noise(seed)` draws a
/// number of mean 0 and variance 1.
template <class Noise, class Row>
void simulate(System const& system, Index rows, Seed& seed, Noise noise, Row row) {
    auto const truth = system.theta();
    Index const d = system.size();
    std::vector<P> psi(5, P(0.0));
    P y1(0.0), y2(0.0), u1(0.0), u2(0.0), xi(0.0);
    constexpr Index burn_in = 50;
    for (Index k = -burn_in; k < rows; ++k) {
        std::array<double, 8> input, drawn;
        for (double& x : input) x = seed.next() >> 63 ? 1.0 : -1.0;
        for (double& x : drawn) x = sigma * noise(seed);
        P const u(input), white(drawn);
        xi = P(system.colour) * xi + white;
        size_t next = 0;
        if (system.recursive) psi[next++] = -y1, psi[next++] = -y2;
        psi[next++] = u, psi[next++] = u1, psi[next++] = u2;
        P y = xi;
        for (size_t i = 0; i < size_t(d); ++i) y += psi[i] * P(truth[i]);
        if (k >= 0) row(psi, y);
        y2 = y1, y1 = y, u2 = u1, u1 = u;
    }
}

/// R of E[psi psi'] by the responses of the system to its input (white, variance 1) and to its white noise (variance
/// sigma^2), 400 terms: the poles have modulus 0.84.
Matrix<Reference> second_moments(System const& system);

}  // namespace rlslab::studies::second_order
