// Theorems of docs/theory.md: one quadratic for every gain law (111), definiteness of the sweeps under any error and
// rounding (112), the rounded root of lambda (117), fused products (118).
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/variants.hpp>

#include <rlslab/studies/rationals.hpp>
#include "tests/variants/gain_laws.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rlslab {
namespace {

using namespace gain_laws;

// --- 111 -------------------------------------------------------------------------------------------------------------

/// w and c of delta P = (-(delta w' + w delta') + c delta delta') / lambda.
template <class T>
struct Quadratic {
    Vector<T> w;
    T c;
};
template <class F>
Quadratic<typename F::scalar> quadratic(Case<typename F::scalar> const& c, Index j) {
    using T = typename F::scalar;
    if constexpr (F::name == "joseph" || F::name == "joseph_rank_two") return {Vector<T>::Zero(c.size), c.s};
    else if constexpr (F::name == "potter") {
        T const rho = square_root(T(c.lambda / c.s));
        return {c.K * T(rho / (1 + rho)), (1 - rho) / (1 + rho) / c.s};
    } else return {c.K - c.gain_after[size_t(j)], T(1) / c.s_after[size_t(j)] - T(1) / c.s};
}
/// The even and the odd part in delta of what F leaves, against the table's c and w.
template <class F>
constexpr bool sweeps = F::name == "ud" || F::name == "carlson" || F::name == "inverse_qr" || F::name == "extended_qr";
template <class F>
auto off_the_table(int n) {
    using T = typename F::scalar;
    Case<T> const c(Seed{std::uint64_t(n)});
    T out = T(0);
    for (Index j = 1; j <= (sweeps<F> ? c.size : 1); ++j) {
        Vector<T> delta = c.delta;
        auto const with = [&](T const& sign) {
            Vector<T> const error = sign * delta;
            if constexpr (sweeps<F>) return after<F>(c, AddAfterColumn<T>{error * running_scale<F>(c, j), j});
            else return after<F>(c, AddToGain<T>{error});
        };
        if (sweeps<F>)
            for (Index i = j; i < c.size; ++i) delta[i] = T(0);
        Matrix<T> const up = with(T(1)), down = with(T(-1)), none = c.P_next;
        auto const [w, square] = quadratic<F>(c, j);
        out = std::max<T>(out, largest<T>((up - down) / T(2) + (outer<T>(delta, w) + outer<T>(w, delta)) / c.lambda));
        out = std::max<T>(out, largest<T>((up + down) / T(2) - none - square / c.lambda * outer<T>(delta, delta)));
    }
    return out;
}
TEST(Theorems, OneQuadraticHasEveryGainLaw) {
    for (int n = 0; n < 40; ++n) {
        for_each(TypeList<Joseph<Rational>, JosephRankTwo<Rational>, Ud<Rational>>{},
                 [&]<class F>() { EXPECT_EQ(off_the_table<F>(n), 0) << F::name << n; });
        for_each(TypeList<Potter<Reference>, Carlson<Reference>, InverseQr<Reference>, ExtendedQr<Reference>>{},
                 [&]<class F>() { EXPECT_LE(off_the_table<F>(n), Reference("1e-60")) << F::name << n; });
    }
}

// --- 112 -------------------------------------------------------------------------------------------------------------

template <Rounding R>
using Tiny = Chopped<Format{4, -8, 8}, R>;
constexpr double least_number = 0x1p-11;  // of that format

/// The numbers whose sign decides, after rows with an error of any size in the running vector; and how often each end
/// of the clause was met.
struct Ends {
    int definite = 0, outside = 0, zero = 0;
};
template <class F>
Ends sweep_with_any_error(int cases) {
    using T = typename F::scalar;
    constexpr Index d = 3;
    Seed seed{9}, noise{10};
    StochasticStream const stream(noise);
    Ends out;
    auto const any = [&](int from, int to) {
        double const size = std::ldexp(1 + double(seed.next() % 8) / 8, from + int(seed.next() % unsigned(to - from)));
        return T(seed.next() % 2 ? size : -size);
    };
    for (int n = 0; n < cases; ++n) {
        F filter(Problem<T>{.size = d, .forgetting = T(n % 2 ? 1 : 0.8125), .prior = Prior<T>{.variance = T(1)}});
        Vector<T> psi(d), kept(d);
        if constexpr (F::name == "ud" || F::name == "ud_delta") {
            auto const state = F::state(filter);
            for (Index j = 0; j < d; ++j) {
                kept[j] = std::get<3>(state)[j] = abs(any(-11, 4));
                for (Index i = 0; i < j; ++i) std::get<5>(state)(i, j) = any(-4, 3);
            }
        } else if constexpr (F::name != "extended_qr") {
            auto const state = F::state(filter);
            auto& S = std::get < F::name == "inverse_qr" ? 3 : 4 > (state);
            for (Index j = 0; j < d; ++j) {
                kept[j] = S(j, j) = abs(any(-11, 3));
                for (Index i = 0; i < j; ++i) S(i, j) = any(-4, 3);
            }
        } else {
            auto& L = std::get<5>(ExtendedQr<T>::state(filter));  // R', and then W'
            auto& S = std::get<6>(ExtendedQr<T>::state(filter));
            for (Index j = 0; j < d; ++j) {
                L(j, j) = abs(any(-11, 6)), S(j, j) = abs(any(-11, 5));
                kept[j] = T(std::min(1.0, double(S(j, j))) * double(L(j, j)) / 4);  // c_j has R_jj too
                for (Index i = 0; i < j; ++i) L(j, i) = any(-4, 3), S(i, j) = any(-4, 3);
            }
        }
        for (T& x : psi) x = any(-6, 5);
        Step<T> const step = filter.update(psi, T(1), [&](std::span<T> v, T const&) {
            for (T& x : v) x = any(-8, 8);
        });
        Stored<T> const stored = filter.stored();
        bool finite = true, positive = true, reached = false;
        for (Index j = 0; j < d; ++j) {
            double const now = double(F::name.starts_with("ud") ? stored.D[j] : stored.F(j, j));
            finite = finite && std::isfinite(now);
            positive = positive && now > 0;
            if constexpr (F::name == "extended_qr") {
                double const R = double(std::get<5>(F::state(filter))(j, j));
                finite = finite && std::isfinite(R), positive = positive && R > 0;
            }
            if (double(kept[j]) < 0x1p10 * least_number) reached = true;  // s < 2^9
            out.zero += now == 0;
        }
        if (!finite || !(double(step.gamma) > 0)) ++out.outside;  // s overflowed, or lambda / s underflowed
        else if (positive) ++out.definite;
        else EXPECT_TRUE(reached) << F::name << n << ": a number that did not underflow";
    }
    return out;
}
TEST(Theorems, SweepsStayDefiniteUnderAnyErrorShortOfUnderflow) {
    for_each(TypeList<Tiny<Rounding::nearest>, Tiny<Rounding::toward_zero>, Tiny<Rounding::stochastic>>{},
             []<class T>() {
                 Ends const ud = sweep_with_any_error<Ud<T>>(20000), carlson = sweep_with_any_error<Carlson<T>>(20000),
                            rotations = sweep_with_any_error<InverseQr<T>>(20000),
                            both = sweep_with_any_error<ExtendedQr<T>>(20000);
                 for (Ends const& ends : {ud, carlson, rotations, both}) EXPECT_GT(ends.definite, 1000);
                 for (Ends const& ends : {ud, both}) EXPECT_GT(ends.zero, 0) << "the clause is needed";
                 for (Ends const& ends :
                      {sweep_with_any_error<UdDelta<T>>(20000), sweep_with_any_error<CarlsonDelta<T>>(20000),
                       sweep_with_any_error<InverseQrDelta<T>>(20000)})
                     EXPECT_GT(ends.definite, 1000);  // the paper's sentence on the difference forms
             });
}
/// The clause itself: a D that underflows is lost, and no error is needed for it.
TEST(Theorems, WithoutTheClauseADiagonalUnderflows) {
    using T = Tiny<Rounding::nearest>;
    Ud<T> filter(Problem<T>{.size = 1, .prior = Prior<T>{.variance = T(least_number)}});
    Vector<T> psi(1);
    psi[0] = T(0x1.8p8);  // s = 1 + 72
    filter.update(psi, T(1));
    EXPECT_EQ(double(filter.stored().D[0]), 0);
}
/// In extended_qr no product with W and no quotient is rounded here: sqrt(lambda) R_11 is, to 0.
TEST(Theorems, WithoutTheClauseARootOfLambdaTimesRUnderflows) {
    using T = Tiny<Rounding::toward_zero>;
    ExtendedQr<T> filter(Problem<T>{.size = 1, .forgetting = T(0.8125), .prior = Prior<T>{.variance = T(1)}});
    std::get<5>(ExtendedQr<T>::state(filter))(0, 0) = T(least_number);
    Vector<T> psi(1);
    psi[0] = T(1);
    filter.update(psi, T(1));
    EXPECT_EQ(double(filter.stored().F(0, 0)), 0);
}
/// Errors that a sweep shrugs off make an end of what subtracts.
TEST(Theorems, WhatSubtractsIsNotDefiniteUnderAnyError) {
    int indefinite = 0;
    for (int n = 0; n < 40; ++n) {
        Case<Rational> const c(Seed{std::uint64_t(n)});
        auto const definite = [&](Matrix<Rational> const& P) {
            return studies::rationals::is_positive_definite(P + P.transpose());
        };
        Vector<Rational> const huge = Rational(1000) * c.K;
        indefinite += !definite(after<Symmetric<Rational>>(c, AddToGain<Rational>{huge}));
        EXPECT_TRUE(definite(after<Ud<Rational>>(c, AddAfterColumn<Rational>{huge.head(1), 1})));
    }
    EXPECT_EQ(indefinite, 40);
}

// --- 117 -------------------------------------------------------------------------------------------------------------

template <int p>
void examine_roots(double& of_law, double& of_two_u, double& without_division) {
    using T = Chopped<Format{p, -100, 100}>;
    double const u = std::ldexp(1, -p);
    for (double lambda = 0.25; lambda < 1; lambda += lambda < 0.5 ? u / 2 : u) {
        double const root = double(sqrt(T(lambda))), c = double(DivisorNearOne<T>(T(root)).correction());
        EXPECT_TRUE((root - u / 2) * (root - u / 2) <= lambda && lambda <= (root + u / 2) * (root + u / 2)) << lambda;
        double const off = std::abs(root * root / lambda - 1), divided = std::abs(1 / ((1 + c) * (1 + c)) / lambda - 1);
        double const law = u / std::sqrt(lambda) + u * u / (4 * lambda), half = 1 + u / (2 * std::sqrt(lambda)),
                     rest = 1 - (1 - root) * u;
        EXPECT_LE(off, law * (1 + 1e-12)) << lambda;
        EXPECT_LE(off, 2 * u + u * u) << lambda;
        EXPECT_LE(divided, (half * half) / (rest * rest) - 1 + 1e-14) << lambda;
        of_law = std::max(of_law, off / law);
        of_two_u = std::max(of_two_u, off / (2 * u + u * u));
        without_division = std::max(without_division, divided / law);
    }
}
TEST(Theorems, TheRoundedRootOfLambdaIsOffByLessThanTwoU) {
    double of_law = 0, of_two_u = 0, without_division = 0;
    examine_roots<4>(of_law, of_two_u, without_division);
    examine_roots<8>(of_law, of_two_u, without_division);
    examine_roots<11>(of_law, of_two_u, without_division);
    EXPECT_GT(without_division, 1) << "what is applied is (1 + c)^-2";
    EXPECT_GT(of_law, 0.9);
    EXPECT_GT(of_two_u, 0.9);
}
/// P = (1 - l)/psi^2 and l''/l in front: the fixed points with l'' for l, exactly.
TEST(Theorems, TheBiasOfPInTheSteadyStateIsExact) {
    for (int n = 1; n < 20; ++n) {
        Rational const lambda = Rational(90 + n) / 110, eps = Rational(n % 2 ? n : -n) / 5000,
                       rounded = lambda * (1 + eps), psi2 = Rational(n) / 3;
        Rational const ideal = (1 - lambda) / psi2, first = (1 - rounded) / psi2,
                       second = lambda * (1 - rounded) / (rounded * psi2);
        EXPECT_EQ(first / (rounded + psi2 * first), first);                       // inverse_qr: l'' throughout
        EXPECT_EQ(lambda / rounded * second / (lambda + psi2 * second), second);  // potter, carlson: in the division
        EXPECT_EQ(first / ideal - 1, -lambda * eps / (1 - lambda));
        EXPECT_EQ(second / ideal - 1, -eps / ((1 - lambda) * (1 + eps)));
    }
}

// --- 118 -------------------------------------------------------------------------------------------------------------

/// fl(x_i g_j + g_i x_j) and its mirror image by one fused product each.
TEST(Theorems, FusedProductsAreAntisymmetricByOneRoundingEachSide) {
    constexpr int p = 5;
    using T = Chopped<Format{p, -100, 100}>;
    double const u = std::ldexp(1, -p);
    double most = 0;
    int equal = 0, unequal = 0;
    for (int xi = 16; xi < 32; ++xi)
        for (int gj = 16; gj < 32; ++gj)
            for (int gi = 16; gi < 32; ++gi)
                for (int xj = 16; xj < 32; ++xj)
                    for (double const scale : {1.0, 2.0, -1.0, -2.0, -0.5}) {
                        double const a = xi * gj, b = scale * gi * xj;
                        double const above = double(T(double(T(a)) + b)), below = double(T(double(T(b)) + a));
                        double const room = u * (std::abs(a) + std::abs(b) + std::abs(above) + std::abs(below));
                        double const apart = std::abs(above - below);
                        ASSERT_LE(apart, room);
                        most = std::max(most, apart / room);
                        (apart == 0 ? equal : unequal) += 1;
                        ASSERT_EQ(T(a) + T(b), T(b) + T(a));  // each product rounded: the same number
                    }
    EXPECT_GT(most, 0.5);
    EXPECT_GT(unequal, equal / 100);
}
/// What is subtracted meets E nowhere: E_k = E_{k-1} / lambda plus those roundings, so that nothing damps it.
TEST(Theorems, FusedAntisymmetryIsOnlyDivided) {
    using T = Chopped<Format{11, -126, 127}>;
    constexpr double u = 0x1p-11, lambda = 0.9375;
    constexpr Index d = 3;
    DivisorNearOne<T> const by_lambda{T(lambda)};
    Eigen::MatrixXd P = Eigen::MatrixXd::Identity(d, d);
    Seed seed{2};
    double most = 0;
    for (int k = 0; k < 100; ++k) {
        Eigen::MatrixXd const before = P;
        double x[d], g[d];
        for (Index i = 0; i < d; ++i) x[i] = double(T(seed.bell() / 16)), g[i] = double(T(seed.bell() / 32));
        Eigen::MatrixXd t(d, d), left(d, d);
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i) {
                t(i, j) = double(T(double(T(x[i] * g[j])) + g[i] * x[j]));
                left(i, j) = double(T(before(i, j)) - T(t(i, j)));
                P(i, j) = double(by_lambda(T(left(i, j))));
            }
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < j; ++i) {
                double const apart = P(i, j) - P(j, i) - (before(i, j) - before(j, i)) / lambda;
                double const room = (u * (std::abs(x[i] * g[j]) + std::abs(g[i] * x[j]) + std::abs(t(i, j)) +
                                          std::abs(t(j, i)) + std::abs(left(i, j)) + std::abs(left(j, i))) +
                                     2 * u / (1 - 2 * u) * (std::abs(left(i, j)) + std::abs(left(j, i)))) /
                                    lambda;
                EXPECT_LE(std::abs(apart), room) << k;
                most = std::max(most, std::abs(apart) / room);
            }
    }
    EXPECT_GT(most, 0.1);
}

}  // namespace
}  // namespace rlslab
