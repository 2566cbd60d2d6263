// Errors elsewhere than in the gain (docs/theory.md 31, 35): of s in Potter's form, of a rotation's angle. First order:
// the slope of P at no error, from two errors of 1e-30 in 77 digits.
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/linalg/start.hpp>

#include "tests/variants/gain_laws.hpp"

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace gain_laws;
using T = Reference;
using M = Matrix<T>;
using V = Vector<T>;

T const error("1e-30"), tolerance("1e-40");
constexpr int cases = 20;

M square(M const& S) { return S.lazyProduct(S.transpose()); }
/// P' of P(error), central.
M derivative(auto const& P) { return (P(error) - P(T(-error))) / (2 * error); }
M symmetric_product(V const& a, V const& b) { return outer<T>(a, b) + outer<T>(b, a); }

/// The upper triangular root of P, P = S S'.
M root(Case<T> const& c) {
    StateMatrix<T> const S = start_root<T, Dynamic>(c.problem());
    return S.view();
}

/// The new S of P = S S', S upper triangular, and b_1 ... b_d. Rotation `wrong` turns by phi more; -1: none.
std::pair<M, std::vector<T>> inverse_qr(Case<T> const& c, Index wrong, T const& phi) {
    Index const d = c.size;
    M S = root(c);
    S /= sqrt(c.lambda);
    V const a = S.transpose().lazyProduct(c.psi);
    V g = V::Zero(d);
    T b = T(1);
    std::vector<T> all;
    for (Index j = 0; j < d; ++j) {
        T const next = sqrt(T(b * b + a[j] * a[j]));
        T cosine = b / next, sine = a[j] / next;
        if (j == wrong) {
            T const turned = cosine * cos(phi) - sine * sin(phi);
            sine = sine * cos(phi) + cosine * sin(phi);
            cosine = turned;
        }
        for (Index i = 0; i <= j; ++i) {
            T const t = S(i, j), before = g[i];
            g[i] = cosine * before + sine * t;
            S(i, j) = cosine * t - sine * before;
        }
        b = next;
        all.push_back(b);
    }
    return {S, all};
}

/// R of P^-1 = R'R by Cholesky.
M information_root(Case<T> const& c) {
    M R = M::Zero(c.size, c.size), A = inverse<T>(c.P);
    for (Index i = 0; i < c.size; ++i) {
        T const pivot = square_root(T(A(i, i)));
        for (Index k = i; k < c.size; ++k) R(i, k) = A(i, k) / pivot;
        for (Index k = i + 1; k < c.size; ++k)
            for (Index m = i + 1; m < c.size; ++m) A(k, m) -= R(i, k) * R(i, m);
    }
    return R;
}
/// The new R of P^-1 = R'R, R upper triangular, and the running row after rotation `wrong`, which turns by phi more.
std::pair<M, V> qr(Case<T> const& c, Index wrong, T const& phi) {
    Index const d = c.size;
    M R = information_root(c);
    R *= sqrt(c.lambda);
    V x = c.psi, after = V::Zero(d);
    for (Index i = 0; i < d; ++i) {
        T const r = sqrt(T(R(i, i) * R(i, i) + x[i] * x[i])), cosine = R(i, i) / r, sine = x[i] / r;
        auto const turn = [&](T const& with_cosine, T const& with_sine) {
            for (Index k = i; k < d; ++k) {
                T const t = R(i, k);
                R(i, k) = with_cosine * t + with_sine * x[k];
                x[k] = with_cosine * x[k] - with_sine * t;
            }
            x[i] = T(0);  // as the variant has it: what it does not store
        };
        turn(cosine, sine);
        if (i == wrong) {
            after = x;
            turn(cos(phi), sin(phi));
        }
    }
    return {R, after};
}

TEST(AngleLaws, OfInverseQr) {
    for (int n = 0; n < cases; ++n) {
        Case<T> const c(Seed{std::uint64_t(n)});
        auto const [S, b] = inverse_qr(c, -1, T(0));
        EXPECT_LE(largest<T>(square(S) - c.P_next), T("1e-60")) << n;
        for (Index j = 0; j < c.size; ++j) {
            M const slope = derivative([&](T const& phi) { return square(inverse_qr(c, j, phi).first); });
            M const law = -b[size_t(j)] * symmetric_product(c.K, S.col(j));
            EXPECT_LE(largest<T>(slope - law), tolerance) << n << " " << j;
            EXPECT_LE(absolute(T(b[size_t(j)] - square_root(T(c.s_after[size_t(j) + 1] / c.lambda)))), T("1e-60"));
            EXPECT_GT(largest<T>(slope - law / b[size_t(j)]) + (b[size_t(j)] == T(1)), tolerance)
                << "without b_j " << n << " " << j;
        }
    }
}
TEST(AngleLaws, OfQr) {
    for (int n = 0; n < cases; ++n) {
        Case<T> const c(Seed{std::uint64_t(n)});
        M const R = qr(c, -1, T(0)).first;
        for (Index j = 0; j < c.size; ++j) {
            M const slope = derivative([&](T const& phi) {
                M const turned = qr(c, j, phi).first;
                return M(turned.transpose().lazyProduct(turned));
            });
            V e = V::Zero(c.size);
            e[j] = T(1);
            V const x = qr(c, j, T(0)).second;
            EXPECT_LE(largest<T>(slope - R(j, j) * symmetric_product(e, x)), tolerance) << n << " " << j;
            if (j + 1 == c.size) {
                EXPECT_LE(largest<T>(slope), tolerance) << "the last rotation has no effect";
            } else if (!x.isZero(T(0))) {
                EXPECT_GT(largest<T>(slope + R(j, j) * symmetric_product(e, x)), tolerance) << "the other sign";
            }
        }
    }
}

/// delta P = (s/lambda) eta (2 rho + gamma) / (1 + rho)^2 K K' of a relative error eta of s.
TEST(AngleLaws, OfPottersS) {
    for (int n = 0; n < cases; ++n) {
        Case<T> const c(Seed{std::uint64_t(n)});
        M const S = root(c);
        V const f = S.transpose().lazyProduct(c.psi);
        auto const P = [&](T const& eta) {
            T const s = c.s * (1 + eta);
            return square((S - outer<T>(c.f, f) / (s + square_root(T(c.lambda * s)))) / square_root(c.lambda));
        };
        T const gamma = c.lambda / c.s, rho = square_root(gamma);
        M const KK = c.s / c.lambda * outer<T>(c.K, c.K), slope = derivative(P);
        EXPECT_LE(largest<T>(slope - (2 * rho + gamma) / ((1 + rho) * (1 + rho)) * KK), tolerance) << n;
        EXPECT_GT(largest<T>(slope - KK), tolerance) << "as conventional, " << n;
    }
}

}  // namespace
}  // namespace rlslab
