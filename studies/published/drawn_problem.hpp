// Random problems: a system, an input and noise, drawn from two distributions: of study random_problems, and of study
// everyday_problems, whose rows are of the kinds that plants and tables leave.
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
    // Of the second distribution:
    std::string kind = {};                   ///< empty: of the first
    double jitter = 0;                       ///< deviation of the input while it rests
    Index rest = 0, period = 0, level = 0;   ///< rows at rest; of a period; between two steps of a column
    std::vector<Vector<double>> later = {};  ///< theta after each change
};

/// Problem 1, 2, ...: the number decides the word and which have d = 32, the seed the rest.
DrawnProblem drawn_problem(Index number, Seed seed);

/// The kinds of the second distribution.
inline constexpr char const* everyday_kinds[] = {"rest", "periodic", "counts", "units", "changes", "levels"};

/// A problem of the second distribution; its kinds, words and lambdas take turns, the seed decides the rest.
///
///   d        2^(1 + 2 x), rounded: 2 to 8
///   N        log-uniform from 40 d to 4000
///   theta_i  10^(x - 1/2) with a random sign, in units of its column
///   noise    10^(-3 + 3 x) of the output's root mean square
///   word     float or double
///   lambda   1 in a half; else the memory 1 / (1 - lambda) is log-uniform from 10 d to 2000
///   prior    what compare proposes; in a quarter c^2 I with c^2 = 10^(4 + 8 x)
///   rows     rest: a delay line of an input that is 1 + 10^(-6 + 5 x) w before the first row and for 2 to
///              20 % of N, then w
///            periodic: a delay line of w or of random signs that repeats after T rows, T log-uniform from 2 d to N / 4
///            counts: a third each whole numbers from 0 to 4095, random signs in a delay line, and group marks 0 or 1
///              with a column of ones; y is rounded to a whole number
///            units: w times 10^(-6 + 12 x), each column its own; in a half about a mean of 10 deviations
///            changes: w, and theta drawn anew 2 to 6 times, at even distances
///            levels: w, but for two columns: ones, and a level that steps after 5 to 40 % of N
DrawnProblem everyday_problem(Index number, Seed seed);

/// A record of the problem: regressors from one seed, noise from another.
Records realisation(DrawnProblem const& problem, Seed rows, Seed noise);
/// Of a problem that has a kind.
Records everyday_realisation(DrawnProblem const& problem, Seed rows, Seed noise);

}  // namespace rlslab::studies
