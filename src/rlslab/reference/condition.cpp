// The condition number of weighted data, and the bias of a prior.
#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/reference/enclosure.hpp>
#include <rlslab/reference/gram.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rlslab {

using namespace balls;

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
    constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
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
    if (arb_is_zero(size)) return std::numeric_limits<double>::infinity();
    arb_div(change, change, size, bits);
    return std::abs(arf_get_d(arb_midref(static_cast<arb_srcptr>(change)), ARF_RND_NEAR));
}

}  // namespace

double relative_change(CertifiedSolution const& theta, CertifiedSolution const& from, Vector<double> const& s) {
    auto const x = scaled(theta, from, s);
    return x ? ratio(norm(x->change, x->bits), norm(x->size, x->bits), x->bits)
             : std::numeric_limits<double>::quiet_NaN();
}

double largest_relative_change(CertifiedSolution const& theta, CertifiedSolution const& from, Vector<double> const& s) {
    auto const x = scaled(theta, from, s);
    if (!x) return std::numeric_limits<double>::quiet_NaN();
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
