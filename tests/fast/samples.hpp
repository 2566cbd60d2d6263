// Samples for the tests of fast forms.
#pragma once

#include <rlslab/core/random.hpp>
#include <rlslab/core/problem.hpp>

#include <cmath>
#include <utility>
#include <vector>

namespace rlslab::fast_tests {

/// Pairs (u, y): u white and coloured by its neighbour, y a transversal filter of 3 taps of it, and noise. Multiples of
/// 2^-10, short as rationals.
inline std::vector<std::pair<double, double>> samples(Index rows, std::uint64_t from, double scale = 1) {
    Seed seed{from};
    std::vector<std::pair<double, double>> out;
    double last = 0, before = 0;
    auto const short_one = [](double x) { return std::ldexp(std::round(std::ldexp(x, 10)), -10); };
    for (Index k = 0; k < rows; ++k) {
        double const u = short_one(seed.bell() + 0.5 * last);
        out.emplace_back(u * scale, short_one(u - 0.5 * last + 0.25 * before + 0.125 * seed.bell()) * scale);
        before = last, last = u;
    }
    return out;
}

}  // namespace rlslab::fast_tests
