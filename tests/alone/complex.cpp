// Complex scalars in rounded arithmetic: what holds within a budget, what costs no heap, and what is refused.
#include "tests/common/complex.hpp"
#include "tests/alone/counted_heap.hpp"

#include <rlslab/adapt/delay_line.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/adapt/window.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {
using namespace complex_tests;

/// Law 4: X_ij and X_ji are conjugate, bit for bit, and the diagonal is real.
template <class X>
bool is_hermitian(X const& x) {
    for (Index j = 0; j < x.cols(); ++j)
        for (Index i = 0; i <= j; ++i)
            if (!(x(i, j) == conj(x(j, i)))) return false;
    return true;
}
template <class F>
F fed(Index d, Index rows, std::uint64_t seed) {
    using C = typename F::scalar;
    F f(problem<C>(d));
    ComplexRows const data = complex_rows(d, rows, seed);
    for (size_t k = 0; k < data.y.size(); ++k) f.update(as<C>(data.psi[k]), as<C>(data.y[k]));
    return f;
}

TEST(Complex, WhatIsHermitianIsSoToTheBit) {
    using C = Complex<double>;
    for (std::uint64_t const seed : {1u, 2u, 3u}) {
        EXPECT_TRUE(is_hermitian(fed<Symmetric<C>>(7, 40, seed).covariance()));
        EXPECT_TRUE(is_hermitian(fed<JosephRankTwo<C>>(7, 40, seed).covariance()));
        EXPECT_TRUE(is_hermitian(fed<Information<C>>(7, 40, seed).information()));
        EXPECT_TRUE(is_hermitian(fed<Potter<C>>(7, 40, seed).covariance()));
        EXPECT_TRUE(is_hermitian(fed<Carlson<C>>(7, 40, seed).covariance()));
        EXPECT_TRUE(is_hermitian(fed<InverseQr<C>>(7, 40, seed).covariance()));
        EXPECT_TRUE(is_hermitian(fed<ExtendedQr<C>>(7, 40, seed).covariance()));
        EXPECT_TRUE(is_hermitian(fed<Qr<C>>(7, 40, seed).information()));
        EXPECT_TRUE(is_hermitian(fed<QrBlock<C>>(7, 40, seed).information()));
        EXPECT_FALSE(is_hermitian(fed<Conventional<C>>(7, 40, seed).covariance()));
    }
    for_each(Variants<C>{}, []<class F>() {  // the diagonal of a triangular factor
        auto const stored = fed<F>(7, 40, 4).stored();
        if (stored.form == Stored<C>::Form::plain || F::name == "potter") return;
        for (Index j = 0; j < 7; ++j) EXPECT_EQ(stored.F(j, j).im, 0) << F::name;
    });
}

// --- within a budget -------------------------------------------------------------------------------------------------

/// Law 1 in double: distance of theta and of P (or P^-1) from the real filter of twice the size, in epsilons of their
/// norms, at lambda = 1.
template <class F>
double from_the_real_filter(Index d, std::uint64_t seed, bool prior) {
    using C = typename F::scalar;
    using R = RealOf<C>;
    Problem<C> start = problem<C>(d, 1);
    Problem<R> real = problem<R>(2 * d, 1);
    if (!prior) start.prior = std::nullopt, real.prior = std::nullopt;
    F f(start);
    RealTwin<F> g(real);
    ComplexRows const rows = complex_rows(d, 12 + 4 * d, seed);
    for (size_t k = 0; k < rows.y.size(); ++k) {
        std::vector<C> const psi = as<C>(rows.psi[k]);
        std::vector<R> first, second;
        for (C const& x : psi) first.push_back(x.re), second.push_back(-x.im);
        for (C const& x : psi) first.push_back(x.im), second.push_back(x.re);
        C const y = as<C>(rows.y[k]);
        f.update(psi, y);
        g.update(first, y.re);
        g.update(second, y.im);
    }
    Vector<C> const theta = f.theta();
    Vector<R> const pair = g.theta();
    Matrix<C> const X = multiplied_out(f.stored());
    Matrix<R> const pairs = multiplied_out(g.stored());
    double of_theta = 0, of_X = 0;
    auto const add = [](double& sum, double x, double y) { sum += (x - y) * (x - y); };
    for (Index j = 0; j < d; ++j) {
        add(of_theta, theta[j].re, pair[j]);
        add(of_theta, theta[j].im, pair[d + j]);
        for (Index i = 0; i < d; ++i) {
            add(of_X, X(i, j).re, pairs(i, j));
            add(of_X, X(i, j).im, pairs(d + i, j));
        }
    }
    double const worst =
        std::max(std::sqrt(of_theta) / pair.norm(), std::sqrt(of_X) / pairs.norm()) / epsilon<double>();
    return worst <= 1e30 ? worst : 1e30;
}
/// Each of n = 12 + 4d rows makes errors of a few epsilons in both filters; nothing is forgotten, so that they add. P
/// goes from 16 to about 1/(2n): the first rows' errors, relative to P then, are up to kappa = 32 n as large relative
/// to P now in the forms that subtract.
double budget(Index d) { return 32.0 * double(12 + 4 * d); }

TEST(Complex, IsTheRealFilterOfTwiceTheSize) {
    using C = Complex<double>;
    for_each(Variants<C>{}, []<class F>() {
        for (std::uint64_t const seed : {41u, 42u, 43u})
            for (Index const d : {1, 4, 9}) {
                EXPECT_LE(from_the_real_filter<F>(d, seed, true), budget(d)) << F::name << " " << d;
                if constexpr (StartsWithoutPrior<F>) {
                    EXPECT_LE(from_the_real_filter<F>(d, seed, false), budget(d)) << F::name << " " << d;
                }
            }
    });
    EXPECT_LE((from_the_real_filter<Plain<C, Broken::nothing>>(4, 41, true)), budget(4));
    for_each(BrokenFilters<C>{},
             []<class F>() { EXPECT_GT(from_the_real_filter<F>(4, 41, true), budget(4)) << typeid(F).name(); });
}

TEST(Complex, BlocksAreTheirRows) {
    using C = Complex<double>;
    QrBlock<C> blocks(problem<C>(4)), rows(problem<C>(4)),
        part({.size = 4, .forgetting = 0.9375, .prior = std::nullopt});
    QrBlock<C> merged = rows;
    ComplexRows const data = complex_rows(4, 20, 51);
    Matrix<C> psi(4, 20);
    Vector<C> y(20);
    for (Index k = 0; k < 20; ++k) {
        for (Index i = 0; i < 4; ++i) psi(i, k) = data.psi[size_t(k)][size_t(i)];
        y[k] = data.y[size_t(k)];
        rows.update({psi.col(k).data(), 4}, y[k]);
        (k < 9 ? merged : part).update({psi.col(k).data(), 4}, y[k]);
    }
    EXPECT_EQ(blocks.update_block(psi, y), Health::sound);
    merged.merge(part);
    for (Index i = 0; i < 4; ++i) {  // a few roundings a row, 16 rows in memory
        EXPECT_LE(std::abs(std::complex<double>(blocks.theta()[i] - rows.theta()[i])), 100 * epsilon<double>());
        EXPECT_LE(std::abs(std::complex<double>(merged.theta()[i] - rows.theta()[i])), 100 * epsilon<double>());
    }
}

/// P by the factors of one form, handed to another: of P, of its inverse, by a unit triangle or a root.
template <class To, class F>
double handed_over(F const& from) {
    using C = typename F::scalar;
    Problem<C> start = problem<C>(5);
    start.prior->stored = from.stored();
    To const to(start);
    auto const product = [](Matrix<C> const& a, Matrix<C> const& b) {  // a b - I
        double out = 0;
        for (Index j = 0; j < 5; ++j)
            for (Index i = 0; i < 5; ++i) {
                C sum(i == j ? -1 : 0);
                for (Index k = 0; k < 5; ++k) sum += a(i, k) * b(k, j);
                out += absolute_square(sum);
            }
        return std::sqrt(out) / epsilon<double>();
    };
    Matrix<C> const A = multiplied_out(from.stored()), B = multiplied_out(to.stored());
    if (from.stored().quantity != to.stored().quantity) return product(A, B);
    double distance = 0, of = 0;
    for (Index j = 0; j < 5; ++j)
        for (Index i = 0; i < 5; ++i) distance += absolute_square(A(i, j) - B(i, j)), of += absolute_square(A(i, j));
    return std::sqrt(distance / of) / epsilon<double>();
}
TEST(Complex, APriorMayBeWhatAnotherFormStores) {
    using C = Complex<double>;
    for_each(Variants<C>{}, []<class F>() {
        F const from = fed<F>(5, 20, 55);
        if (F::name == "potter") {  // a full square root
            EXPECT_THROW(handed_over<Ud<C>>(from), std::invalid_argument);
            return;
        }
        // A few roundings an entry. Plain storage: the factors read one triangle, and the other differs from it by
        // rounding errors, which one vector for row and column makes grow by lambda^-20.
        bool const grows = F::name == "conventional" || F::name == "kalman";
        double const budget = grows ? 1e4 : F::name == "conventional_two_sided" || F::name == "joseph" ? 500 : 20;
        for_each(TypeList<Ud<C>, Symmetric<C>, Carlson<C>, Qr<C>, Gentleman<C>, Information<C>>{},
                 [&]<class To>() { EXPECT_LE(handed_over<To>(from), budget) << F::name << " to " << To::name; });
    });
}

// --- state, health, heap, what is refused ----------------------------------------------------------------------------

TEST(Complex, IsSavedAndLoaded) {
    using C = Complex<float>;
    for_each(Variants<C>{}, []<class F>() {
        F f = fed<F>(5, 20, 61), g(problem<C>(5));
        auto const bytes = state_of(f);
        ASSERT_EQ(load(g, bytes), StateFault::none) << F::name;
        ComplexRows const rows = complex_rows(5, 5, 62);
        for (size_t k = 0; k < 5; ++k) {
            f.update(as<C>(rows.psi[k]), as<C>(rows.y[k]));
            g.update(as<C>(rows.psi[k]), as<C>(rows.y[k]));
        }
        EXPECT_EQ(state_of(f), state_of(g)) << F::name;
        RealTwin<F> real(problem<float>(5));
        EXPECT_EQ(load(real, bytes), StateFault::arithmetic) << F::name;
    });
    EXPECT_EQ(ArithmeticTraits<C>::name, "complex float");
}

TEST(Complex, WhatIsNotFiniteIsSaid) {
    using C = Complex<double>;
    for_each(Variants<C>{}, []<class F>() {
        for (double const bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
            for (int const where : {0, 1, 2, 3}) {
                F f = fed<F>(3, 10, 71);
                std::vector<C> psi{C(1), C(2), C(3)};
                C y(1);
                (where < 2 ? psi[1].re : y.re) = where % 2 == 0 ? bad : (where < 2 ? 2 : 1);
                (where < 2 ? psi[1].im : y.im) = where % 2 == 1 ? bad : 0;
                EXPECT_EQ(f.update(psi, y).health, Health::nonfinite) << F::name << " " << bad << " " << where;
            }
        EXPECT_THROW(F(problem<C>(3)).update({C(1), C(2)}, C(0)), std::invalid_argument);
    });
    Problem<C> skew = problem<C>(2);
    skew.prior->covariance = Matrix<C>::Identity(2, 2);
    (*skew.prior->covariance)(0, 0) = C(1, 0.5);
    EXPECT_THROW(Ud<C>{skew}, std::invalid_argument);
    (*skew.prior->covariance)(0, 0) = C(1);
    (*skew.prior->covariance)(0, 1) = (*skew.prior->covariance)(1, 0) = C(0, 0.5);
    EXPECT_THROW(Ud<C>{skew}, std::invalid_argument);
    (*skew.prior->covariance)(1, 0) = C(0, -0.5);
    EXPECT_NO_THROW(Ud<C>{skew});
}

TEST(Complex, UpdatesDoNotAllocate) {
    ComplexRows const rows = complex_rows(4, 30, 81);
    for_each(Variants<Complex<float>>{}, [&]<class F>() {
        using C = Complex<float>;
        auto const of_updates = [&rows](auto& f) {
            std::array<std::complex<float>, 4> psi;
            long const before = allocations;
            for (size_t k = 0; k < rows.y.size(); ++k) {
                for (size_t i = 0; i < 4; ++i) psi[i] = std::complex<float>(rows.psi[k][i]);
                f.update(psi, std::complex<float>(rows.y[k]));
            }
            return allocations - before;
        };
        F dynamic(problem<C>(4));
        EXPECT_EQ(of_updates(dynamic), 0) << F::name;
        Problem<C> const start = problem<C>(4);
        long const before = allocations;
        AtSize<F, 4> fixed(start);
        EXPECT_EQ(allocations - before, 0) << F::name;
        EXPECT_EQ(of_updates(fixed), 0) << F::name;
        EXPECT_TRUE(equal(Vector<C>(dynamic.theta()), Vector<C>(fixed.theta()))) << F::name;
    });
}

/// y = psi'theta: a filter d = w^H u is psi = conj(u), theta = conj(w).
TEST(Complex, AnEchoCanceller) {
    std::complex<float> const path[3]{{1, -0.5f}, {0, 0.25f}, {-0.125f, 0}};  // d_k = sum conj(path_i) u_{k-i}
    Ud<Complex<float>, 3> filter({.forgetting = 0.99f});
    DelayLine<Complex<float>, 3> line;
    ComplexRows const signal = complex_rows(1, 100, 91);
    std::complex<float> u[102]{};
    for (size_t k = 2; k < 102; ++k) {
        u[k] = std::complex<float>(signal.psi[k - 2][0]);
        std::complex<float> d = 0;
        for (size_t i = 0; i < 3; ++i) d += std::conj(path[i]) * u[k - i];
        std::complex<float> const e = filter.update(line.push(std::conj(u[k])), d).innovation;
        EXPECT_LT(k > 50 ? std::abs(e) : 0, 1e-3f);  // P0 = 2^14 and float: theta to about 1e-4
    }
    for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(std::conj(std::complex<float>(filter.theta()[i])) - path[i]), 1e-3f);
}

template <template <class...> class Around, class F>
concept GoesAround = requires { typename Around<F>; };
template <class T>
concept HasUd = requires { typename Ud<T>; };
template <class F>
concept Multiplies = requires { typename MultiOutput<F, 2>; };

static_assert(GainPerturbable<Ud<Complex<float>, 3>> && StartsWithoutPrior<Qr<Complex<double>>> &&
              Merges<QrBlock<Complex<double>>>);
static_assert(!Field<Complex<double>> && !Real<Complex<double>> && !HasUd<std::complex<float>> &&
              HasUd<Complex<float>>);
static_assert(!std::convertible_to<double, Complex<double>> && !std::convertible_to<Complex<double>, double>);
static_assert(std::convertible_to<std::complex<float>, Complex<float>> &&
              std::convertible_to<Complex<float>, std::complex<float>>);
static_assert(!TimeUpdates<Ud<Complex<double>>> && !Inflates<Ud<Complex<double>>> && !Downdates<Ud<Complex<double>>>);
static_assert(!Guardable<Ud<Complex<double>>> && !ReportsVariances<Ud<Complex<double>>> &&
              !Multiplies<Ud<Complex<double>>>);
static_assert(GoesAround<Windowed, Ud<double>> && !GoesAround<Windowed, Ud<Complex<double>>>);
static_assert(GoesAround<Weighted, Ud<double>> && !GoesAround<Weighted, Ud<Complex<double>>>);

}  // namespace
}  // namespace rlslab
