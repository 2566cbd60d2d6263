// The default prior: its formula in rationals, its two roundings from both sides, units that change no digit.
#include <rlslab/catalogue/catalogue.hpp>
#include "tests/common/laws.hpp"

#include <rlslab/model/default_prior.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

/// y = a + 3 b on columns that differ by 2^-k: the smaller that, the larger a prior it takes.
Records nearly_dependent(int k, Index rows = 40) {
    Records out{.psi = Eigen::MatrixXd(2, rows), .y = Vector<double>(rows), .names = {"a", "b"}};
    Seed seed{std::uint64_t(k + 1)};
    for (Index i = 0; i < rows; ++i) {
        double const a = std::ldexp(std::floor(64 * (seed.uniform() - 0.5)), -5),
                     b = a + std::ldexp(std::floor(64 * (seed.uniform() - 0.5)), -5 - k);
        out.psi.col(i) << a, b;
        out.y[i] = a + 3 * b + std::ldexp(std::floor(64 * seed.uniform()), -8);
    }
    return out;
}

/// theta of two parameters with P0 = diag((c / s_i)^2), by Cramer's rule in rationals; c = 0: without prior.
Vector<Rational> solution(Records const& r, Vector<double> const& s, double c, double lambda) {
    Rational m00 = 0, m01 = 0, m11 = 0, b0 = 0, b1 = 0, l(lambda);
    if (c != 0) {
        m00 = Rational(s[0]) * Rational(s[0]) / (Rational(c) * Rational(c));
        m11 = Rational(s[1]) * Rational(s[1]) / (Rational(c) * Rational(c));
    }
    for (Index k = 0; k < r.rows(); ++k) {
        Rational const x = r.psi(0, k), z = r.psi(1, k), y = r.y[k];
        m00 = l * m00 + x * x, m01 = l * m01 + x * z, m11 = l * m11 + z * z, b0 = l * b0 + x * y, b1 = l * b1 + z * y;
    }
    Rational const det = m00 * m11 - m01 * m01;
    Vector<Rational> theta(2);
    theta[0] = (b0 * m11 - b1 * m01) / det;
    theta[1] = (b1 * m00 - b0 * m01) / det;
    return theta;
}

/// Bias squared in the scaled norm.
Rational bias_squared(Records const& r, Vector<double> const& s, double c, double lambda) {
    Vector<Rational> const with = solution(r, s, c, lambda), without = solution(r, s, 0, lambda);
    Rational change = 0, size = 0;
    for (Index i = 0; i < 2; ++i) {
        Rational const d = (with[i] - without[i]) * Rational(s[i]), w = without[i] * Rational(s[i]);
        change += d * d;
        size += w * w;
    }
    return change / size;
}

Rational const allowed = Rational(1) / 1000000;

/// (4): the largest change of a component, over that of the component or a millionth of the scaled whole.
double component_bias(Records const& r, Vector<double> const& s, double c, double lambda) {
    Vector<Rational> const with = solution(r, s, c, lambda), without = solution(r, s, 0, lambda);
    double whole = 0, out = 0;
    for (Index i = 0; i < 2; ++i) whole = std::hypot(whole, static_cast<double>(without[i]) * s[i]);
    for (Index i = 0; i < 2; ++i) {
        Rational const change = with[i] - without[i];
        out = std::max(out, std::abs(static_cast<double>(change)) /
                                std::max(std::abs(static_cast<double>(without[i])),
                                         std::ldexp(whole, without[i] == 0 ? -20 : -40) / s[i]));
    }
    return out;
}
bool holds(Records const& r, Vector<double> const& s, double c, double lambda) {
    return bias_squared(r, s, c, lambda) <= allowed && component_bias(r, s, c, lambda) <= 1e-2;
}

TEST(DefaultPrior, HasTheLeastCThatMovesThetaByAThousandth) {
    int above_the_least = 0;
    for (int k = 0; k <= 12; ++k)
        for (double lambda : {1.0, 0.96875}) {
            Records const r = nearly_dependent(k);
            DefaultPrior const p = default_prior(r, lambda);
            EXPECT_TRUE(p.reached);
            Rational const at_lambda = bias_squared(r, p.s, p.c, lambda), at_one = bias_squared(r, p.s, p.c, 1);
            EXPECT_LE(at_lambda, allowed) << k;
            EXPECT_LE(at_one, allowed) << k;
            double const larger = std::sqrt(static_cast<double>(std::max(at_lambda, at_one)));
            EXPECT_NEAR(p.bias / larger, 1, 1e-12) << k;
            double const worst = std::max(component_bias(r, p.s, p.c, lambda), component_bias(r, p.s, p.c, 1));
            EXPECT_LE(worst, 1e-2) << k;
            EXPECT_NEAR(p.worst / worst, 1, 1e-12) << k;
            if (p.c > 32) {
                ++above_the_least;
                EXPECT_FALSE(holds(r, p.s, p.c / 2, lambda) && holds(r, p.s, p.c / 2, 1)) << k;
            }
        }
    EXPECT_GT(above_the_least, 10);
    Records small = nearly_dependent(0);  // y = a + 2^-10 b: the norm hardly sees b
    for (Index k = 0; k < small.rows(); ++k) small.y[k] = small.psi(0, k) + std::ldexp(small.psi(1, k), -10);
    DefaultPrior const p = default_prior(small, 1);
    EXPECT_TRUE(holds(small, p.s, p.c, 1) && !holds(small, p.s, p.c / 2, 1));
    EXPECT_LE(bias_squared(small, p.s, p.c / 2, 1), allowed) << "(4) decides";
    EXPECT_EQ(default_prior(nearly_dependent(0), 1).c, 32);
}

/// What the ill-determined direction of theta is worth cancels over the record, but not once its beginning is
/// forgotten.
TEST(DefaultPrior, HoldsForTheForgettingFactorToo) {
    Records r{.psi = Eigen::MatrixXd(2, 64), .y = Vector<double>(64), .names = {}};
    for (Index k = 0; k < 64; ++k) {
        double const strong = k % 2 ? 1 : -1, weak = std::ldexp(k / 2 % 2 ? 1 : -1, -8);
        r.psi.col(k) << strong + weak, strong - weak;
        r.y[k] = strong + (k < 32 ? 64 : -64) * weak;
    }
    double const lambda = 0.9375, c = default_prior(r, lambda).c;
    EXPECT_GT(c, default_prior(r, 1).c);
    EXPECT_LE(bias_squared(r, regressor_scales(r), c, lambda), allowed);
    EXPECT_GT(bias_squared(r, regressor_scales(r), c / 2, lambda), allowed);
    EXPECT_LE(bias_squared(r, regressor_scales(r), c, 1), allowed);
}

TEST(DefaultPrior, RoundsTheSizeOfARegressorToAPowerOfTwo) {
    auto const scale = [](std::vector<double> const& x) {
        Records r{.psi = Eigen::MatrixXd(1, Index(x.size())), .y = Vector<double>::Zero(Index(x.size())), .names = {}};
        for (size_t i = 0; i < x.size(); ++i) r.psi(0, Index(i)) = x[i];
        return regressor_scales(r)[0];
    };
    // mean squares just below and at 2^(2k+1)
    EXPECT_EQ(scale({1.4142135, -1.4142135}), 1);
    EXPECT_EQ(scale({1.4142136, -1.4142136}), 2);
    EXPECT_EQ(scale({0.70710678}), 0.5);
    EXPECT_EQ(scale({0.70710679}), 1);
    EXPECT_EQ(scale({2, 0}), 2);  // mean square 2
    EXPECT_EQ(scale({1, 1, 1, 1}), 1);
    EXPECT_EQ(scale({3, 0, 0, 0, 0}), 1);  // 9/5: divided by the rows, not by one less
    EXPECT_EQ(scale({3, 0, 0, 0}), 2);     // 9/4
    EXPECT_EQ(scale({0, 0}), 1);
    EXPECT_EQ(scale({std::ldexp(1.5, -400), std::ldexp(1.0, -1000)}), std::ldexp(1.0, -400));
    EXPECT_EQ(scale({std::ldexp(1.0, 500)}), std::ldexp(1.0, 500));
    EXPECT_EQ(scale({std::ldexp(1.0, -1074)}), std::ldexp(1.0, -500));  // no further
}

TEST(DefaultPrior, ChangesNoDigitWithTheUnits) {
    Records const r = nearly_dependent(6);
    DefaultPrior const p = default_prior(r, 0.984375);
    for (int a : {-200, -3, 0, 7, 150})
        for (int y : {-100, 0, 300}) {
            Records scaled = r;
            scaled.psi.row(0) *= std::ldexp(1.0, a);
            scaled.psi.row(1) *= std::ldexp(1.0, -a);
            scaled.y *= std::ldexp(1.0, y);
            DefaultPrior const q = default_prior(scaled, 0.984375);
            EXPECT_EQ(q.c, p.c);
            EXPECT_NEAR(q.bias / p.bias, 1, 1e-15);
            EXPECT_EQ(q.s[0], std::ldexp(p.s[0], a));
            EXPECT_EQ(q.s[1], std::ldexp(p.s[1], -a));
            Ud<double> f({.size = 2, .prior = p.prior()}), g({.size = 2, .prior = q.prior()});
            for (Index k = 0; k < r.rows(); ++k) {
                f.update(r.sample(k), r.y[k]);
                g.update(scaled.sample(k), scaled.y[k]);
            }
            EXPECT_EQ(g.theta()[0], std::ldexp(f.theta()[0], y - a));
            EXPECT_EQ(g.theta()[1], std::ldexp(f.theta()[1], y + a));
        }
}

TEST(DefaultPrior, SaysWhenTheDataDoNotDetermineTheta) {
    Records r = nearly_dependent(3);
    r.psi.row(1).setZero();
    DefaultPrior const p = default_prior(r, 1);
    EXPECT_TRUE(std::isnan(p.bias));
    EXPECT_FALSE(p.reached);
    EXPECT_EQ(p.c, 32);
    EXPECT_EQ(p.s[1], 1);
    r.y[3] = std::nan("");
    EXPECT_THROW(default_prior(r, 1), std::invalid_argument);
}

TEST(DefaultPrior, StopsBeforeP0LeavesTheRange) {
    Records r = nearly_dependent(2);
    r.psi *= std::ldexp(1.0, -497);
    DefaultPrior p = default_prior(r, 1);  // (2^5 / 2^-497)^2 would be 2^1004
    EXPECT_EQ(p.prior().covariance->maxCoeff(), std::ldexp(1.0, 1000));
    r = nearly_dependent(40);
    r.psi *= std::ldexp(1.0, -480);  // c would have to be some 2^44
    p = default_prior(r, 1);
    EXPECT_FALSE(p.reached);
    EXPECT_GT(p.bias, 1e-3);
    EXPECT_EQ(p.prior().covariance->maxCoeff(), std::ldexp(1.0, 1000));
    EXPECT_EQ(p.c / p.s.minCoeff(), std::ldexp(1.0, 500));
}

/// P0 and its root are powers of two, so every arithmetic that reaches them has them, and every variant starts from
/// them.
TEST(DefaultPrior, IsExactInEveryArithmeticAndTakenByEveryVariant) {
    Records r = nearly_dependent(3);
    r.psi.row(1) *= 5;
    DefaultPrior const p = default_prior(r, 1);
    Matrix<double> const P0 = *p.prior().covariance;
    EXPECT_EQ(P0(0, 1), 0);
    for (Index i = 0; i < 2; ++i) {
        int exponent;
        EXPECT_EQ(std::frexp(P0(i, i), &exponent), 0.5);
        EXPECT_EQ((exponent - 1) % 2, 0);
        EXPECT_EQ(P0(i, i), p.c / p.s[i] * (p.c / p.s[i]));
    }
    for (CatalogueEntry const& entry : catalogue()) {
        auto const f = entry.make({.size = 2, .prior = p.prior()}, Seed{1});
        for (Index i = 0; i < 2; ++i) EXPECT_EQ(entry.arithmetic->round(P0(i, i)), P0(i, i)) << entry.arithmetic->name;
        Stored<Reference> const stored = f->stored();
        Problem<double> none{.size = 2, .prior = p.prior()};
        Records zero{.psi = Eigen::MatrixXd::Zero(2, 1), .y = Vector<double>::Zero(1), .names = {}};
        EXPECT_EQ(certified(none, zero, {1}).front().covariance_digits(stored), std::numeric_limits<double>::infinity())
            << entry.variant << " " << entry.arithmetic->name;
    }
}

/// docs/theory.md 130 in the eigenvectors of the rows: g_i, theta along them, noise 1, P0 = c^2 I. E|theta_k|^2.
Rational start(std::vector<Rational> const& g, std::vector<Rational> const& theta, Rational const& c2) {
    Rational sum = 0;
    for (size_t i = 0; i < g.size(); ++i) {
        Rational const p = Rational(1) / (g[i] + 1 / c2), kept = p * g[i];
        sum += kept * kept * theta[i] * theta[i] + p * p * g[i];
    }
    return sum;
}
/// c^2 = |theta|^2: at most twice for d <= 5, more for d = 6. c^2 = |theta|^2 / d: below 5/4. With c^2 >= |theta|^2 / 2
/// no direction errs by more than least squares; with a smaller one some direction does.
TEST(DefaultPrior, ThatSaysHowLargeAParameterMayBe) {
    Seed seed{127};
    auto const drawn = [&](int range) { return Rational(1 + int(seed.next() % unsigned(range))); };
    for (int n = 0; n < 400; ++n) {
        size_t const d = 1 + n % 9;
        std::vector<Rational> g, theta;
        Rational size = 0;
        for (size_t i = 0; i < d; ++i) {
            theta.push_back(n % 3 == 0 && i > 0 ? Rational(0) : drawn(9) - 5);
            size += theta.back() * theta.back();
        }
        if (size == 0) continue;
        for (size_t i = 0; i < d; ++i) g.push_back(n % 3 == 0 && i > 0 ? 1 / size : drawn(100) / drawn(100) / size);
        if (n % 3 == 0) g[0] = Rational(1000000);
        for (Rational const& rho : {Rational(1), Rational(2), Rational(1) / int(d), Rational(1) / 16})
            EXPECT_LE(start(g, theta, rho * size), (1 + rho * (int(d) - 1) / 4) * size) << n;
        EXPECT_LE(start(g, theta, size / int(d)), size * 5 / 4);
        if (n % 3 == 0 && d >= 6) {
            EXPECT_GT(start(g, theta, size), 2 * size) << d;
        }
        if (d <= 5) {
            EXPECT_LE(start(g, theta, size), 2 * size) << d;
        }
        Rational const c2 = size / 2, least_squares = 1 / g[0], p = 1 / (g[0] + 1 / c2);
        EXPECT_LE(p * p * (size / (c2 * c2) + g[0]), least_squares);
    }
    Rational const size = 4, c2 = 1, g = 1000, p = 1 / (g + 1 / c2);
    EXPECT_GT(p * p * (size / (c2 * c2) + g), 1 / g) << "c^2 = |theta|^2 / 4 is too small";
}

}  // namespace
}  // namespace rlslab
