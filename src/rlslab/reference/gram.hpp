// The Gram matrix of [psi y]: exactly in integers, or with forgetting in balls. Internal: includes arb.h.
#pragma once

#include <rlslab/core/records.hpp>
#include <rlslab/reference/balls.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace rlslab::balls {

/// G = sum_i a_i a_i', a_i = (psi_i, y_i), (d + 1) x (d + 1), in integers. Every column j has its own unit 2^e_j, the
/// largest power of two that divides all its entries, so that columns of very different scale do not make each other's
/// integers longer.
///
///   G_ij = 2^(e_i + e_j) sum_k m_ki m_kj
///
/// Memory O(d^2). Data must be finite.
class IntegerGram {
    Records const& data_;
    std::vector<int> unit_;  ///< e_j; the output is column d
    IntegerMatrix sum_;
    Index rows_ = 0;

    void add(Index first, Index count);

public:
    IntegerGram(Records const& data, Index last);
    /// Adds the rows that follow, up to row k <= last; k must not fall. `pause`: called after each block of rows.
    void advance(Index k, std::function<void()> const& pause = {});
    IntegerMatrix const& mantissas() const { return sum_; }
    /// G_ij rounded to `bits` bits, with the rounding error in the radius.
    void entry(arb_ptr ball, Index i, Index j, long bits) const;
};

/// M = lambda^k M_0 + sum_i lambda^(k-i) a_i a_i' in balls, by blocks of rows:
///
///   (1)  M <- lambda^B M + A' W A,    W = diag(lambda^(B-1), ..., lambda, 1)
///
/// With power = p, lambda^p (a ball) takes the place of lambda. The entries of A are exact and short, which makes Arb's
/// dot products cheap. Memory O(d^2 + B d).
class ForgettingGram {
    Records const& data_;
    long bits_;
    std::vector<Ball> power_;  ///< lambda^0 ... lambda^B
    BallMatrix sum_;           ///< upper triangle
    BallMatrix a_, wa_;        ///< A' and A' W
    Index rows_ = 0;

    void add(Index first, Index count);

public:
    static constexpr Index block = 64;
    /// M_0, (d+1) x (d+1), is the prior's part (upper triangle).
    ForgettingGram(Records const& data, double forgetting, BallMatrix M0, long bits, unsigned power = 1);
    void advance(Index k, std::function<void()> const& pause = {});
    BallMatrix const& matrix() const { return sum_; }
};

/// G_k of rows that weigh w_i^power, w_i = lambda^(k-i), both triangles: by whichever of the two serves lambda.
class WeightedGram {
    std::unique_ptr<IntegerGram> exact_;
    std::unique_ptr<ForgettingGram> forgetting_;
    Index size_;
    long bits_;

public:
    WeightedGram(Records const& data, double lambda, Index last, unsigned power, long bits);
    /// (d + 1) x (d + 1); k must not fall.
    BallMatrix at(Index k);
};
/// The first d rows and columns.
BallMatrix leading(BallMatrix const& A, Index d);

/// True proves theta_k = 0: theta_k of M_k theta_k = b_k is zero where P0 b_k is, which is a sum of products of given
/// numbers. False: it is not zero, or the proof needs numbers of more than 2^20 bits. Called when the balls of all
/// components of theta contain zero.
bool surely_vanishes(Problem<double> const& problem, Records const& data, Index k);

/// The proven rank of the first k regressors, for each k of `steps` (ascending). Elimination modulo the prime 2^61 - 1
/// bounds it from below, k and d from above. Where these differ, exact integer elimination decides.
std::vector<Index> proven_ranks(Records const& data, std::vector<Index> const& steps,
                                std::function<void()> const& pause = {});

/// Whether a finite square matrix is nonsingular, decided exactly: modulo a prime first, then in integers.
/// Throws std::range_error when the exponents within a column differ by more than 2^20.
bool nonsingular(Matrix<Reference> const& A);

bool nonsingular(IntegerMatrix const& A);

/// True proves that a finite square matrix is nonsingular (modulo the same prime); false proves nothing. Fast.
bool surely_nonsingular(Matrix<double> const& A);

/// The largest eigenvalue of a positive definite matrix, to about 1e-15 d, and a vector of length 1 that belongs to it.
struct Dominant {
    double log2_value;
    Vector<double> vector;
};
Dominant dominant(BallMatrix const& A);

/// x = mantissa 2^exponent, the mantissa odd or 0.
struct Dyadic {
    std::int64_t mantissa = 0;
    int exponent = 0;
};
Dyadic dyadic(double x);

/// The sign of the determinant of the leading n x n block of F + F', exactly. Throws std::range_error as `nonsingular`.
int sign_of_leading_minor(Matrix<Reference> const& F, Index n);

}  // namespace rlslab::balls
