// FLINT's and Arb's numbers with C++ lifetimes, and exact conversions to and from them. Internal: includes arb.h.
//
// A ball is a midpoint and a radius; every operation returns a ball that contains every possible result.
#pragma once

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/problem.hpp>

#if __has_include(<flint/arb.h>)  // FLINT 3 has Arb inside
#include <flint/arb.h>
#include <flint/arb_mat.h>
#else
#include <arb.h>
#include <arb_mat.h>
#endif
#include <flint/fmpq.h>
#include <flint/fmpz_mat.h>

#include <limits>
#include <utility>

namespace rlslab::balls {

/// A real number known to lie in [midpoint - radius, midpoint + radius].
class Ball {
    arb_t x_;

public:
    Ball() { arb_init(x_); }
    explicit Ball(double exact) : Ball() { arb_set_d(x_, exact); }
    Ball(Ball const& other) : Ball() { arb_set(x_, other.x_); }
    Ball(Ball&& other) noexcept : Ball() { arb_swap(x_, other.x_); }
    Ball& operator=(Ball other) noexcept { return arb_swap(x_, other.x_), *this; }
    ~Ball() { arb_clear(x_); }
    operator arb_ptr() { return x_; }
    operator arb_srcptr() const { return x_; }
};

/// A matrix of balls, zero at first, stored by rows: Arb's dot products need that.
class BallMatrix {
    arb_mat_t A_;

public:
    BallMatrix() : BallMatrix(0, 0) {}
    BallMatrix(Index rows, Index cols) { arb_mat_init(A_, rows, cols); }
    BallMatrix(BallMatrix const& other) : BallMatrix(other.rows(), other.cols()) { arb_mat_set(A_, other.A_); }
    BallMatrix(BallMatrix&& other) noexcept : BallMatrix() { arb_mat_swap(A_, other.A_); }
    BallMatrix& operator=(BallMatrix other) noexcept { return arb_mat_swap(A_, other.A_), *this; }
    ~BallMatrix() { arb_mat_clear(A_); }
    operator arb_mat_struct*() { return A_; }
    operator arb_mat_struct const*() const { return A_; }
    Index rows() const { return arb_mat_nrows(A_); }
    Index cols() const { return arb_mat_ncols(A_); }
    arb_ptr operator()(Index i, Index j) { return arb_mat_entry(A_, i, j); }
    arb_srcptr operator()(Index i, Index j) const { return arb_mat_entry(A_, i, j); }
};

/// An upper or lower bound of a magnitude: a nonnegative number of 30 bits.
class Magnitude {
    mag_t x_;

public:
    Magnitude() { mag_init(x_); }
    Magnitude(Magnitude const& other) { mag_init_set(x_, other.x_); }
    Magnitude& operator=(Magnitude const& other) { return mag_set(x_, other.x_), *this; }
    ~Magnitude() { mag_clear(x_); }
    operator mag_ptr() { return x_; }
    operator mag_srcptr() const { return x_; }
};

/// An exact binary floating-point number of any length.
class Float {
    arf_t x_;

public:
    Float() { arf_init(x_); }
    explicit Float(double x) : Float() { arf_set_d(x_, x); }
    explicit Float(Reference const& x) : Float() { arf_set_mpfr(x_, x.backend().data()); }
    Float(Float const& other) : Float() { arf_set(x_, other.x_); }
    Float& operator=(Float const& other) { return arf_set(x_, other.x_), *this; }
    ~Float() { arf_clear(x_); }
    operator arf_ptr() { return x_; }
    operator arf_srcptr() const { return x_; }
};

/// An integer of any length.
class Integer {
    fmpz_t x_;

public:
    Integer() { fmpz_init(x_); }
    explicit Integer(long x) { fmpz_init_set_si(x_, x); }
    Integer(Integer const& other) { fmpz_init_set(x_, other.x_); }
    Integer& operator=(Integer const& other) { return fmpz_set(x_, other.x_), *this; }
    ~Integer() { fmpz_clear(x_); }
    operator fmpz*() { return x_; }
    operator fmpz const*() const { return x_; }
};

/// A matrix of integers, zero at first.
class IntegerMatrix {
    fmpz_mat_t A_;

public:
    IntegerMatrix(Index rows, Index cols) { fmpz_mat_init(A_, rows, cols); }
    IntegerMatrix(IntegerMatrix const&) = delete;
    IntegerMatrix& operator=(IntegerMatrix const&) = delete;
    ~IntegerMatrix() { fmpz_mat_clear(A_); }
    operator fmpz_mat_struct*() { return A_; }
    operator fmpz_mat_struct const*() const { return A_; }
    Index rows() const { return fmpz_mat_nrows(A_); }
    Index cols() const { return fmpz_mat_ncols(A_); }
    fmpz* operator()(Index i, Index j) { return fmpz_mat_entry(A_, i, j); }
    fmpz const* operator()(Index i, Index j) const { return fmpz_mat_entry(A_, i, j); }
};

/// A number of bits t with 2^-t <= 10^-digits: digits times 3.321928095 > log2(10) = 3.32192809488..., rounded up.
inline long bits_for(long digits) { return (digits * 3321928095 + 999999999) / 1000000000; }

/// The ball of radius 0 around x.
inline void set(arb_ptr ball, double x) { arb_set_d(ball, x); }
inline void set(arb_ptr ball, Reference const& x) { arb_set_arf(ball, Float(x)); }

/// A as balls of radius 0.
template <class Derived>
BallMatrix exact(Eigen::MatrixBase<Derived> const& A) {
    BallMatrix balls(A.rows(), A.cols());
    for (Index j = 0; j < A.cols(); ++j)
        for (Index i = 0; i < A.rows(); ++i) set(balls(i, j), A(i, j));
    return balls;
}

/// The midpoint, rounded to nearest in the Reference arithmetic.
inline Reference midpoint(arb_srcptr ball) {
    Reference x;
    arf_get_mpfr(x.backend().data(), arb_midref(ball), MPFR_RNDN);
    return x;
}

/// The largest of the lower bounds of |A_ij|, and the largest radius.
inline std::pair<Magnitude, Magnitude> size_and_radius(BallMatrix const& A) {
    Magnitude size, radius, lower;
    for (Index i = 0; i < A.rows(); ++i)
        for (Index j = 0; j < A.cols(); ++j) {
            arb_get_mag_lower(lower, A(i, j));
            mag_max(size, size, lower);
            mag_max(radius, radius, arb_radref(A(i, j)));
        }
    return {size, radius};
}

/// The Frobenius norm, computed with `bits` bits.
inline Ball norm(BallMatrix const& A, long bits) {
    Ball sum;
    for (Index i = 0; i < A.rows(); ++i)
        for (Index j = 0; j < A.cols(); ++j) arb_addmul(sum, A(i, j), A(i, j), bits);
    arb_sqrtpos(sum, sum, bits);
    return sum;
}

/// -log10 of the upper end of a ball >= 0, for any exponent: +infinity for exact 0, -infinity if the ball is unbounded.
inline double proven_digits(Ball const& error) {
    constexpr long bits = 64;
    Float upper;
    arb_get_ubound_arf(upper, error, bits);
    if (arf_is_zero(upper)) return std::numeric_limits<double>::infinity();
    if (!arf_is_finite(upper)) return -std::numeric_limits<double>::infinity();
    Integer exponent;
    arf_frexp(upper, exponent, upper);
    return -(correctly::log10(arf_get_d(upper, ARF_RND_UP)) + fmpz_get_d(exponent) * correctly::log10(2.0));
}

}  // namespace rlslab::balls
