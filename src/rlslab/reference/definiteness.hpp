// Whether a stored covariance is positive definite: decided exactly, or proven in double where that is possible.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/problem.hpp>
#include <rlslab/core/stored.hpp>

namespace rlslab {

/// Whether P is positive definite, for exactly the bits stored: no rounding, no threshold. An information form is
/// positive definite if and only if P is. Returns sound (positive definite), indefinite (it is not) or nonfinite.
///   plain    X = F is positive definite if its symmetric part is: (F + F')/2 = L D L' in balls, every pivot > 0. If
///            the ball of a pivot contains zero, the precision is doubled; at 512 bits the integer determinant of its
///            leading block decides.
///   factor   F diag(D) F' is positive definite if and only if every D_j > 0 and F is nonsingular. The diagonal decides
///            that for a triangle; otherwise F's rank in integers (modulo a prime where that suffices).
/// Cost O(d^3) short multiplications unless P is singular or within 2^-500 of it. Throws std::invalid_argument when F
/// is not square or D not of its size; std::range_error when only integers of more than 2^20 bits could decide.
Health definiteness(Stored<Reference> const& stored);

/// True proves that P is positive definite; false proves nothing, and `definiteness` decides. Fast enough for every
/// step of every filter: d^3/6 flops in double, no heap up to d = 32.
///
/// `stored` holds the stored numbers, each rounded to double with |x~ - x| <= rho |x|, rho = relative_perturbation (0:
/// exact), or with an error below 2^-1074 by underflow. No nonzero entry of a factor may have become zero.
///   plain    Rump 2006, Verification of positive definiteness: if Cholesky's factorisation of A - c I runs
///            to completion in floating point, then A is positive definite, where c bounds its backward error.
///   factor   a triangle with a nonzero diagonal, and D > 0; any other F only when rho = 0, modulo a prime.
bool surely_positive(Stored<double> const& stored, double relative_perturbation = 0);

}  // namespace rlslab
