// Complex scalars in exact arithmetic: the real filter of twice the size on the real rows, and the normal equations,
// with ==.
#include "tests/common/complex.hpp"

#include <rlslab/adapt/time_update.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {
using namespace complex_tests;
using Q = Rational;
using C = Complex<Q>;
constexpr Index d = 3;

/// theta0, and a P0 that is Hermitian and definite: G G' + I, G of small whole numbers.
Prior<C> whole_prior() {
    Prior<C> out{.theta = Vector<C>(d), .covariance = Matrix<C>(d, d)};
    Matrix<C> G(d, d);
    for (Index j = 0; j < d; ++j) {
        (*out.theta)[j] = C(Q(int(j) - 1), Q(2 - int(j)));
        for (Index i = 0; i < d; ++i) G(i, j) = C(Q(int(i + 2 * j) % 3 - 1), Q(int(2 * i + j) % 4 - 1));
    }
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i) {
            C sum(i == j ? 1 : 0);
            for (Index k = 0; k < d; ++k) sum += G(i, k) * conj(G(j, k));
            (*out.covariance)(i, j) = sum;
        }
    return out;
}
/// (Re x; Im x), and [[Re A, -Im A], [Im A, Re A]].
Vector<Q> over_reals(Vector<C> const& x) {
    Vector<Q> out(2 * x.size());
    for (Index i = 0; i < x.size(); ++i) out[i] = x[i].re, out[x.size() + i] = x[i].im;
    return out;
}
Matrix<Q> over_reals(Matrix<C> const& A) {
    Index const n = A.rows();
    Matrix<Q> out(2 * n, 2 * n);
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) {
            out(i, j) = out(n + i, n + j) = A(i, j).re;
            out(n + i, j) = A(i, j).im;
            out(i, n + j) = -A(i, j).im;
        }
    return out;
}

/// Law 1: with psi = a + ib, (psi'theta) is the pair of rows (a, b), (-b, a) of a real filter for (Re theta; Im theta),
/// time passing once a pair. theta, P, J and the product of the two gammas are the same. Forms whose time does not pass
/// by itself are tried at lambda = 1.
template <class F>
bool is_the_real_filter() {
    using R = RealTwin<F>;
    Q const lambda = NamesItsForm<R> ? Q(15) / 16 : Q(1);
    Problem<C> const problem{.size = d, .forgetting = lambda, .prior = whole_prior()};
    Problem<Q> const real{.size = 2 * d,
                          .forgetting = lambda,
                          .prior = Prior<Q>{.theta = over_reals(*problem.prior->theta),
                                            .covariance = over_reals(*problem.prior->covariance)}};
    F f(problem);
    R g(real);
    ComplexRows const rows = complex_rows(d, 4, 11);
    for (size_t k = 0; k < rows.y.size(); ++k) {
        std::vector<C> const psi = as<C>(rows.psi[k]);
        C const y = as<C>(rows.y[k]);
        std::vector<Q> first(2 * d), second(2 * d);
        for (size_t i = 0; i < size_t(d); ++i) {
            first[i] = second[d + i] = psi[i].re;
            first[d + i] = psi[i].im;
            second[i] = -psi[i].im;
        }
        Step<C> const step = f.update(psi, y);
        Step<Q> const one = g.update(first, y.re);
        Step<Q> two;
        if constexpr (NamesItsForm<R>) two = measure(g, second, y.im, Q(1), lambda);
        else two = g.update(second, y.im);
        if (step.health != Health::sound || two.health != Health::sound) return false;
        Q const J = step.gamma * absolute_square(step.innovation);
        Q const halves = one.gamma * one.innovation * one.innovation + two.gamma * two.innovation * two.innovation;
        if (!(step.gamma * step.gamma == one.gamma * two.gamma) || !(J == halves)) return false;
        if (!(over_reals(Vector<C>(f.theta())) == Vector<Q>(g.theta()))) return false;
    }
    return over_reals(multiplied_out(f.stored())) == multiplied_out(g.stored());
}

TEST(ComplexExact, IsTheRealFilterOfTwiceTheSize) {
    for_each(Variants<C>{}, []<class F>() { EXPECT_TRUE(is_the_real_filter<F>()) << F::name; });
    EXPECT_TRUE((is_the_real_filter<Plain<C, Broken::nothing>>()));
}
TEST(ComplexExact, WhichFindsEachMissingConjugate) {
    for_each(BrokenFilters<C>{}, []<class F>() { EXPECT_FALSE(is_the_real_filter<F>()) << typeid(F).name(); });
}

/// Law 5: X theta = b and X K = psi for X = lambda^n P0^-1 + sum lambda^(n-k) psi psi', b = lambda^n P0^-1 theta0 + sum
/// lambda^(n-k) psi y, P0 = 4 I. Nothing is solved: what the filter answers is put in.
template <class F>
bool solves_the_normal_equations() {
    Q const lambda = Q(7) / 8;
    Prior<C> prior{.variance = Q(4), .theta = whole_prior().theta};
    F f({.size = d, .forgetting = lambda, .prior = prior});
    Matrix<C> X = Matrix<C>::Zero(d, d);
    Vector<C> b(d);
    for (Index i = 0; i < d; ++i) {
        X(i, i) = C(Q(1) / 4);
        b[i] = (*prior.theta)[i] / Q(4);
    }
    ComplexRows const rows = complex_rows(d, 7, 12);
    Vector<C> last(d);
    for (size_t k = 0; k < rows.y.size(); ++k) {
        std::vector<C> const psi = as<C>(rows.psi[k]);
        C const y = as<C>(rows.y[k]);
        f.update(psi, y);
        for (Index j = 0; j < d; ++j) {
            for (Index i = 0; i < d; ++i) X(i, j) = lambda * X(i, j) + psi[size_t(i)] * conj(psi[size_t(j)]);
            b[j] = lambda * b[j] + psi[size_t(j)] * y;
            last[j] = psi[size_t(j)];
        }
    }
    auto const times = [&X](Vector<C> const& x) {
        Vector<C> out(d);
        for (Index i = 0; i < d; ++i) {
            out[i] = C(0);
            for (Index j = 0; j < d; ++j) out[i] += X(i, j) * x[j];
        }
        return out;
    };
    return times(f.theta()) == b && times(f.gain()) == last;
}

TEST(ComplexExact, SolvesTheNormalEquations) {
    for_each(Variants<C>{}, []<class F>() { EXPECT_TRUE(solves_the_normal_equations<F>()) << F::name; });
    EXPECT_TRUE((solves_the_normal_equations<Plain<C, Broken::nothing>>()));
    EXPECT_FALSE((solves_the_normal_equations<Plain<C, Broken::innovation>>()));
    EXPECT_FALSE((solves_the_normal_equations<Plain<C, Broken::covariance>>()));
    EXPECT_FALSE((solves_the_normal_equations<Plain<C, Broken::gain>>()));
}

}  // namespace
}  // namespace rlslab
