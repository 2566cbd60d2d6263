// Input signals for identification. Each is determined by its arguments (and a seed): the same bits on every machine.
#pragma once

#include <rlslab/core/problem.hpp>
#include <rlslab/core/random.hpp>

#include <vector>

namespace rlslab {

using Signal = std::vector<double>;

/// n independent numbers, nearly normal of mean 0 and variance 1 (Seed::bell).
Signal white_noise(Index n, Seed seed);

/// n samples of x_k + a_1 x_{k-1} + ... + a_p x_{k-p} = w_k, w white of variance 1, after `burn_in` samples from rest:
/// coloured noise. Throws std::invalid_argument unless n, burn_in >= 0.
Signal coloured_noise(Index n, std::vector<double> const& a, Seed seed, Index burn_in = 1000);

/// n samples of a pseudo-random binary sequence, +1 and -1, from a maximal-length register of m = 2 ... 20 cells, of
/// period M = 2^m - 1. Its circular autocorrelation is M at multiples of M and -1 elsewhere, so that the j x j Gram
/// matrix of one period has the eigenvalues M + 1 (j - 1 times) and M + 1 - j. Each level lasts for `hold` samples.
/// Throws std::invalid_argument for another m, n < 0 or hold < 1. Source: Golomb 1967; docs/theory.md 53.
Signal prbs(int m, Index n, Index hold = 1);

/// sum over h = 1 ... harmonics of cos(2 pi h k / n + phi_h), Schroeder's phases phi_h = -pi h (h - 1) / harmonics: a
/// small crest factor. One period, scaled to variance 1; every number is rounded once from 113 bits. Repeated, it is
/// exciting of order 2 harmonics. Throws std::invalid_argument unless 1 <= harmonics < n / 2. Source: Schroeder 1970.
Signal multisine(Index n, int harmonics);

/// n samples of levels uniform in [-1, 1), each held for a number of samples uniform in [shortest, longest].
Signal random_steps(Index n, Index shortest, Index longest, Seed seed);

}  // namespace rlslab
