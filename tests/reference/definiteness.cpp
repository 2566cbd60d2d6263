// Health is decided for exactly the stored bits; the quick proof in double never claims it wrongly.
#include <rlslab/core/random.hpp>
#include <rlslab/reference/definiteness.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace rlslab {
namespace {

using Quantity = Stored<double>::Quantity;
using Form = Stored<double>::Form;
constexpr double inf = std::numeric_limits<double>::infinity();

struct Random : Seed {
    double uniform() { return double(std::int64_t(next()) >> 11) * 0x1p-52; }  // in [-1, 1)
    Index below(Index n) { return Index(next() % std::uint64_t(n)); }
};

Stored<double> plain(Matrix<double> F, Quantity quantity = Quantity::covariance) {
    return {quantity, Form::plain, std::move(F)};
}
Stored<double> factor(Matrix<double> F, Vector<double> D = {}, Quantity quantity = Quantity::covariance) {
    return {quantity, Form::factor, std::move(F), std::move(D)};
}
Stored<Reference> widened(Stored<double> const& stored) {
    return stored.mapped<Reference>([](double x) { return widen(x); });
}
Health verdict(Stored<double> const& stored) { return definiteness(widened(stored)); }
Matrix<double> two(double a, double b, double c, double d) { return (Matrix<double>(2, 2) << a, b, c, d).finished(); }

/// Sylvester's criterion by elimination in rational numbers.
bool rationally_positive(Matrix<double> const& F) {
    Index const d = F.rows();
    Matrix<Rational> A(d, d);
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i) A(i, j) = Rational(F(i, j)) + Rational(F(j, i));
    for (Index j = 0; j < d; ++j) {
        if (A(j, j) <= 0) return false;
        for (Index i = j + 1; i < d; ++i) {
            Rational const l = A(i, j) / A(j, j);
            for (Index k = j; k < d; ++k) A(i, k) -= l * A(j, k);
        }
    }
    return true;
}

/// B B' with B of rank d - 1 in small integers: exactly singular; then one entry of the diagonal moved by `nudge`.
Matrix<double> near_singular(Random& random, Index d, double nudge) {
    Matrix<double> B = Matrix<double>::Zero(d, d);
    for (Index j = 0; j + 1 < d; ++j)
        for (Index i = 0; i < d; ++i) B(i, j) = double(random.below(19)) - 9;
    Matrix<double> A = B * B.transpose();
    Index const i = random.below(d);
    A(i, i) += nudge;
    return A;
}

TEST(Definiteness, OfTwoByTwo) {
    EXPECT_EQ(verdict(plain(two(2, 1, 1, 2))), Health::sound);
    EXPECT_EQ(verdict(plain(two(1, 2, 2, 1))), Health::indefinite);
    EXPECT_EQ(verdict(plain(two(1, 1, 1, 1))), Health::indefinite) << "semidefinite is not definite";
    EXPECT_EQ(verdict(plain(two(0, 0, 0, 1))), Health::indefinite);
    EXPECT_EQ(verdict(plain(two(-1, 0, 0, 1))), Health::indefinite);
    EXPECT_EQ(verdict(plain(Matrix<double>::Zero(3, 3))), Health::indefinite);
    EXPECT_EQ(verdict(plain(two(2, 1, 1, 2), Quantity::information)), Health::sound);
    EXPECT_EQ(verdict(plain(two(1, 1, 1, 1), Quantity::information)), Health::indefinite);
}

TEST(Definiteness, TurnsOnTheLastBit) {
    constexpr double e = 0x1p-52;
    EXPECT_EQ(verdict(plain(two(1, 1, 1, 1 + e))), Health::sound);
    EXPECT_EQ(verdict(plain(two(1, 1, 1, 1 - e / 2))), Health::indefinite);
    // (1 + e)(1 - e) = 1 - e^2 < 1, and (1 + e)(1 - e/2) = 1 + e/2 - e^2/2 > 1
    EXPECT_EQ(verdict(plain(two(1 + e, 1, 1, 1 - e))), Health::indefinite);
    EXPECT_EQ(verdict(plain(two(1 + e, 1, 1, 1 - e / 2))), Health::sound);
    // (1 + 2e)(1 + 0) against (1 + e)^2 = 1 + 2e + e^2
    EXPECT_EQ(verdict(plain(two(1 + 2 * e, 1 + e, 1 + e, 1))), Health::indefinite);
    // 257 bits: pivots that differ by 2^-256 of what is subtracted
    Stored<Reference> wide{Stored<Reference>::Quantity::covariance, Stored<Reference>::Form::plain,
                           Matrix<Reference>::Constant(2, 2, Reference(1))};
    wide.F(1, 1) += ldexp(Reference(1), -256);
    EXPECT_EQ(definiteness(wide), Health::sound);
    wide.F(1, 1) = 1 - ldexp(Reference(1), -257);
    EXPECT_EQ(definiteness(wide), Health::indefinite);
}

TEST(Definiteness, OfSingularMatricesThatBallsCannotSettle) {
    // The third pivot is exactly zero, after inexact divisions by 3: at any precision its ball contains zero.
    Matrix<double> B = Matrix<double>::Zero(4, 4);
    B << 3, 0, 0, 0, 1, 7, 0, 0, 2, 5, 0, 0, 1, 1, 0, 0;
    Matrix<double> const A = B * B.transpose();
    EXPECT_EQ(verdict(plain(A)), Health::indefinite);
    Matrix<double> scaled = A;
    scaled.row(2) *= 0x1p300;
    scaled.col(2) *= 0x1p300;
    scaled.row(1) *= 0x1p-300;
    scaled.col(1) *= 0x1p-300;
    EXPECT_EQ(verdict(plain(scaled)), Health::indefinite);
    // Definite, or not, by 2^-245 of itself.
    Stored<Reference> close = widened(plain(A));
    for (Index i = 2; i < 4; ++i) close.F(i, i) += ldexp(Reference(1), -240);
    EXPECT_EQ(definiteness(close), Health::sound);
    for (Index i = 2; i < 4; ++i) close.F(i, i) -= ldexp(Reference(1), -239);
    EXPECT_EQ(definiteness(close), Health::indefinite);
}

TEST(Definiteness, OfThePartThatIsSymmetric) {
    EXPECT_EQ(verdict(plain(two(1, 100, -100, 1))), Health::sound);
    EXPECT_EQ(verdict(plain(two(1, 2, 0, 1))), Health::indefinite) << "its symmetric part is all ones";
    EXPECT_EQ(verdict(plain(two(1, 2, -0x1p-60, 1))), Health::sound);
    EXPECT_EQ(verdict(plain(two(1, 2, 0x1p-60, 1))), Health::indefinite);
    EXPECT_EQ(verdict(plain(two(1, std::nextafter(2.0, 3), 0, 1))), Health::indefinite);
}

TEST(Definiteness, OfFactors) {
    Vector<double> const D = (Vector<double>(2) << 1, 0x1p-1074).finished();
    EXPECT_EQ(verdict(factor(two(1, 5, 0, 1), D)), Health::sound);
    EXPECT_EQ(verdict(factor(two(1, 5, 0, 1), -D)), Health::indefinite);
    EXPECT_EQ(verdict(factor(two(1, 5, 0, 1), Vector<double>::Unit(2, 0))), Health::indefinite);
    EXPECT_EQ(verdict(factor(two(1, 5, 0, -1))), Health::sound) << "a sign on the diagonal is squared away";
    EXPECT_EQ(verdict(factor(two(1, 0, 5, 0))), Health::indefinite);
    EXPECT_EQ(verdict(factor(two(1, 2, 2, 4))), Health::indefinite);
    EXPECT_EQ(verdict(factor(two(1, 2, 2, std::nextafter(4.0, 5)))), Health::sound);
    EXPECT_EQ(verdict(factor(two(1, 0x1p61, 1, 1))), Health::sound) << "its determinant divides the prime";
    EXPECT_EQ(verdict(factor(two(1, 2, 2, 4), {}, Quantity::information)), Health::indefinite);
}

TEST(Definiteness, OfWhatIsNotFinite) {
    EXPECT_EQ(verdict(plain(two(inf, 0, 0, 1))), Health::nonfinite);
    EXPECT_EQ(verdict(plain(two(1, std::nan(""), 0, 1))), Health::nonfinite);
    EXPECT_EQ(verdict(factor(two(1, 0, 0, 1), Vector<double>::Constant(2, inf))), Health::nonfinite);
    EXPECT_THROW(verdict(plain(Matrix<double>::Ones(2, 2).leftCols(1))), std::invalid_argument);
    EXPECT_THROW(verdict(factor(two(1, 0, 0, 1), Vector<double>::Ones(3))), std::invalid_argument);
}

TEST(Definiteness, AgreesWithRationalElimination) {
    Random random{{42}};
    int positive = 0;
    for (int trial = 0; trial < 600; ++trial) {
        Index const d = 2 + random.below(5);
        double const nudge = std::ldexp(random.uniform(), -int(random.below(60)));
        Matrix<double> const A = near_singular(random, d, trial % 3 == 0 ? 0 : nudge);
        bool const truth = rationally_positive(A);
        EXPECT_EQ(verdict(plain(A)) == Health::sound, truth) << A;
        positive += truth;
    }
    EXPECT_GT(positive, 100);
    EXPECT_LT(positive, 500);
}

TEST(SurelyPositive, NeverClaimsWhatIsNotSo) {
    Random random{{7}};
    int claimed = 0, positive = 0, asked = 0;
    for (int trial = 0; trial < 6000; ++trial, ++asked) {
        Index const d = 1 + random.below(9);
        double const nudge = std::ldexp(random.uniform(), 4 - int(random.below(56)));
        Matrix<double> A = near_singular(random, d, nudge);
        if (trial % 2)  // fractions that do not divide evenly, and columns of every scale
            for (Index i = 0; i < d; ++i) {
                double const scale = std::ldexp(1 + random.uniform() / 3, int(random.below(400)) - 200);
                A.row(i) *= scale;
                A.col(i) *= scale;
            }
        if (trial % 5 == 0) A(0, d - 1) += std::ldexp(random.uniform(), -50) * A(0, d - 1);  // asymmetry
        bool const claim = surely_positive(plain(A)), truth = verdict(plain(A)) == Health::sound;
        EXPECT_TRUE(truth || !claim) << A;
        claimed += claim;
        positive += truth;
    }
    EXPECT_GT(positive, asked / 4);
    EXPECT_LT(positive, asked * 3 / 4);
    EXPECT_GT(claimed, positive * 3 / 5);
}

TEST(SurelyPositive, CoversTheRoundingItWasToldOf) {
    Random random{{8}};
    int claimed = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        Index const d = 2 + random.below(6);
        // Unit 2^-p arithmetic, then wide numbers within that perturbation of what is shown, drawn against it.
        double const rho = trial % 2 ? 0x1p-53 : 0x1p-20;
        double const nudge = std::ldexp(std::abs(random.uniform()), 6 - int(random.below(60)));
        Stored<double> const shown = plain(near_singular(random, d, nudge));
        bool const claim = surely_positive(shown, rho);
        claimed += claim;
        Stored<Reference> stored = widened(shown);
        Index const pattern = random.below(4);
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i) {
                bool const up = i != j && (pattern == 0 || (pattern == 1 && random.below(2)));
                stored.F(i, j) *= 1 + (up ? 1 : -1) * Reference(rho) * (1 - Reference(rho));
            }
        EXPECT_TRUE(!claim || definiteness(stored) == Health::sound);
    }
    EXPECT_GT(claimed, 100);
}

/// (1 - delta) 1 1' + delta I has the least eigenvalue delta and the trace d. With u = 2^-53 Rump's bound asks for
/// delta > (d + 1) u d + 2 u:
/// half of it proves nothing, twice as much (and what the factorisation itself rounds away) is enough.
TEST(SurelyPositive, AsksForTheLeastEigenvalueOfItsBound) {
    constexpr double u = 0x1p-53;
    for (Index const d : {2, 4, 8, 16, 32, 40}) {
        double const c = double((d + 1) * d + 2) * u;
        auto const claimed = [&](double delta) {
            Matrix<double> A = Matrix<double>::Constant(d, d, 1 - delta);
            A.diagonal().setOnes();
            return surely_positive(plain(A));
        };
        EXPECT_FALSE(claimed(c / 2)) << d;
        EXPECT_TRUE(claimed(2 * c + 8 * u)) << d;
    }
}

TEST(SurelyPositive, AlmostAlwaysSeesHealth) {
    Random random{{9}};
    for (Index const d : {1, 2, 9, 33, 64})
        for (int trial = 0; trial < 50; ++trial) {
            Matrix<double> A = Matrix<double>::Zero(d, d);
            for (Index k = 0; k < 3 * d + 3; ++k) {
                Vector<double> psi(d);
                for (double& x : psi) x = random.uniform();
                A += psi * psi.transpose();
            }
            for (Index i = 0; i < d; ++i) {  // P often has columns of very different scale
                double const scale = std::pow(10.0, double(random.below(80)) - 40);
                A.row(i) *= scale;
                A.col(i) *= scale;
            }
            EXPECT_TRUE(surely_positive(plain(A)));
            EXPECT_TRUE(surely_positive(plain(A), 0x1p-53));
        }
}

TEST(SurelyPositive, IsSilentAtTheEdges) {
    double const nan = std::nan("");
    for (double const bad : {inf, -inf, nan, 1e308, -1e308})
        for (Index i = 0; i < 3; ++i)
            for (Index j = 0; j < 3; ++j) {
                Matrix<double> A = 2 * Matrix<double>::Identity(3, 3);
                A(i, j) = bad;
                EXPECT_FALSE(surely_positive(plain(A)) && verdict(plain(A)) != Health::sound);
                if (!std::isfinite(bad)) {
                    EXPECT_FALSE(surely_positive(plain(A)));
                    EXPECT_FALSE(surely_positive(factor(A)));
                }
            }
    EXPECT_FALSE(surely_positive(plain(two(1, 1, 1, 1))));
    EXPECT_FALSE(surely_positive(plain(two(1e-300, 0, 0, 1e-300)))) << "not tried; definiteness knows";
    EXPECT_FALSE(surely_positive(plain(two(1, 0, 0, 0))));
    EXPECT_FALSE(surely_positive(plain(Matrix<double>::Identity(2, 2)), 0.5));
    EXPECT_FALSE(surely_positive(plain(Matrix<double>::Identity(2, 2)), nan));
    EXPECT_TRUE(surely_positive(plain(two(0x1p899, 0, 0, 0x1p-899))));
}

TEST(SurelyPositive, ReadsFactors) {
    EXPECT_TRUE(surely_positive(factor(two(1, 5, 0, 1), Vector<double>::Constant(2, 1e-300)), 0x1p-53));
    EXPECT_TRUE(surely_positive(factor(two(-1, 0, 5, 2))));
    EXPECT_FALSE(surely_positive(factor(two(1, 0, 5, 0))));
    EXPECT_FALSE(surely_positive(factor(two(1, 5, 0, 1), Vector<double>::Unit(2, 0))));
    EXPECT_FALSE(surely_positive(factor(two(1, 5, 0, 1), Vector<double>::Constant(2, inf))));
    EXPECT_TRUE(surely_positive(factor(two(1, 2, 2, std::nextafter(4.0, 5))))) << "full, proven modulo a prime";
    EXPECT_FALSE(surely_positive(factor(two(1, 2, 2, 4))));
    EXPECT_FALSE(surely_positive(factor(two(1, 2, 2, 5)), 0x1p-53)) << "full and rounded: not tried";
    // The third column is the sum of the first two; that of the magnitudes is not.
    EXPECT_FALSE(surely_positive(factor((Matrix<double>(3, 3) << 1, 4, 5, 2, -5, -3, -3, 6, 3).finished())));
    EXPECT_TRUE(surely_positive(factor((Matrix<double>(3, 3) << 1, 4, 5, 2, -5, -3, -3, 6, 4).finished())));
}

}  // namespace
}  // namespace rlslab
