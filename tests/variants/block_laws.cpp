// The laws of a block of rows (docs/theory.md 132, 133), in rationals.
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/core/type_list.hpp>
#include <rlslab/studies/rationals.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rlslab {
namespace {

using namespace studies::rationals;

M prime(M const& A) { return A.transpose(); }
M product(M const& A, M const& B) { return A.lazyProduct(B); }
M whole_numbers(Index rows, Index columns, Seed& seed) {
    M out(rows, columns);
    for (Index j = 0; j < columns; ++j) out.col(j) = integers(rows, seed, 4);
    return out;
}
M symmetric(Index d, Seed& seed) {
    M const A = whole_numbers(d, d, seed);
    return A + prime(A);
}

/// P, X and Lambda = diag(lambda, lambda^2, ...) of small numbers, and the exact step.
struct Block {
    Index d, k;
    Q lambda, weight = 1;
    M P, X, Lambda, G, S, K;
    explicit Block(Seed seed)
        : d(1 + Index(seed.next() % 4)), k(1 + Index(seed.next() % 4)), lambda(Q(int(1 + seed.next() % 6)) / 6),
          P(M::Identity(d, d) / Q(4)), X(whole_numbers(d, k, seed)), Lambda(M::Zero(k, k)) {
        M const A = whole_numbers(d, d, seed);
        P += product(A, prime(A));
        for (Index j = 0; j < k; ++j) Lambda(j, j) = weight *= lambda;
        G = product(P, X), S = Lambda + product(prime(X), G), K = product(G, inverse(S));
    }
    M joseph(M const& K_, M const& G_, M const& S_) const {
        M const F = G_ - product(K_, S_) / Q(2);
        return P - product(K_, prime(F)) - product(F, prime(K_));
    }
};

TEST(BlockLaws, AnErrorOfTheGainEntersJosephsBlockByItsSquareAloneAndIsNeverNegative) {
    for (std::uint64_t n = 0; n < 40; ++n) {
        Block const b{Seed{n}};
        Seed seed{100 + n};
        M const delta = whole_numbers(b.d, b.k, seed), K = b.K + delta;
        JosephRankTwo<Q> filter(
            {.size = b.d, .forgetting = b.lambda, .prior = Prior<Q>{.covariance = std::optional<M>(b.P)}});
        BlockGain<Q> gain;
        filter.update_block(b.X, V(V::Zero(b.k)), gain, [&](auto&& mine) {
            for (Index j = 0; j < b.k; ++j)
                for (Index i = 0; i < b.d; ++i) mine(i, j) += delta(i, j);
        });
        M const next = (b.P - product(b.K, prime(b.G))) / b.weight, got = filter.covariance();
        EXPECT_EQ(got, M(next + product(product(delta, b.S), prime(delta)) / b.weight)) << n;
        EXPECT_TRUE(is_positive_definite(got)) << n;
        M const A = M::Identity(b.d, b.d) - product(K, prime(b.X));
        EXPECT_EQ(got, M((product(product(A, b.P), prime(A)) + product(product(K, b.Lambda), prime(K))) / b.weight));
    }
}
TEST(BlockLaws, AnErrorOfGOrSEntersJosephsBlockInFirstOrder) {
    for (std::uint64_t n = 0; n < 40; ++n) {
        Block const b{Seed{n}};
        Seed seed{200 + n};
        M const delta = whole_numbers(b.d, b.k, seed), g = whole_numbers(b.d, b.k, seed), s = symmetric(b.k, seed),
                K = b.K + delta;
        M const law = b.joseph(b.K, b.G, b.S) + product(product(delta, b.S), prime(delta)) - product(K, prime(g)) -
                      product(g, prime(K)) + product(product(K, s), prime(K));
        EXPECT_EQ(b.joseph(K, b.G + g, b.S + s), law) << n;
    }
}
/// A gain that is too large by the share e leaves P - K G' singular at e beta = 1, beta the largest eigenvalue of X'P X
/// against Lambda: here of one row.
TEST(BlockLaws, AGainThatIsTooLargeByMoreThanOneOverBetaLosesThePublishedUpdate) {
    for (std::uint64_t n = 0; n < 40; ++n) {
        Block b{Seed{n}};
        b.X = b.X.leftCols(1).eval(), b.G = product(b.P, b.X);
        if (b.X.isZero()) continue;
        Q const own = product(prime(b.X), b.G)(0, 0), beta = own / b.lambda;
        b.K = b.G / (own + b.lambda);
        auto const with = [&](Q const& e) { return M(b.P - (1 + e) * product(b.K, prime(b.G))); };
        EXPECT_EQ(determinant(with(1 / beta)), 0) << n;
        EXPECT_TRUE(is_positive_definite(with(Q(99) / 100 / beta))) << n;
        EXPECT_FALSE(is_positive_definite(with(Q(101) / 100 / beta))) << n;
    }
}

// The delta forms (docs/theory.md 91): the same recursion in rationals, no drift in float, and every digit of a large
// prior's first rows.

TEST(DeltaForms, UdIsTheSameInRationals) {
    for (Rational const& lambda : {Rational(1), Rational(7) / 8, Rational(1) / 5}) {
        Problem<Rational> const problem{.size = 3, .forgetting = lambda, .prior = Prior<Rational>{.variance = 1000}};
        Ud<Rational> plain(problem);
        UdDelta<Rational> delta(problem);
        Seed seed{3};
        for (int k = 0; k < 8; ++k) {
            std::vector<Rational> psi;
            for (int i = 0; i < 3; ++i) psi.emplace_back(int(8 * seed.bell()));
            plain.update(psi, Rational(k)), delta.update(psi, Rational(k));
            EXPECT_TRUE(plain.stored().D == delta.stored().D && plain.stored().F == delta.stored().F) << k;
            EXPECT_TRUE(plain.theta() == delta.theta()) << k;
        }
    }
}

/// Relative error of P in the Frobenius norm after 30 000 white rows with lambda = 0.9999.
template <class F>
double drift() {
    float const lambda = 0.9999F;
    F filter(Problem<float>{.size = 2, .forgetting = lambda, .prior = Prior<float>{.variance = 1}});
    UdDelta<double> exact(Problem<double>{.size = 2, .forgetting = lambda, .prior = Prior<double>{.variance = 1}});
    Seed seed{7};
    for (int k = 0; k < 30000; ++k) {
        std::vector<float> const psi{float(seed.bell()), float(seed.bell())};
        filter.update(psi, 0);
        exact.update(std::vector<double>{psi[0], psi[1]}, 0);
    }
    Matrix<double> const P = exact.covariance();
    return (Matrix<float>(filter.covariance()).cast<double>() - P).norm() / P.norm();
}
/// The law is 5e-6 for a root and 2.5e-6 for D, and the plain forms lose 1e-4 and 1e-5 and more.
TEST(DeltaForms, DoNotDrift) {
    EXPECT_LT(drift<CarlsonDelta<float>>(), 2e-5);
    EXPECT_LT(drift<InverseQrDelta<float>>(), 2e-5);
    EXPECT_LT(drift<UdDelta<float>>(), 1e-5);
    EXPECT_GT(drift<Carlson<float>>(), 1e-4);
    EXPECT_GT(drift<InverseQr<float>>(), 1e-4);
    EXPECT_GT(drift<Ud<float>>(), 1e-5);
}

/// P_1 = P0 / (1 + P0) of one row psi = 1, to a few u: a difference from P0 would keep no digit.
TEST(DeltaForms, KeepTheDigitsThatALargePriorLeaves) {
    for_each(TypeList<CarlsonDelta<float>, InverseQrDelta<float>, UdDelta<float>>{}, []<class F>() {
        for (int const exponent : {0, 1, 2, 10, 30, 60, 100}) {
            float const P0 = std::ldexp(1.0F, exponent);
            F filter(Problem<float>{.size = 1, .prior = Prior<float>{.variance = P0}});
            EXPECT_EQ(filter.update(std::vector<float>{1}, 1).health, Health::sound) << F::name << ' ' << exponent;
            double const P1 = double(P0) / (1 + double(P0));
            EXPECT_LE(std::abs(filter.covariance()(0, 0) / P1 - 1), 8 * 0x1p-24) << F::name << ' ' << exponent;
            EXPECT_GT(filter.stored().F(0, 0), 0) << F::name << ' ' << exponent;
        }
    });
}

}  // namespace
}  // namespace rlslab
