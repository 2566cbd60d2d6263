// Bounds of what one step rounds (docs/theory.md 113 to 116): never exceeded, and no more than twice the greatest error
// that a search finds in a word of 8 bits.
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/joseph.hpp>
#include <rlslab/variants/ud.hpp>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>

namespace rlslab {
namespace {

constexpr int bits = 8;
constexpr double u = 0x1p-8;
using Word = Chopped<Format{bits, -100, 100}>;
using Doubles = Eigen::MatrixXd;
using Column = Eigen::VectorXd;

double gamma(double n) { return n * u / (1 - n * u); }
/// Roundings of a division by lambda.
double divided(double lambda) { return lambda == 1 ? 0 : 2; }

template <class From>
Doubles wide(Matrix<From> const& A) {
    return A.unaryExpr([](From const& x) { return double(x); });
}
template <class From>
Column wide(Vector<From> const& x) {
    return x.unaryExpr([](From const& a) { return double(a); });
}
Doubles sizes(Doubles const& A) { return A.cwiseAbs(); }
/// The greatest of |error| / bound over the entries; double's own error is 2^-40 of a bound.
double greatest(Doubles const& error, Doubles const& bound) {
    double out = 0;
    for (Index j = 0; j < error.cols(); ++j)
        for (Index i = 0; i < error.rows(); ++i)
            if (error(i, j) != 0) out = std::max(out, std::abs(error(i, j)) / bound(i, j));
    return out;
}

// --- a search for the worst case -------------------------------------------------------------------------------------

/// What an input makes of a bound: error / bound, which may not exceed 1, and the number that is to grow.
struct Found {
    double ratio, goal;
    explicit Found(double of, bool counts = true) : ratio(of), goal(counts ? of : 0) {}
};
using Numbers = std::vector<Word>;

/// Climbs from random words, by other words, other significands and neighbours; the greatest goal that was seen.
double climb(size_t count, std::function<Found(Numbers const&)> const& measure, std::uint64_t seed_of = 1) {
    Seed seed{seed_of};
    auto const word = [&](int span) {
        double const significand = 1 + std::floor(seed.uniform() * 128) / 128;
        double const size = std::ldexp(significand, int(seed.next() % unsigned(2 * span + 1)) - span);
        return Word(seed.next() % 2 ? size : -size);
    };
    double best = 0, worst = 0;
    for (int start = 0; start < 8; ++start) {
        Numbers x(count);
        for (Word& number : x) number = word(3);
        double here = measure(x).goal;
        for (int step = 0; step < 3000; ++step) {
            Numbers other = x;
            for (std::uint64_t changes = 1 + seed.next() % 2; changes > 0; --changes) {
                Word& number = other[seed.next() % count];
                double const value = double(number);
                switch (seed.next() % 4) {
                    case 0: number = word(bits + 3); break;
                    case 1: number = Word(std::ldexp(value, int(seed.next() % 3) - 1)); break;
                    case 2:
                        number = Word(std::copysign(std::ldexp(std::abs(double(word(0))), std::ilogb(value)), value));
                        break;
                    default: number = Word(value * (1 + (int(seed.next() % 5) - 2) * 2 * u));
                }
                double const size = std::abs(double(number));
                if (size < 0x1p-20 || size > 0x1p20) number = word(3);
            }
            Found const found = measure(other);
            worst = std::max(worst, found.ratio);
            if (found.goal >= here) here = found.goal, x = other;
        }
        best = std::max(best, here);
    }
    EXPECT_LE(worst, 1);
    return best;
}

// --- Joseph's products -----------------------------------------------------------------------------------------------

/// (4) and (5) of the page, with what is between them.
struct Products {
    Matrix<Word> A, AP, APA, P;
    Products(Matrix<Word> const& P0, Vector<Word> const& psi, Vector<Word> const& K, Word lambda)
        : A(K.size(), K.size()), AP(A), APA(A), P(A) {
        Index const d = K.size();
        DivisorNearOne<Word> const by_lambda(lambda);
        for (Index j = 0; j < d; ++j) {
            for (Index i = 0; i < d; ++i) A(i, j) = -(K[i] * psi[j]);
            A(j, j) += Word(1);
        }
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i) {
                AP(i, j) = A(i, 0) * P0(0, j);
                for (Index n = 1; n < d; ++n) AP(i, j) += A(i, n) * P0(n, j);
            }
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i) {
                APA(i, j) = AP(i, 0) * A(j, 0);
                for (Index n = 1; n < d; ++n) APA(i, j) += AP(i, n) * A(j, n);
                P(i, j) = by_lambda(APA(i, j)) + K[i] * K[j];
            }
    }
};
struct Joint {
    Matrix<Word> P;
    Vector<Word> psi, K;
    Joint(Numbers const& x, Index d) : P(d, d), psi(d), K(d) {
        for (Index i = 0; i < d; ++i) {
            psi[i] = x[size_t(d * d + i)], K[i] = x[size_t(d * d + d + i)];
            for (Index j = 0; j < d; ++j) P(i, j) = x[size_t(d * i + j)];
        }
    }
};
enum class Term { products, square };
/// docs/theory.md 113, first bound; the goal is one of its two terms.
Found by_the_data(Numbers const& x, Index d, double lambda, Term term) {
    Joint const in(x, d);
    Products const out(in.P, in.psi, in.K, Word(lambda));
    Doubles const P = wide(in.P), one = Doubles::Identity(d, d);
    Column const K = wide(in.K), psi = wide(in.psi);
    Doubles const A = one - K * psi.transpose(), H = one + sizes(K) * sizes(psi).transpose();
    Doubles const exact = A * P * A.transpose() / lambda + K * K.transpose(),
                  products = gamma(double(2 * d + 5) + divided(lambda)) / lambda * H * sizes(P) * H.transpose(),
                  square = gamma(2) * sizes(K * K.transpose());
    Doubles const error = wide(out.P) - exact;
    Doubles const part = (term == Term::products ? square : products).cwiseQuotient(products + square);
    double const ratio = greatest(error, products + square);
    Index at = 0, column = 0;
    error.cwiseAbs().cwiseQuotient(products + square).maxCoeff(&at, &column);
    return Found(ratio, part(at, column) < 0.01);
}
/// The second bound, by what was computed.
Found by_the_products(Numbers const& x, Index d, double lambda) {
    Joint const in(x, d);
    Products const out(in.P, in.psi, in.K, Word(lambda));
    Doubles const P = wide(in.P), A_ = wide(out.A);
    Column const K = wide(in.K), psi = wide(in.psi);
    Doubles const A = Doubles::Identity(d, d) - K * psi.transpose(), AP = A * P, PA = P * A.transpose();
    Doubles G = sizes(A);
    for (Index j = 0; j < d; ++j) G(j, j) += (1 + u) * std::abs(K[j] * psi[j]);
    Doubles const of_A = u * (G * sizes(PA) + sizes(AP) * G.transpose()) + u * u * G * sizes(P) * G.transpose(),
                  sums = gamma(double(d)) * (sizes(A_) * sizes(P) + sizes(wide(out.AP))) * sizes(A_).transpose(),
                  last = gamma(divided(lambda)) * sizes(wide(out.APA));
    Doubles const bound = (of_A + sums + last) / lambda + u * sizes(K * K.transpose()) + u * sizes(wide(out.P));
    return Found(greatest(wide(out.P) - A * P * A.transpose() / lambda - K * K.transpose(), bound));
}

TEST(JosephBound, IsOfTheCode) {
    Seed seed{3};
    for (Index const d : {1, 2, 3, 5})
        for (double const lambda : {1.0, 0.75, 0.96875}) {
            Matrix<Word> L(d, d);
            for (Word& x : L.reshaped()) x = Word(seed.bell());
            Matrix<Word> P = L.lazyProduct(L.transpose());
            for (Index i = 0; i < d; ++i) P(i, i) = P(i, i) + Word(1);
            Problem<Word> const problem{.size = d, .forgetting = Word(lambda), .prior = Prior<Word>{.covariance = P}};
            Vector<Word> psi(d), K(d);
            for (Index i = 0; i < d; ++i) psi[i] = Word(seed.bell()), K[i] = Word(seed.bell());
            Joseph<Word> filter(problem);
            filter.update(psi, Word(1), [&](auto& gain) {
                for (Index i = 0; i < d; ++i) gain[i] = K[i];
            });
            EXPECT_TRUE(filter.covariance() == Products(P, psi, K, Word(lambda)).P) << d << " " << lambda;
        }
}
TEST(JosephBound, ByTheDataIsSharpToAFactorOfTwo) {
    for (Index const d : {1, 2, 3}) {
        size_t const count = size_t(d * d + 2 * d);
        for (Term const term : {Term::products, Term::square})
            EXPECT_GT(climb(count, [&](Numbers const& x) { return by_the_data(x, d, 1, term); }), 0.5)
                << d << " " << int(term);
        for (double const lambda : {0.5, 0.75, 0.96875})
            climb(count, [&](Numbers const& x) { return by_the_data(x, d, lambda, Term::products); });
    }
}
TEST(JosephBound, ByTheProductsIsSharpToAFactorOfTwo) {
    for (Index const d : {1, 2, 3})
        for (double const lambda : {1.0, 0.5, 0.96875})
            EXPECT_GT(climb(size_t(d * d + 2 * d), [&](Numbers const& x) { return by_the_products(x, d, lambda); }),
                      0.5)
                << d << " " << lambda;
}

/// |A||P||A|' <= (1 + (1 - gamma) sqrt(d/mu))^2 a a', a_i = sqrt(P_ii), mu the least eigenvalue of P with a unit
/// diagonal; and -eps d/mu P <= E <= eps d/mu P for |E| <= eps a a'. Both whatever the units.
TEST(JosephBound, IsOneOfTheCorrelation) {
    Seed seed{5};
    double greatest_seen = 0;
    for (int n = 0; n < 400; ++n) {
        Index const d = 2 + Index(n % 4);
        Doubles L(d, d);
        for (double& x : L.reshaped()) x = seed.bell() * std::pow(10.0, -double(seed.next() % 4));
        Doubles P = L * L.transpose() + 1e-6 * Doubles::Identity(d, d);
        Column psi(d), units(d);
        for (Index i = 0; i < d; ++i) psi[i] = seed.bell(), units[i] = std::pow(10.0, double(seed.next() % 9) - 4);
        P = units.asDiagonal() * P * units.asDiagonal();
        psi = psi.cwiseQuotient(units);
        Column const a = P.diagonal().cwiseSqrt();
        Doubles const C = a.cwiseInverse().asDiagonal() * P * a.cwiseInverse().asDiagonal();
        double const mu = Eigen::SelfAdjointEigenSolver<Doubles>(C).eigenvalues()[0], s = 1 + psi.dot(P * psi);
        Doubles const A = Doubles::Identity(d, d) - P * psi * psi.transpose() / s;
        double const factor = 1 + (1 - 1 / s) * std::sqrt(double(d) / mu);
        double const ratio = greatest(sizes(A) * sizes(P) * sizes(A).transpose(), factor * factor * a * a.transpose());
        EXPECT_LE(ratio, 1) << n;
        greatest_seen = std::max(greatest_seen, ratio);
        Doubles E(d, d);
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i <= j; ++i) E(i, j) = E(j, i) = (seed.next() % 2 ? 1 : -1) * a[i] * a[j];
        Doubles const room = double(d) / mu * P;
        Doubles const scaled = a.cwiseInverse().asDiagonal() * (room - E) * a.cwiseInverse().asDiagonal();
        EXPECT_GT(Eigen::SelfAdjointEigenSolver<Doubles>(scaled).eigenvalues()[0], -1e-9 / mu) << n;
    }
    EXPECT_GT(greatest_seen, 0.05);
}

// --- the symmetric form ----------------------------------------------------------------------------------------------

TEST(SymmetricBound, OfOneEntryIsSharpToAFactorOfTwo) {
    for (double const lambda : {1.0, 0.5, 0.75, 0.96875}) {
        DivisorNearOne<Word> const by_lambda{Word(lambda)};
        auto const measure = [&](Numbers const& x) {
            double const P = double(x[0]), Kf = double(x[1]) * double(x[2]), r = divided(lambda);
            double const computed = double(by_lambda(x[0] - x[1] * x[2])),
                         bound = (gamma(1 + r) * std::abs(P) + gamma(2 + r) * std::abs(Kf)) / lambda;
            return Found(std::abs(computed - (P - Kf) / lambda) / bound);
        };
        EXPECT_GT(climb(3, measure), lambda == 0.5 ? 0 : 0.5) << lambda;  // x / (1/2) is exact
    }
}

// --- ud --------------------------------------------------------------------------------------------------------------

/// One step of the page from U, D, psi in words against the exact step from U~ and D, where U~ is the least change of U
/// that makes the computed f exact (docs/theory.md 116).
struct UdStep {
    Doubles error_of_D, bound_of_D, error_of_U, bound_of_U, change, allowed;
    UdStep(Matrix<Word> const& U, Vector<Word> const& D, Vector<Word> const& psi, double lambda) {
        Index const d = D.size();
        Problem<Word> const problem{.size = d, .forgetting = Word(lambda), .prior = Prior<Word>{}};
        Ud<Word> filter(problem);
        auto const state = Ud<Word>::state(filter);
        auto& D_ = std::get<3>(state);
        auto& U_ = std::get<5>(state);
        for (Index j = 0; j < d; ++j) {
            D_[j] = D[j];
            for (Index i = 0; i <= j; ++i) U_(i, j) = U(i, j);
        }
        Doubles const before = wide(U), D0 = D.unaryExpr([](Word x) { return double(x); });
        Column f(d);
        Doubles exact = before;
        change = allowed = Doubles::Zero(d, d);
        for (Index j = 0; j < d; ++j) {
            Word const computed = dot(U.col(j).data(), psi.data(), j + 1);
            f[j] = double(computed);
            double sum = 0, size = 0;
            for (Index i = 0; i <= j; ++i) {
                double const term = before(i, j) * double(psi[i]);
                sum += term, size += std::abs(term);
            }
            for (Index i = 0; i <= j; ++i) {
                double const term = before(i, j) * double(psi[i]);
                if (size > 0) exact(i, j) *= 1 + (term < 0 ? -1 : 1) * (f[j] - sum) / size;
                change(i, j) = std::abs(exact(i, j) - before(i, j));
                allowed(i, j) = gamma(double(j + 1)) * std::abs(before(i, j));
            }
        }
        filter.update(psi, Word(1));
        error_of_D = bound_of_D = Doubles::Zero(d, 1);
        error_of_U = bound_of_U = Doubles::Zero(d, d);
        double s = lambda;
        Column v = Column::Zero(d), sizes_of_v = Column::Zero(d);
        for (Index j = 0; j < d; ++j) {
            double const g = D0(j, 0) * f[j], next = s + f[j] * g, mu = f[j] / s, r = divided(lambda);
            double const D_exact = D0(j, 0) * (s / next) / lambda;
            error_of_D(j, 0) = double(D_[j]) - D_exact;
            bound_of_D(j, 0) = gamma(r + (j == 0 ? 5 : double(j) + 8)) * D_exact;
            for (Index i = 0; i < j; ++i) {
                error_of_U(i, j) = double(U_(i, j)) - (exact(i, j) - v[i] * mu);
                bound_of_U(i, j) = gamma(double(j + 2)) * std::abs(exact(i, j)) +
                                   gamma(double(j == 1 ? 7 : 2 * j + 8)) * std::abs(mu) * sizes_of_v[i];
            }
            v += exact.col(j) * g, sizes_of_v += sizes(exact.col(j)) * std::abs(g);
            s = next;
        }
    }
};
UdStep ud_step(Numbers const& x, Index d, double lambda) {
    Matrix<Word> U = Matrix<Word>::Zero(d, d);
    Vector<Word> D(d), psi(d);
    size_t at = 0;
    for (Index j = 0; j < d; ++j) {
        D[j] = abs(x[at++]), psi[j] = x[at++], U(j, j) = Word(1);
        for (Index i = 0; i < j; ++i) U(i, j) = x[at++];
    }
    return UdStep(U, D, psi, lambda);
}
/// Column by column; of U also where the term of the running vector is 0.98 of the bound.
TEST(UdBound, OfOneStepIsSharpToAFactorOfTwo) {
    for (Index const d : {1, 2, 3, 4}) {
        Index const j = d - 1;
        size_t const count = size_t(2 * d + d * (d - 1) / 2);
        for (double const lambda : {1.0, 0.75}) {
            auto const of_D = [&](Numbers const& x) {
                UdStep const step = ud_step(x, d, lambda);
                return Found(greatest(step.error_of_D.row(j), step.bound_of_D.row(j)));
            };
            auto const of_U = [&](Numbers const& x) {
                UdStep const step = ud_step(x, d, lambda);
                EXPECT_LE(greatest(step.change, step.allowed), 1 + 1e-9);
                return Found(greatest(step.error_of_U.col(j), step.bound_of_U.col(j)));
            };
            auto const of_running = [&](Numbers const& x) {
                UdStep const step = ud_step(x, d, lambda);
                Found out(greatest(step.error_of_U.col(j), step.bound_of_U.col(j)), false);
                for (Index i = 0; i < j; ++i)  // allowed: gamma_j |U_ij|
                    if (1.5 * step.allowed(i, j) < 0.02 * step.bound_of_U(i, j))
                        out.goal = std::max(out.goal, std::abs(step.error_of_U(i, j)) / step.bound_of_U(i, j));
                return out;
            };
            double const D = climb(count, of_D);
            EXPECT_GT(D, d < 3 ? 0.5 : 0.45) << d;
            if (d == 1) continue;
            double const U = climb(count, of_U), running = climb(count, of_running);
            EXPECT_GT(U, 0.5) << d;
            EXPECT_GT(running, d < 3 ? 0.5 : 0.3) << d;
        }
    }
}

}  // namespace
}  // namespace rlslab
