// Random problems: a system, an input and noise, drawn from one distribution that study random_problems states.
#pragma once

#include <rlslab/studies/study.hpp>

#include <rlslab/core/random.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rlslab::studies {

/// A problem of the distribution. Its records are drawn apart: two realisations have this in common and nothing else.
///
///   d        2^(4 x), x uniform in [0, 1), rounded; 32 in every hundredth problem
///   N        log-uniform from 2 d to 2000
///   psi_k    a third each: V S w_k (rotated), S w_k with the columns permuted (units), a delay line of an
///            autoregression of order 1 or of a double pole; w white of variance 1, V orthogonal
///   S        geometric, one small, one large, or half of them small (clustered); condition kappa = 10^(8 x)
///   offset   in a quarter of the problems each column has a mean of 10^(3 x) of its deviations; in a quarter of those
///            with d > 1 the last column is constant
///   theta    along v_1, along v_d, generic, or generic with half of it zero. v_1 and v_d of a delay line are taken as
///            (1, 1, ...) and (1, -1, ...)
///   noise    none in an eighth; else 10^(-6 + 7 x) of the output's root mean square
///   word     float or double in turn; each twentieth problem binary16, each twentieth bfloat16
///   lambda   1 in a half; else the memory 1 / (1 - lambda) is log-uniform from max(10, 2 d) to 10^4
///   prior    a third each: what compare proposes, 2^14 I (C++'s default), c^2 I with c^2 = 10^(10 x)
struct DrawnProblem {
    Index size = 0, rows = 0;
    std::string word, regressors, spectrum;
    int order = 1;  ///< of the autoregression
    double kappa = 1, offset = 0;
    bool intercept = false;
    std::string direction;
    double noise = 0, forgetting = 1;
    std::string prior;          ///< "proposed", "default", "given"
    std::optional<double> p0;   ///< c^2; absent: proposed
    std::vector<double> sigma;  ///< d
    Matrix<double> V;           ///< d x d: permuted unit vectors where the regressors are not rotated
    Vector<double> theta;       ///< d
};

/// Problem 1, 2, ...: the number decides the word and which have d = 32, the seed the rest.
DrawnProblem drawn_problem(Index number, Seed seed);

/// A record of the problem: regressors from one seed, noise from another.
Records realisation(DrawnProblem const& problem, Seed rows, Seed noise);

}  // namespace rlslab::studies
