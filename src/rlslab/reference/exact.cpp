// The members of CertifiedSolution: its numbers, the digits of an estimate; the condition number of weighted data.
#include <rlslab/reference/enclosure.hpp>

#include <rlslab/reference/gram.hpp>
#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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

/// A^-1 at this precision, of finite numbers; false: not shown to be invertible.
bool invert(BallMatrix& inverse, Matrix<Reference> const& A, long bits) {
    BallMatrix identity(A.rows(), A.cols());
    arb_mat_one(identity);
    inverse = BallMatrix(A.rows(), A.cols());
    bool const upper = A.isUpperTriangular(Reference(0));
    if (!upper && !A.isLowerTriangular(Reference(0))) return arb_mat_inv(inverse, exact(A), bits) != 0;
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
    if (!enclosure_ || !estimate.allFinite()) return nan;
    return digits_between(exact(estimate), enclosure_->theta, enclosure_->bits + 257);
}

double CertifiedSolution::theta_digits_worst(Vector<Reference> const& estimate) const {
    expects(estimate.size() == size_, "an estimate of the solution's size");
    if (!enclosure_ || !estimate.allFinite()) return nan;
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
    if (!enclosure_ || !F.allFinite() || !D.allFinite()) return nan;
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

// --- the condition number of weighted data, and the bias of a prior --------------------------------------------------

// With t_i the trace of A_i,
//
//   (1)  A_(i+1) = (A_i / t_i)^2        log2 trace(A^m)^(1/m),  m = 2^i,  is  sum_(l<=i) log2(t_l) / 2^l
//
// and lambda_max <= trace(A^m)^(1/m) <= d^(1/m) lambda_max. Rounding at stage i enters divided by 2^i. A_i / t_i tends
// to the projection on the eigenvectors of lambda_max: its longest column is one of them.
Dominant balls::dominant(BallMatrix const& A) {
    Index const d = A.rows();
    constexpr int stages = 40;
    Ball trace;
    arb_mat_trace(trace, A, 64);
    Integer exponent;
    Float head;
    arf_frexp(head, exponent, arb_midref(static_cast<arb_srcptr>(trace)));
    fmpz_neg(exponent, exponent);
    Matrix<double> X(d, d), square(d, d);
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i) {
            arf_mul_2exp_fmpz(head, arb_midref(A(i, j)), exponent);
            X(i, j) = arf_get_d(head, ARF_RND_NEAR);
        }
    double sum = -fmpz_get_d(exponent), weight = 1;
    for (int stage = 0; stage < stages; ++stage, weight /= 2) {
        double t = 0;
        for (Index j = 0; j < d; ++j) t += X(j, j);
        sum += weight * correctly::log2(t);
        for (double& x : X.reshaped()) x /= t;
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i <= j; ++i) {  // (1)
                double product = 0;
                for (Index k = 0; k < d; ++k) product += X(k, i) * X(k, j);
                square(i, j) = square(j, i) = product;
            }
        X = square;
    }
    Index longest = 0;
    for (Index j = 1; j < d; ++j)
        if (X(j, j) > X(longest, longest)) longest = j;
    double squares = 0;
    for (Index i = 0; i < d; ++i)
        squares += X(i, longest) / X(longest, longest) * (X(i, longest) / X(longest, longest));
    return {sum, X.col(longest) / X(longest, longest) / std::sqrt(squares)};
}

double condition(Records const& data, double forgetting) {
    if (data.rows() == 0) return infinity;
    constexpr int digits = 20;  // more than doubles, in which the norms are then found, can hold
    Problem<double> const problem{.size = data.parameters(), .forgetting = forgetting, .prior = std::nullopt};
    // y is replaced by zeros: the condition number does not depend on it, and it may contain an infinity or a NaN.
    Records const regressors{.psi = data.psi, .y = Vector<double>::Zero(data.rows()), .names = {}};
    CertifiedSolution const exact = certified(problem, regressors, {data.rows()}, digits).front();
    switch (exact.status()) {
        case Status::undefined: return nan;
        case Status::singular:
        case Status::unresolved: return infinity;
        case Status::certified: break;
    }
    auto const& enclosure = *exact.enclosure();
    WeightedGram sum(regressors, forgetting, data.rows(), 1, enclosure.bits);
    BallMatrix const gram = leading(sum.at(data.rows()), data.parameters());
    return correctly::exp2((dominant(gram).log2_value + dominant(enclosure.covariance).log2_value) / 2);
}

double relative_change(CertifiedSolution const& theta, CertifiedSolution const& from) {
    return relative_change(theta, from, Vector<double>::Ones(theta.size()));
}

namespace {

/// The change, and the vector that changes, in units of s.
struct Scaled {
    long bits;
    BallMatrix change, size;
};
std::optional<Scaled> scaled(CertifiedSolution const& theta, CertifiedSolution const& from, Vector<double> const& s) {
    expects(theta.size() == from.size() && s.size() == from.size(), "two solutions of one size");
    if (!theta.enclosure() || !from.enclosure()) return std::nullopt;
    auto const &a = *theta.enclosure(), &b = *from.enclosure();
    Scaled out{std::max(a.bits, b.bits), BallMatrix(a.theta.rows(), 1), b.theta};
    arb_mat_sub(out.change, a.theta, b.theta, out.bits);
    for (Index i = 0; i < s.size(); ++i) {
        Ball const unit(s[i]);
        arb_mul(out.change(i, 0), out.change(i, 0), unit, out.bits);
        arb_mul(out.size(i, 0), out.size(i, 0), unit, out.bits);
    }
    return out;
}
/// |change| / |size|: 0 for no change, infinity for a change of zero.
double ratio(Ball change, Ball const& size, long bits) {
    if (arb_is_zero(change)) return 0;
    if (arb_is_zero(size)) return infinity;
    arb_div(change, change, size, bits);
    return std::abs(arf_get_d(arb_midref(static_cast<arb_srcptr>(change)), ARF_RND_NEAR));
}

}  // namespace

double relative_change(CertifiedSolution const& theta, CertifiedSolution const& from, Vector<double> const& s) {
    auto const x = scaled(theta, from, s);
    return x ? ratio(norm(x->change, x->bits), norm(x->size, x->bits), x->bits) : nan;
}

double largest_relative_change(CertifiedSolution const& theta, CertifiedSolution const& from, Vector<double> const& s) {
    auto const x = scaled(theta, from, s);
    if (!x) return nan;
    Ball const all = norm(x->size, x->bits);
    double out = 0;
    for (Index i = 0; i < s.size(); ++i) {
        Ball size, change, least;
        arb_mul_2exp_si(least, all, arb_contains_zero(x->size(i, 0)) ? -20 : -40);
        arb_abs(size, x->size(i, 0));
        arb_set(change, x->change(i, 0));
        if (arf_cmp(arb_midref(static_cast<arb_srcptr>(size)), arb_midref(static_cast<arb_srcptr>(least))) < 0)
            size = least;
        out = std::max(out, ratio(change, size, x->bits));
    }
    return out;
}

}  // namespace rlslab
