// The laws of a block of rows (docs/theory.md 132, 133), in rationals.
#include <rlslab/studies/rationals.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace rlslab
