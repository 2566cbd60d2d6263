// Draws of theta and the least excited direction, from the factor that a filter stores.
#include <rlslab/arithmetic/multiprecision.hpp>

#include "tests/adapt/adapt.hpp"
#include "tests/common/same.hpp"

#include <rlslab/adapt/excitation.hpp>
#include <rlslab/adapt/sample.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace adapt_laws;
using Q = Rational;
constexpr Index d = 4;

// --- S S' = P, exactly -----------------------------------------------------------------------------------------------

template <class T>
Stored<T> stored_of(bool covariance, Matrix<T> const& F) {
    using S = Stored<T>;
    return {covariance ? S::Quantity::covariance : S::Quantity::information, S::Form::factor, F};
}
/// F of small fractions, lower triangular where it is of P^-1.
Matrix<Q> factor(bool covariance, Seed& seed) {
    Matrix<Q> F(d, d);
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i) {
            F(i, j) = Q(int(seed.next() % 19) - 9) / int(1 + seed.next() % 5);
            if (!covariance && i < j) F(i, j) = 0;
            if (i == j && F(i, j) == 0) F(i, j) = 2;
        }
    return F;
}
/// With e_i for z the draws are the columns of S: sum_i (draw_i - theta) (draw_i - theta)' = scale^2 P, exactly.
template <class Draw>
bool spans_P(bool covariance, Draw draw) {
    Seed seed{covariance ? 5u : 6u};
    for (int trial = 0; trial < 20; ++trial) {
        Matrix<Q> const F = factor(covariance, seed);
        RootOf<Q> const S(stored_of<Q>(covariance, F));
        Vector<Q> theta(d), z(d), v(d), out(d);
        for (Q& x : theta) x = Q(int(seed.next() % 9)) / 7;
        Q const scale = Q(3) / 5;
        Matrix<Q> sum = Matrix<Q>::Zero(d, d);
        for (Index i = 0; i < d; ++i) {
            for (Index k = 0; k < d; ++k) z[k] = k == i ? 1 : 0;
            draw(S, F, theta, scale, z, v, out);
            for (Index a = 0; a < d; ++a)
                for (Index b = 0; b < d; ++b) sum(a, b) += (out[a] - theta[a]) * (out[b] - theta[b]);
            if (covariance && Vector<Q>((out - theta) / scale) != Vector<Q>(F.col(i))) return false;
        }
        Matrix<Q> const X = F.lazyProduct(F.transpose());
        Matrix<Q> const found = covariance ? sum : Matrix<Q>(sum.lazyProduct(X));
        Matrix<Q> const expected =
            covariance ? Matrix<Q>(X * Q(scale * scale)) : Matrix<Q>(Matrix<Q>::Identity(d, d) * Q(scale * scale));
        if (found != expected) return false;
    }
    return true;
}
TEST(Sample, SpansPExactly) {
    auto const draw = [](RootOf<Q> const& S, Matrix<Q> const&, auto& theta, Q const& scale, auto& z, auto& v,
                         auto& out) { draw_of(S, theta.data(), scale, z.data(), v.data(), out.data()); };
    auto const transposed = [](RootOf<Q> const& S, Matrix<Q> const& F, auto& theta, Q const& scale, auto& z, auto& v,
                               auto& out) {
        bool const lower = F(0, 1) == 0 && F(0, 2) == 0 && F(0, 3) == 0;
        if (lower) S.times(z.data(), v.data()), v = F.lazyProduct(F.transpose().lazyProduct(v).eval()).eval();
        else v = F.transpose().lazyProduct(z).eval();
        out = theta + v * scale;
    };
    for (bool const covariance : {true, false}) {
        EXPECT_TRUE(spans_P(covariance, draw)) << covariance;
        EXPECT_FALSE(spans_P(covariance, transposed)) << covariance;
    }
}

// --- in binary64, of every variant that stores a root ----------------------------------------------------------------

template <class F>
F warm(int rows = 40) {
    F f(Problem<double>{.size = d, .forgetting = 0.96875, .prior = Prior<double>{.variance = 4}});
    run_rows(f, rows, Seed{3});
    return f;
}
template <class F>
std::vector<double> draws(F const& f, std::uint64_t seed, Index n, double scale) {
    std::vector<double> out(size_t(n * d));
    sample(f, seed, n, scale, out.data());
    return out;
}
template <class F>
constexpr bool has_a_root =
    F::name != "conventional" && F::name != "conventional_two_sided" && F::name != "symmetric" && F::name != "joseph" &&
    F::name != "joseph_rank_two" && F::name != "kalman" && F::name != "information";

TEST(Sample, IsOfPOfEveryVariantThatStoresARoot) {
    int with_a_root = 0;
    for_each(Variants<double>{}, [&]<class F>() {
        F const f = warm<F>();
        if constexpr (!has_a_root<F>) {
            EXPECT_THROW(draws(f, 1, 3, 1), std::invalid_argument) << F::name;
            EXPECT_THROW(least_excited(f, std::vector<double>(d).data()), std::invalid_argument) << F::name;
        } else {
            ++with_a_root;
            constexpr Index n = 20000;
            auto const theta = f.theta();
            auto const out = draws(f, 7, n, 0.5);
            EXPECT_TRUE(same(draws(f, 7, 3, 0.5), std::vector<double>(out.begin(), out.begin() + 3 * d))) << F::name;
            EXPECT_FALSE(same(draws(f, 8, n, 0.5), out));
            Matrix<double> P = Matrix<double>::Zero(d, d);
            Vector<double> mean = Vector<double>::Zero(d);
            for (Index k = 0; k < n; ++k) {
                Vector<double> const e = Eigen::Map<Vector<double> const>(&out[size_t(k * d)], d) - theta;
                P += e * e.transpose() * 4 / n;
                mean += e / n;
            }
            Matrix<double> const expected = covariance_of(f);
            EXPECT_LT(relative(P, expected), 6 / std::sqrt(double(n))) << F::name;
            EXPECT_LT(mean.cwiseAbs().maxCoeff(), 6 * std::sqrt(expected.maxCoeff() / n)) << F::name;
            for (Index i = 0; i < d; ++i) EXPECT_EQ(draws(f, 7, 1, 0)[size_t(i)], theta[i]) << F::name;
            EXPECT_TRUE(identical(f, warm<F>())) << F::name;
        }
    });
    EXPECT_EQ(with_a_root, 11);
}
/// A factor of P, or of its inverse.
struct Given {
    using scalar = double;
    Stored<double> held;
    Stored<double> stored() const { return held; }
    Vector<double> theta() const { return Vector<double>::Zero(held.F.rows()); }
};
TEST(Sample, IsNaNWhereThetaOrPIsNone) {
    auto const all_nan = [](auto const& f) {
        for (double const x : draws(f, 1, 2, 1))
            if (!std::isnan(x)) return false;
        std::vector<double> u(d);
        auto const found = least_excited(f, u.data());
        return std::isnan(found.ratio) && std::isnan(found.deviation) && std::isnan(u[0]);
    };
    for_each(Variants<double>{}, [&]<class F>() {
        if constexpr (has_a_root<F> && StartsWithoutPrior<F>) {
            F f(Problem<double>{.size = d, .prior = std::nullopt});
            double const psi[] = {1, 1, 1, 0.1};
            for (int k = 0; k < 9; ++k) {
                EXPECT_TRUE(all_nan(f)) << F::name << k;
                f.update(Regressor<double>(psi, d), 1);
            }
            run_rows(f, 9, Seed{3});
            EXPECT_FALSE(all_nan(f)) << F::name;
        }
        if constexpr (has_a_root<F>) {
            F f = warm<F>();
            double const psi[] = {1, NAN, 1, 1};
            f.update(Regressor<double>(psi, d), 1);
            EXPECT_TRUE(all_nan(f)) << F::name;
        }
    });
    for (bool const covariance : {true, false})
        for (double const last : {1.0, -1e-9, double(NAN), double(INFINITY)}) {
            Given indefinite{stored_of<double>(covariance, Matrix<double>::Identity(d, d))};
            indefinite.held.D = Vector<double>::Ones(d);
            indefinite.held.D[d - 1] = last;
            EXPECT_EQ(all_nan(indefinite), last != 1) << covariance << last;
        }
    for (double const scale : {-1.0, double(NAN), double(INFINITY)})
        EXPECT_THROW(draws(warm<Ud<double>>(), 1, 2, scale), std::invalid_argument);
    EXPECT_THROW(sample(warm<Ud<double>>(), 1, -1, 1.0, nullptr), std::invalid_argument);
}

// --- the least excited direction -------------------------------------------------------------------------------------

struct Found {
    Vector<double> u;
    double deviation, ratio;
};
template <class F>
Found found(F const& f, Index size) {
    Found out{Vector<double>(size), 0, 0};
    auto const report = least_excited(f, out.u.data());
    out.deviation = report.deviation, out.ratio = report.ratio;
    return out;
}
Matrix<double> scaled(Matrix<double> const& P) {
    Vector<double> const by = P.diagonal().cwiseSqrt().cwiseInverse();
    return by.asDiagonal() * P * by.asDiagonal();
}
double largest_eigenvalue(Matrix<double> const& C) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(C)).eigenvalues().maxCoeff();
}
/// Whether the three numbers are what they are said to be, and the ratio is a lower bound.
bool certified(Found const& f, Matrix<double> const& P) {
    Matrix<double> const C = scaled(P);
    Vector<double> v = f.u.cwiseQuotient(P.diagonal().cwiseSqrt());
    v /= v.norm();
    double const top = largest_eigenvalue(C);
    return std::abs(f.u.norm() - 1) < 1e-12 && std::abs(f.deviation / std::sqrt(f.u.dot(P * f.u)) - 1) < 1e-6 &&
           std::abs(f.ratio / v.dot(C * v) - 1) < 1e-6 && f.ratio <= top * (1 + 1e-9) && f.ratio >= 1 - 1e-9;
}
TEST(LeastExcited, IsALowerBoundOfTheLargestEigenvalue) {
    Seed seed{11};
    int trials = 0, close = 0, with_the_transpose = 0;
    double worst = 1;
    for (Index size : {1, 2, 3, 5, 8, 16})
        for (int trial = 0; trial < 100; ++trial) {
            Carlson<double> f(Problem<double>{.size = size, .forgetting = 0.98});
            Qr<double> g(Problem<double>{.size = size, .forgetting = 0.98});
            double const depends = trial % 4 == 0 ? 0 : std::pow(10.0, -seed.uniform() * 3);
            for (int k = 0; k < 60; ++k) {
                Vector<double> psi(size);
                for (double& x : psi) x = seed.bell();
                if (size > 1 && depends > 0) psi[size - 1] = psi[0] + depends * psi[size - 1];
                f.update(psi, seed.bell()), g.update(psi, 0);
            }
            Matrix<double> const P = covariance_of(f);
            Found const report = found(f, size), other = found(g, size);
            EXPECT_TRUE(certified(report, P)) << size << " " << report.ratio << " " << largest_eigenvalue(scaled(P));
            EXPECT_NEAR(other.ratio / report.ratio, 1, 1e-6);  // one triangle but for signs, by its inverse
            Given const transposed{stored_of<double>(true, Matrix<double>(f.stored().F.transpose()))};
            with_the_transpose += size > 1 && certified(found(transposed, size), P);
            double const share = report.ratio / largest_eigenvalue(scaled(P));
            worst = std::min(worst, share);
            ++trials, close += share > 0.9;
        }
    EXPECT_GT(close, trials * 9 / 10) << close << " of " << trials;
    EXPECT_GT(worst, 0.7);
    EXPECT_LT(with_the_transpose, trials / 50) << "the law knows a wrong factor";
}
/// The first start, the largest column, is at right angles to the direction; the second finds it.
TEST(LeastExcited, IsFoundFromAStartAtRightAngles) {
    constexpr Index pair = 2, block = 8, size = pair + block;
    double const r = 0.99, s = 0.9;
    Matrix<double> C = Matrix<double>::Identity(size, size), F = Matrix<double>::Zero(size, size);
    C(0, 1) = C(1, 0) = r;
    for (Index i = pair; i < size; ++i)
        for (Index j = pair; j < size; ++j) C(i, j) = i == j ? 1 : s;
    F(0, 1) = r, F(1, 1) = 1, F(0, 0) = std::sqrt(1 - r * r);
    double const large = std::sqrt(1 + (block - 1) * s), small = std::sqrt(1 - s);
    for (Index i = pair; i < size; ++i)
        for (Index j = pair; j < size; ++j) F(i, j) = (large - small) / block + (i == j ? small : 0);
    ASSERT_LT(relative(F * F.transpose(), C), 1e-14);
    Vector<double> start = F.col(1);  // whose length is the largest
    for (int step = 0; step < 2; ++step) start = (C * start).eval() / (C * start).norm();
    EXPECT_LT(start.dot(C * start), 2);  // what the first start finds alone
    Found const report = found(Given{stored_of<double>(true, F)}, size);
    EXPECT_TRUE(certified(report, C));
    EXPECT_GT(report.ratio, 0.99 * largest_eigenvalue(C));
    EXPECT_GT(report.ratio, 7);
}
/// Parameters in other units, by powers of two: the same ratio, bit for bit.
TEST(LeastExcited, NoUnitChangesTheRatio) {
    for (auto const& [first, last] : {std::pair(0x1p-40, 0x1p60), std::pair(0x1p-600, 0x1p-900)}) {
        Matrix<double> const F = Carlson<double>(warm<Carlson<double>>()).stored().F;
        Matrix<double> scaled_F = F;
        scaled_F.row(0) *= first;
        scaled_F.row(d - 1) *= last;
        Found const a = found(Given{stored_of<double>(true, F)}, d),
                    b = found(Given{stored_of<double>(true, scaled_F)}, d);
        EXPECT_EQ(a.ratio, b.ratio);
    }
}

}  // namespace
}  // namespace rlslab
