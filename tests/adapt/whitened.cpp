// Joseph's products and the units of the columns (docs/theory.md 119): scaling by powers of two changes no bit, the
// basis of the first rows makes a factor's accuracy of it.
#include <rlslab/state/state.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/whitened.hpp>
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/variants/joseph.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cstring>

namespace rlslab {
namespace {

using namespace adapt_laws;

template <class T>
using WhitenedJoseph = Whitened<Joseph<T>, Qr<T>>;

/// rows x d numbers with the singular values kappa^(-i/(d-1)) sqrt(rows), in random directions, and outputs.
struct Rows {
    Eigen::MatrixXd psi;
    Eigen::VectorXd y;
};
Rows rotated(Index d, Index rows, double kappa, Seed seed) {
    Eigen::MatrixXd A(rows, d), B(d, d);
    for (double& x : A.reshaped()) x = seed.bell();
    for (double& x : B.reshaped()) x = seed.bell();
    Eigen::MatrixXd const V = B.householderQr().householderQ();
    Eigen::VectorXd sizes(d);
    for (Index i = 0; i < d; ++i) sizes[i] = std::pow(kappa, -double(i) / double(std::max<Index>(d - 1, 1)));
    Rows out{A * sizes.asDiagonal() * V.transpose(), Eigen::VectorXd(rows)};
    for (Index k = 0; k < rows; ++k) out.y[k] = out.psi.row(k).sum() + seed.bell() / 8;
    return out;
}
template <class T>
Problem<T> problem(Index d, double forgetting, double variance) {
    return {.size = d, .forgetting = T(forgetting), .prior = Prior<T>{.variance = T(variance)}};
}
template <class F>
void fold_in(F& f, Rows const& data, Index first = 0) {
    using T = typename F::scalar;
    Vector<T> psi(data.psi.cols());
    for (Index k = first; k < data.psi.rows(); ++k) {
        for (Index i = 0; i < psi.size(); ++i) psi[i] = T(data.psi(k, i));
        EXPECT_EQ(f.update(psi, T(data.y[k])).health, Health::sound) << k;
    }
}
template <class F>
Matrix<Reference> wide_covariance(F const& f) {
    auto const stored = f.stored();
    return multiplied_out(stored).unaryExpr([](auto const& x) { return widen(x); });
}
double relative(Matrix<Reference> const& a, Matrix<Reference> const& b) {
    Reference error = 0, size = 0;
    for (Index j = 0; j < a.cols(); ++j)
        for (Index i = 0; i < a.rows(); ++i) {
            error += (a(i, j) - b(i, j)) * (a(i, j) - b(i, j));
            size += b(i, j) * b(i, j);
        }
    return double(sqrt(Reference(error / size)));
}

TEST(Whitened, IsTheSameFilterInExactArithmetic) {
    for (Index const d : {1, 2, 5})
        for (double const lambda : {1.0, 0.9375}) {
            Rows const data = rotated(d, 12 * d, 100, Seed{std::uint64_t(d)});
            WhitenedJoseph<Reference> whitened(problem<Reference>(d, lambda, 1e4));
            Joseph<Reference> plain(problem<Reference>(d, lambda, 1e4));
            for (Index k = 0; k < data.psi.rows(); ++k) {
                Vector<Reference> const psi = data.psi.row(k).cast<Reference>();
                Step<Reference> const a = whitened.update(psi, Reference(data.y[k])),
                                      b = plain.update(psi, Reference(data.y[k]));
                EXPECT_EQ(whitened.whitened(), k >= 4 * d);
                for (Reference const& x : {Reference(a.innovation - b.innovation), Reference(a.gamma - b.gamma),
                                           Reference(a.residual - b.residual)})
                    EXPECT_LT(abs(x), 1e-60);
                for (Index i = 0; i < d; ++i) {
                    EXPECT_LT(abs(Reference(whitened.theta()[i] - plain.theta()[i])), 1e-60);
                    EXPECT_LT(abs(Reference(whitened.gain()[i] - plain.gain()[i])), 1e-60);
                }
            }
            EXPECT_LT(relative(wide_covariance(whitened), wide_covariance(plain)), 1e-60);
        }
}

/// Rotated columns, kappa = 1e5, P0 = kappa^2 I: Joseph's products lose kappa^3, ud and the composition kappa.
TEST(Whitened, HasTheAccuracyOfAFactorWhereJosephsProductsLoseTheirs) {
    for (std::uint64_t seed : {1, 2, 3}) {
        Rows const data = rotated(5, 60, 1e5, Seed{seed});
        auto const error = [&]<class F>(F filter) {
            Ud<Reference> exact(problem<Reference>(5, 1, 1e10));
            fold_in(exact, data);
            fold_in(filter, data);
            return relative(wide_covariance(filter), wide_covariance(exact));
        };
        double const joseph = error(Joseph<double>(problem<double>(5, 1, 1e10))),
                     ud = error(Ud<double>(problem<double>(5, 1, 1e10))),
                     whitened = error(WhitenedJoseph<double>(problem<double>(5, 1, 1e10)));
        EXPECT_LT(whitened, 1e-9) << seed;  // 1e5 u is 1e-11
        EXPECT_LT(whitened, 30 * ud) << seed;
        EXPECT_GT(joseph, 100 * whitened) << seed;
    }
}

/// Scaled by powers of two, the prior along: every stored number is the other times its power of two.
template <class F>
void expect_units_change_no_bit(Index d, double lambda) {
    using T = typename F::scalar;
    Rows const data = rotated(d, 8 * d, 1000, Seed{7});
    Vector<T> size(d);
    for (Index i = 0; i < d; ++i) size[i] = T(std::ldexp(1.0, int(5 * i) - 7));
    Problem<T> const natural = problem<T>(d, lambda, 4096);
    Problem<T> scaled = natural;
    scaled.prior->covariance = Matrix<T>::Zero(d, d).eval();
    for (Index i = 0; i < d; ++i) (*scaled.prior->covariance)(i, i) = T(4096) / (size[i] * size[i]);
    F a(natural), b(scaled);
    for (Index k = 0; k < data.psi.rows(); ++k) {
        Vector<T> psi(d), times(d);
        for (Index i = 0; i < d; ++i) psi[i] = T(data.psi(k, i)), times[i] = psi[i] * size[i];
        Step<T> const x = a.update(psi, T(data.y[k])), y = b.update(times, T(data.y[k]));
        EXPECT_TRUE(x.innovation == y.innovation && x.gamma == y.gamma && x.residual == y.residual) << F::name << k;
        Stored<T> const P = a.stored(), Q = b.stored();
        for (Index j = 0; j < d; ++j) {
            EXPECT_TRUE(a.theta()[j] == b.theta()[j] * size[j]) << F::name;
            for (Index i = 0; i < d; ++i)
                EXPECT_TRUE(P.F(i, j) == Q.F(i, j) * size[i] * size[j]) << F::name << k << i << j;
        }
    }
}
TEST(Units, OfPowersOfTwoChangeNoBitOfJosephsProducts) {
    auto const in = []<class T>() {
        for (Index const d : {1, 2, 4, 9})
            for (double const lambda : {1.0, 0.96875}) {
                expect_units_change_no_bit<Joseph<T>>(d, lambda);
                expect_units_change_no_bit<JosephRankTwo<T>>(d, lambda);
                expect_units_change_no_bit<Symmetric<T>>(d, lambda);
            }
    };
    in.template operator()<double>();
    in.template operator()<float>();
    in.template operator()<BFloat16>();
}

TEST(Whitened, GoesOnBitForBitFromASavedState) {
    for (Index const rows : {5, 9, 40}) {
        Rows const data = rotated(3, 60, 100, Seed{4});
        WhitenedJoseph<double> one(problem<double>(3, 0.96875, 100), 9);
        fold_in(one, {data.psi.topRows(rows), data.y.head(rows)});
        std::vector<std::byte> bytes(state_size(one));
        save(one, bytes);
        WhitenedJoseph<double> other(problem<double>(3, 0.5, 1), 9);
        load(other, bytes);
        EXPECT_EQ(other.whitened(), rows > 9);
        fold_in(one, data, rows);
        fold_in(other, data, rows);
        EXPECT_TRUE(identical(one, other));
    }
}

TEST(Whitened, WaitsForRowsThatDetermineTheta) {
    WhitenedJoseph<double> f({.size = 3, .prior = std::nullopt}, 1);
    double const same[]{1, 2, 3};
    for (int k = 0; k < 5; ++k) EXPECT_EQ(f.update(same, 1).health, Health::undetermined);
    EXPECT_FALSE(f.whitened());
    double const other[]{1, 0, 1}, third[]{0, 1, -1};
    f.update(other, 1), f.update(third, 2);
    EXPECT_EQ(f.update(other, 1).health, Health::sound);
    EXPECT_TRUE(f.whitened());
}
TEST(Whitened, TellsOfRowsThatAreNotFiniteAndOfMisuse) {
    WhitenedJoseph<double> f(problem<double>(2, 1, 100));
    double const good[]{1, 2}, bad[]{1, NAN}, three[]{1, 2, 3};
    for (int k = 0; k < 9; ++k) f.update(good, 1);
    EXPECT_TRUE(f.whitened());
    EXPECT_THROW(f.update(three, 1), std::invalid_argument);
    EXPECT_EQ(f.update(bad, 1).health, Health::nonfinite);
    EXPECT_THROW(WhitenedJoseph<double>(problem<double>(2, 1, 100), -1), std::invalid_argument);
    EXPECT_THROW(WhitenedJoseph<double>(problem<double>(0, 1, 100)), std::invalid_argument);
}
TEST(Whitened, HasTheSameBitsOfFixedSize) {
    Rows const data = rotated(3, 40, 100, Seed{6});
    WhitenedJoseph<double> dynamic(problem<double>(3, 0.96875, 100));
    Whitened<Joseph<double, 3>, Qr<double, 3>> fixed(problem<double>(3, 0.96875, 100));
    fold_in(dynamic, data);
    fold_in(fixed, data);
    EXPECT_TRUE(dynamic.theta() == fixed.theta() && dynamic.gain() == fixed.gain());
    EXPECT_TRUE(dynamic.stored().F == fixed.stored().F);
}
/// A fixed size may be left out of the problem: `first` is 4 d of it, too.
TEST(Whitened, TakesItsSizeFromItsType) {
    Rows const data = rotated(3, 40, 100, Seed{6});
    Problem<double> const given = problem<double>(3, 0.96875, 100);
    Problem<double> left_out = given;
    left_out.size = 0;
    using F = Whitened<Joseph<double, 3>, Qr<double, 3>>;
    F with(given), without(left_out);
    EXPECT_EQ(load(without, state_of(with)), StateFault::none);
    fold_in(with, data);
    fold_in(without, data);
    EXPECT_TRUE(with.theta() == without.theta() && with.stored().F == without.stored().F);
    EXPECT_EQ(state_of(with), state_of(without));
}
/// Other forms go into that basis, too.
TEST(Whitened, TakesAnyFormThatAdmitsARestart) {
    Rows const data = rotated(4, 50, 1e5, Seed{8});
    Ud<Reference> exact(problem<Reference>(4, 1, 1e10));
    fold_in(exact, data);
    auto const error = [&](auto filter) {
        fold_in(filter, data);
        return relative(wide_covariance(filter), wide_covariance(exact));
    };
    EXPECT_LT(error(Whitened<Symmetric<double>, Qr<double>>(problem<double>(4, 1, 1e10))), 1e-9);
    EXPECT_LT(error(Whitened<Ud<double>, Qr<double>>(problem<double>(4, 1, 1e10))), 1e-9);
    EXPECT_GT(error(Symmetric<double>(problem<double>(4, 1, 1e10))), 1e-9);
}
/// Powers of two in the rows and outputs: the same significands in and after the first rows.
TEST(Whitened, HasItsBitsAtEveryScale) {
    Rows const data = rotated(3, 30, 100, Seed{5});
    WhitenedJoseph<double> one(problem<double>(3, 1, 1));
    fold_in(one, data);
    for (int const e : {-400, 400}) {
        WhitenedJoseph<double> other(problem<double>(3, 1, std::ldexp(1.0, -2 * e)));
        fold_in(other, {std::ldexp(1.0, e) * data.psi, data.y});
        for (Index i = 0; i < 3; ++i) EXPECT_EQ(std::ldexp(other.theta()[i], e), one.theta()[i]) << e;
    }
}

}  // namespace
}  // namespace rlslab
