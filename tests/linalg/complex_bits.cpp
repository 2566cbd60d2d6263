// Complex scalars in rounded arithmetic: the laws that hold bit for bit.
#include "tests/common/complex.hpp"

#include <rlslab/arithmetic/chopped.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {
using namespace complex_tests;

/// Law 2: psi -> i psi with y -> -i y leaves theta, P and gamma, and e -> -i e. No bit changes: a product with i only
/// exchanges parts, and a b has the bits of b a.
template <class F>
bool turns_with_i(Index d, bool prior) {
    using C = typename F::scalar;
    using R = RealOf<C>;
    Problem<C> start = problem<C>(d);
    if (!prior) start.prior = std::nullopt;
    F f(start), g(start);
    ComplexRows const rows = complex_rows(d, 30, 21);
    C const i(R(0), R(1)), minus_i(R(0), R(-1));
    for (size_t k = 0; k < rows.y.size(); ++k) {
        std::vector<C> const psi = as<C>(rows.psi[k]);
        std::vector<C> turned;
        for (C const& x : psi) turned.push_back(i * x);
        C const y = as<C>(rows.y[k]);
        Step<C> const a = f.update(psi, y), b = g.update(turned, minus_i * y);
        if (a.health != b.health || !(a.gamma == b.gamma)) return false;
        if (a.health == Health::sound &&
            !(b.innovation == minus_i * a.innovation && b.residual == minus_i * a.residual))
            return false;
    }
    return equal(Vector<C>(f.theta()), Vector<C>(g.theta())) && equal(f.stored().F, g.stored().F) &&
           equal(f.stored().D, g.stored().D);
}

/// Law 3: real data give the real filter's numbers, and imaginary parts of zero.
template <class F>
bool is_real_for_real_data(Index d, double scale) {
    using C = typename F::scalar;
    using R = RealOf<C>;
    F f(problem<C>(d));
    RealTwin<F> g(problem<R>(d));
    auto const same = [](C const& a, R const& b) { return a.re == b && a.im == R(0); };
    ComplexRows const rows = complex_rows(d, 30, 31, scale, true);
    for (size_t k = 0; k < rows.y.size(); ++k) {
        Step<C> const a = f.update(as<C>(rows.psi[k]), as<C>(rows.y[k]));
        Step<R> const b = g.update(as<R>(rows.psi[k]), as<R>(rows.y[k]));
        if (a.health != b.health) return false;
        if (a.health != Health::sound) return true;  // broken down alike
        if (!same(a.innovation, b.innovation) || !same(a.residual, b.residual) || !(a.gamma == b.gamma)) return false;
    }
    Vector<C> const theta = f.theta(), K = f.gain();
    Vector<R> const real = g.theta(), of_real = g.gain();
    for (Index j = 0; j < d; ++j)
        if (!same(theta[j], real[j]) || !same(K[j], of_real[j])) return false;
    auto const stored = f.stored();
    auto const real_stored = g.stored();
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i)
            if (!same(stored.F(i, j), real_stored.F(i, j))) return false;
    return equal(stored.D, real_stored.D);
}

template <class Real>
void bitwise_laws() {
    using C = Complex<Real>;
    for_each(Variants<C>{}, []<class F>() {
        for (Index const d : {1, 3, 9, 20}) {
            EXPECT_TRUE(turns_with_i<F>(d, true)) << F::name << " " << d;
            if constexpr (StartsWithoutPrior<F>) {
                EXPECT_TRUE(turns_with_i<F>(d, false)) << F::name << " " << d;
            }
            EXPECT_TRUE(is_real_for_real_data<F>(d, 1)) << F::name << " " << d;
        }
    });
}
TEST(Complex, LawsWithoutToleranceInDouble) { bitwise_laws<double>(); }
TEST(Complex, LawsWithoutToleranceInFloat) {
    bitwise_laws<float>();
    for_each(Variants<Complex<float>>{}, []<class F>() {  // where squares leave the range
        for (double const scale : {0x1p-72, 0x1p-66, 0x1p62, 0x1p70})
            EXPECT_TRUE(is_real_for_real_data<F>(9, scale)) << F::name << scale;
    });
}
TEST(Complex, LawsWithoutToleranceInBfloat16) { bitwise_laws<Chopped<bfloat16>>(); }

TEST(Complex, LawsWithoutToleranceFindTheirSaboteurs) {
    using C = Complex<double>;
    EXPECT_TRUE((turns_with_i<Plain<C, Broken::nothing>>(3, true)));
    for_each(BrokenFilters<C>{}, []<class F>() { EXPECT_FALSE(turns_with_i<F>(3, true)) << typeid(F).name(); });
    EXPECT_FALSE(
        (is_real_for_real_data<Plain<C, Broken::nothing>>(9, 1)));  // other order of sums than the real filter's
}

}  // namespace
}  // namespace rlslab
