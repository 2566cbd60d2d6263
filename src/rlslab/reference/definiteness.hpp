// Is a stored covariance still positive definite? Decided exactly, or proven in plain double where that is easy.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/stored.hpp>

#include <string_view>

namespace rlslab {

enum class Definiteness { positive, not_positive, nonfinite };

constexpr std::string_view name_of(Definiteness definiteness) {
    constexpr std::string_view names[] = {"positive", "not_positive", "nonfinite"};
    return names[static_cast<int>(definiteness)];
}

/// Whether P is positive definite, for exactly the bits stored: no rounding, no threshold. An information form is
/// positive definite if and only if P is.
///   plain    X = F is judged by its symmetric part: (F + F')/2 = L D L' in balls, every pivot > 0. A pivot whose ball
///            contains zero is tried at doubled precision, and at 512 bits decided by the integer determinant of its
///            leading block.
///   factor   F diag(D) F' is, if and only if every D_j > 0 and F is nonsingular: read off a triangle's diagonal,
///            else from F's rank in integers (modulo a prime where that suffices).
/// Cost O(d^3) short multiplications unless P is singular or within 2^-500 of it. Throws std::invalid_argument when F
/// is not square or D not of its size; std::range_error when only integers of more than 2^20 bits could decide.
Definiteness definiteness(Stored<Reference> const& stored);

/// True proves that P is positive definite; false says nothing: ask `definiteness`. For every step of every filter:
/// d^3/6 flops in double, no heap up to d = 32.
///
/// The numbers given are what is stored, each rounded to double with at most this relative perturbation,
/// |x~ - x| <= rho |x| (0 if exact), or with an error below 2^-1074 by underflow; but no entry of a factor became zero.
///   plain    Rump 2006, Verification of positive definiteness: if Cholesky's factorisation of A - c I runs
///            to completion in floating point, then A is positive definite, where c bounds its backward error.
///   factor   a triangle with a nonzero diagonal, and D > 0; any other F only when rho = 0, modulo a prime.
bool surely_positive(Stored<double> const& stored, double relative_perturbation = 0);

}  // namespace rlslab
