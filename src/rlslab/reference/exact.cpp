// The members of CertifiedSolution: its numbers, and the digits of an estimate.
#include <rlslab/reference/enclosure.hpp>
#include <rlslab/reference/gram.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rlslab {

namespace {

using namespace balls;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// An upper bound of ||radii|| / ||A||; 0 when all is exact, infinity when A may be zero and is not exact.
double relative_radius(BallMatrix const& A) {
    BallMatrix radii(A.rows(), A.cols());
    for (Index i = 0; i < A.rows(); ++i)
        for (Index j = 0; j < A.cols(); ++j) arf_set_mag(arb_midref(radii(i, j)), arb_radref(A(i, j)));
    constexpr long bits = 64;
    Ball const above = norm(radii, bits), below = norm(A, bits);
    Magnitude quotient, divisor;
    arb_get_mag(quotient, above);
    if (mag_is_zero(quotient)) return 0;
    arb_get_mag_lower(divisor, below);
    mag_div(quotient, quotient, divisor);
    return mag_get_d(quotient);
}

/// ||A - B|| / ||B||, and the result if B is exactly zero.
double digits_between(BallMatrix const& A, BallMatrix const& B, long bits) {
    BallMatrix difference(A.rows(), A.cols());
    arb_mat_sub(difference, A, B, bits);
    Ball error = norm(difference, bits);
    Ball const size = norm(B, bits);
    if (arb_is_zero(size)) return arb_is_zero(error) ? infinity : -infinity;
    arb_div(error, error, size, bits);
    return proven_digits(error);
}

template <class Derived>
bool all_finite(Eigen::MatrixBase<Derived> const& A) {
    for (Index j = 0; j < A.cols(); ++j)
        for (Index i = 0; i < A.rows(); ++i)
            if (!is_finite(A(i, j))) return false;
    return true;
}

bool upper_triangular(Matrix<Reference> const& A) {
    for (Index j = 0; j < A.cols(); ++j)
        for (Index i = j + 1; i < A.rows(); ++i)
            if (A(i, j) != 0) return false;
    return true;
}

/// A^-1 at this precision; false: not shown to be invertible.
bool invert(BallMatrix& inverse, Matrix<Reference> const& A, long bits) {
    BallMatrix identity(A.rows(), A.cols());
    arb_mat_one(identity);
    inverse = BallMatrix(A.rows(), A.cols());
    bool const upper = upper_triangular(A);
    if (!upper && !upper_triangular(A.transpose())) return arb_mat_inv(inverse, exact(A), bits) != 0;
    if ((A.diagonal().array() == Reference(0)).any()) return false;
    if (upper) arb_mat_solve_triu(inverse, exact(A), identity, 0, bits);
    else arb_mat_solve_tril(inverse, exact(A), identity, 0, bits);
    return true;
}

/// P from the stored numbers:  F,  F D F',  F^-1,  F^-T D^-1 F^-1. False: not shown to be invertible at this precision.
bool rebuild(BallMatrix& P, Stored<Reference> const& stored, long bits) {
    using Quantity = Stored<Reference>::Quantity;
    using Form = Stored<Reference>::Form;
    bool const inverted = stored.quantity == Quantity::information;
    if (stored.form == Form::plain) {
        if (inverted) return invert(P, stored.F, bits);
        P = exact(stored.F);
        return true;
    }
    Index const d = stored.F.rows();
    BallMatrix left(d, d);  // P = left D^(+-1) left'
    if (inverted) {
        if (!invert(left, stored.F, bits)) return false;
        arb_mat_transpose(left, left);
    } else {
        left = exact(stored.F);
    }
    BallMatrix scaled = left, right(d, d);
    for (Index j = 0; j < stored.D.size(); ++j) {
        Ball factor;
        set(factor, stored.D(j));
        if (inverted) arb_inv(factor, factor, bits);
        for (Index i = 0; i < d; ++i) arb_mul(scaled(i, j), scaled(i, j), factor, bits);
    }
    arb_mat_transpose(right, left);
    P = BallMatrix(d, d);
    arb_mat_mul(P, scaled, right, bits);
    return true;
}

/// Whether an information form has no inverse, decided exactly.
bool singular(Stored<Reference> const& stored) {
    for (Reference const& d : stored.D)
        if (d == 0) return true;
    return !nonsingular(stored.F);
}

/// x with n significant digits, rounded to nearest: "-1.234e-5".
std::string decimal(mpfr_srcptr x, int n) {
    mpfr_exp_t exponent = 0;
    char* const digits = mpfr_get_str(nullptr, &exponent, 10, size_t(n), x, MPFR_RNDN);
    std::string text(digits);
    mpfr_free_str(digits);
    if (mpfr_zero_p(x)) return "0";
    size_t const sign = text[0] == '-';
    if (n > 1) text.insert(sign + 1, 1, '.');
    return text + "e" + std::to_string(exponent - 1);
}

std::string decimal(arb_srcptr ball, int digits, long bits) {
    mpfr_t low, high;
    mpfr_init2(low, bits + 64);
    mpfr_init2(high, bits + 64);
    arb_get_interval_mpfr(low, high, ball);
    std::string text = "0";
    for (int n = digits; n >= 1; --n)
        if (auto const below = decimal(low, n); below == decimal(high, n)) {
            text = below;
            break;
        }
    mpfr_clear(low);
    mpfr_clear(high);
    return text;
}

bool contains(arb_srcptr ball, Rational const& x) {
    fmpq_t quotient;
    fmpq_init(quotient);
    fmpq_set_mpq(quotient, x.backend().data());
    bool const inside = arb_contains_fmpq(ball, quotient) != 0;
    fmpq_clear(quotient);
    return inside;
}

}  // namespace

CertifiedSolution::CertifiedSolution(Index step, Index size, Index rank, Status status)
    : step_(step), size_(size), rank_(rank), status_(status) {}

CertifiedSolution::CertifiedSolution(Index step, Index rank, std::shared_ptr<Enclosure const> enclosure)
    : step_(step), size_(enclosure->theta.rows()), rank_(rank), status_(Status::certified),
      enclosure_(std::move(enclosure)) {}

int CertifiedSolution::bits() const { return enclosure_ ? int(enclosure_->bits) : 0; }
double CertifiedSolution::radius() const { return enclosure_ ? relative_radius(enclosure_->theta) : nan; }
double CertifiedSolution::covariance_radius() const {
    return enclosure_ ? relative_radius(enclosure_->covariance) : nan;
}

Vector<Reference> CertifiedSolution::theta() const {
    Vector<Reference> x = Vector<Reference>::Constant(size_, Reference(nan));
    for (Index i = 0; enclosure_ && i < size_; ++i) x(i) = midpoint(enclosure_->theta(i, 0));
    return x;
}

Matrix<Reference> CertifiedSolution::covariance() const {
    Matrix<Reference> P = Matrix<Reference>::Constant(size_, size_, Reference(nan));
    for (Index j = 0; enclosure_ && j < size_; ++j)
        for (Index i = 0; i < size_; ++i) P(i, j) = midpoint(enclosure_->covariance(i, j));
    return P;
}

std::vector<std::string> CertifiedSolution::theta_strings(int digits) const {
    expects(digits >= 1, "digits >= 1");
    std::vector<std::string> texts(size_t(size_), "nan");
    for (Index i = 0; enclosure_ && i < size_; ++i)
        texts[size_t(i)] = decimal(enclosure_->theta(i, 0), digits, enclosure_->bits);
    return texts;
}

double CertifiedSolution::theta_digits(Vector<Reference> const& estimate) const {
    expects(estimate.size() == size_, "an estimate of the solution's size");
    if (!enclosure_ || !all_finite(estimate)) return nan;
    return digits_between(exact(estimate), enclosure_->theta, enclosure_->bits + 257);
}

double CertifiedSolution::theta_digits_worst(Vector<Reference> const& estimate) const {
    expects(estimate.size() == size_, "an estimate of the solution's size");
    if (!enclosure_ || !all_finite(estimate)) return nan;
    long const bits = enclosure_->bits + 257;
    double worst = infinity;
    for (Index i = 0; i < size_; ++i) {
        arb_srcptr const truth = enclosure_->theta(i, 0);
        Ball error;
        set(error, estimate(i));
        arb_sub(error, error, truth, bits);
        if (!arb_contains_zero(truth)) arb_div(error, error, truth, bits);
        arb_abs(error, error);
        worst = std::min(worst, proven_digits(error));
    }
    return worst;
}

double CertifiedSolution::covariance_digits(Stored<Reference> const& estimate) const {
    auto const& [of, kind, F, D] = estimate;
    expects(F.rows() == size_ && F.cols() == size_ && (D.size() == 0 || D.size() == size_),
            "an estimate of the solution's size");
    if (!enclosure_ || !all_finite(F) || !all_finite(D)) return nan;
    // As precise as the solution itself: relative to its largest entry, three digits more than `certified` was called
    // with.
    long const needed = bits_for(enclosure_->digits + 3);
    bool known_regular = of == Stored<Reference>::Quantity::covariance;
    BallMatrix P;
    for (long bits = needed + 128; bits <= 1L << 20; bits *= 2) {
        if (rebuild(P, estimate, bits)) {
            auto [size, radius] = size_and_radius(P);
            mag_mul_2exp_si(size, size, -needed);
            if (mag_cmp(radius, size) <= 0) return digits_between(P, enclosure_->covariance, bits + enclosure_->bits);
        }
        if (!known_regular && singular(estimate)) return nan;
        known_regular = true;
    }
    return nan;
}

bool CertifiedSolution::encloses(Vector<Rational> const& theta) const {
    expects(theta.size() == size_, "a solution of this size");
    for (Index i = 0; enclosure_ && i < size_; ++i)
        if (!contains(enclosure_->theta(i, 0), theta(i))) return false;
    return bool(enclosure_);
}

bool CertifiedSolution::encloses(Matrix<Rational> const& covariance) const {
    expects(covariance.rows() == size_ && covariance.cols() == size_, "a covariance of this size");
    for (Index j = 0; enclosure_ && j < size_; ++j)
        for (Index i = 0; i < size_; ++i)
            if (!contains(enclosure_->covariance(i, j), covariance(i, j))) return false;
    return bool(enclosure_);
}

}  // namespace rlslab
