// What `certified` promises, with enclosures that are just too wide; radii and digits of enclosures made by hand. Where
// it stops, and what it decides there: the largest precision, and a solution of exactly zero. Tails and quantiles.
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/reference/balls.hpp>
#include <rlslab/reference/certified.hpp>
#include <rlslab/reference/distributions.hpp>
#include <rlslab/reference/enclosure.hpp>

#include <gtest/gtest.h>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace rlslab {
namespace {

using namespace balls;

/// middle +- radius, both exact.
void set_ball(arb_ptr ball, double middle, double radius) {
    arb_set_d(ball, middle);
    Float const r(radius);
    arf_get_mag(arb_radref(ball), r);  // rounded up
}

/// theta = (t, s), P = [p q; q p], all radii but those given zero.
CertifiedSolution::Enclosure enclosure(double t, double rad_t, double s, double rad_s, double p, double rad_p, double q,
                                       double rad_q, int digits = 10) {
    CertifiedSolution::Enclosure x{BallMatrix(2, 1), BallMatrix(2, 2), 128, digits};
    set_ball(x.theta(0, 0), t, rad_t);
    set_ball(x.theta(1, 0), s, rad_s);
    set_ball(x.covariance(0, 0), p, rad_p);
    set_ball(x.covariance(0, 1), q, rad_q);
    set_ball(x.covariance(1, 0), q, rad_q);
    set_ball(x.covariance(1, 1), p, rad_p);
    return x;
}

constexpr double too_wide = 1 + 1e-6;
/// The criterion works in powers of two: 2^-34 for ten digits, which ask for 2^-33.2; and a radius is kept to 30 bits,
/// rounded up.
constexpr double narrow = 0x1p-34 * (1 - 1e-6);

TEST(ReferencePromise, EachComponentOfTheta) {
    for (double const size : {1.0, 3.0, 0x1p300, 0x1p-300}) {
        EXPECT_TRUE(theta_is_accurate(enclosure(size, narrow * size, size, 0, 1, 0, 0, 0)));
        EXPECT_TRUE(theta_is_accurate(enclosure(-size, 0, size, narrow * size, 1, 0, 0, 0)));
        EXPECT_FALSE(theta_is_accurate(enclosure(size, too_wide * 1e-10 * size, size, 0, 1, 0, 0, 0)));
        EXPECT_FALSE(theta_is_accurate(enclosure(size, 0, -size, too_wide * 1e-10 * size, 1, 0, 0, 0)));
        // relative to itself, not to a larger one
        EXPECT_FALSE(theta_is_accurate(enclosure(size, 0, size / 1024, too_wide * 1e-10 * size / 1024, 1, 0, 0, 0)));
    }
}
TEST(ReferencePromise, AComponentFortyDigitsSmallerThanTheLargest) {
    EXPECT_FALSE(theta_is_accurate(enclosure(1, 0, 0, too_wide * 1e-50, 1, 0, 0, 0)));
    EXPECT_FALSE(theta_is_accurate(enclosure(1, 0, 1e-41, too_wide * 1e-50, 1, 0, 0, 0)));
    EXPECT_TRUE(theta_is_accurate(enclosure(1, 0, 0, narrow * 0x1p-133, 1, 0, 0, 0)));
    EXPECT_TRUE(theta_is_accurate(enclosure(0, 0, 0, 0, 1, 0, 0, 0)));
    EXPECT_FALSE(theta_is_accurate(enclosure(0, 1e-300, 0, 0, 1, 0, 0, 0)));
}
TEST(ReferencePromise, EachEntryOfPRelativeToTheLargest) {
    for (double const size : {1.0, 5.0, 0x1p200, 0x1p-200}) {
        EXPECT_TRUE(covariance_is_accurate(enclosure(1, 0, 1, 0, size, narrow * size, 0, narrow * size)));
        EXPECT_FALSE(covariance_is_accurate(enclosure(1, 0, 1, 0, size, too_wide * 1e-10 * size, 0, 0)));
        EXPECT_FALSE(covariance_is_accurate(enclosure(1, 0, 1, 0, size, 0, 0, too_wide * 1e-10 * size)));
        EXPECT_FALSE(covariance_is_accurate(enclosure(1, 0, 1, 0, size, size, 0, 0)));
    }
}
TEST(ReferencePromise, IsOfTheDigitsAskedFor) {
    for (int const digits : {1, 15, 30, 100, 300}) {
        double const promised = std::pow(10.0, -digits);
        EXPECT_FALSE(theta_is_accurate(enclosure(1, too_wide * promised, 1, 0, 1, 0, 0, 0, digits))) << digits;
        EXPECT_FALSE(covariance_is_accurate(enclosure(1, 0, 1, 0, 1, too_wide * promised, 0, 0, digits))) << digits;
        EXPECT_TRUE(theta_is_accurate(enclosure(1, 0.49 * promised, 1, 0, 1, 0, 0, 0, digits))) << digits;
        EXPECT_TRUE(covariance_is_accurate(enclosure(1, 0, 1, 0, 1, 0.49 * promised, 0, 0, digits))) << digits;
    }
}

CertifiedSolution by_hand(CertifiedSolution::Enclosure const& x) {
    return CertifiedSolution(7, 2, std::make_shared<CertifiedSolution::Enclosure const>(x));
}

TEST(ReferencePromise, RadiiAreRelativeInTheNormAndNeverTooSmall) {
    CertifiedSolution const e = by_hand(enclosure(3, 0x1p-20, 4, 0x1p-20, 6, 0x1p-10, -8, 0x1p-11));
    double const theta = std::sqrt(2.0) * 0x1p-20 / 5;  // of ||theta|| = 5
    EXPECT_GE(e.radius(), theta);
    EXPECT_LE(e.radius(), theta * (1 + 1e-5));
    double const P = std::sqrt(2 * 0x1p-20 + 2 * 0x1p-22) / std::sqrt(200.0);  // of ||P||_F = sqrt(2 36 + 2 64)
    EXPECT_GE(e.covariance_radius(), P);
    EXPECT_LE(e.covariance_radius(), P * (1 + 1e-3));
    EXPECT_EQ(by_hand(enclosure(3, 0, 4, 0, 1, 0, 0, 0)).radius(), 0);
    EXPECT_EQ(by_hand(enclosure(0, 0.5, 0, 0, 1, 0, 0, 0)).radius(), std::numeric_limits<double>::infinity());
}

TEST(ReferencePromise, DigitsCountTheEnclosureAgainstTheEstimate) {
    // Off by 0.5 in a norm of 5, and the ball is as wide again in one component: at most 1 = |(0, 0.5 + 0.5)| from 4.5
    // less the ball.
    CertifiedSolution const sharp = by_hand(enclosure(3, 0, 4, 0, 6, 0, -8, 0)),
                            wide = by_hand(enclosure(3, 0, 4, 0.5, 6, 0, -8, 0));
    Vector<Reference> const estimate{{Reference(3), Reference(4.5)}};
    EXPECT_NEAR(sharp.theta_digits(estimate), 1, 1e-14);
    EXPECT_NEAR(sharp.theta_digits_worst(estimate), -std::log10(0.125), 1e-14);
    EXPECT_LE(wide.theta_digits(estimate), -std::log10(1.0 / std::hypot(3, 4.5)));
    EXPECT_LE(wide.theta_digits_worst(estimate), -std::log10(1.0 / 4.5));
    Matrix<Reference> P{{Reference(6), Reference(-8)},
                        {Reference(-8), Reference(7)}};  // one entry off by 1 of sqrt(200)
    using S = Stored<Reference>;
    EXPECT_NEAR(sharp.covariance_digits({S::Quantity::covariance, S::Form::plain, P}), 0.5 * std::log10(200.0), 1e-14);
    P(0, 0) = 7, P(1, 1) = 6;
    EXPECT_NEAR(sharp.covariance_digits({S::Quantity::covariance, S::Form::plain, P}), 0.5 * std::log10(200.0), 1e-14);
}

TEST(ReferencePromise, ChangesAreRelativeToTheSecond) {
    CertifiedSolution const a = by_hand(enclosure(3, 0, 4, 0, 1, 0, 0, 0)),
                            b = by_hand(enclosure(3, 0, 0, 0, 1, 0, 0, 0)),
                            zero = by_hand(enclosure(0, 0, 0, 0, 1, 0, 0, 0));
    EXPECT_DOUBLE_EQ(relative_change(a, b), 4.0 / 3);
    EXPECT_DOUBLE_EQ(relative_change(b, a), 0.8);
    EXPECT_DOUBLE_EQ(relative_change(a, b, Vector<double>{{2.0, 0.5}}), 2.0 / 6);
    EXPECT_DOUBLE_EQ(relative_change(b, a, Vector<double>{{1.0, 2.0}}), 8 / std::sqrt(73.0));
    EXPECT_EQ(relative_change(a, zero), std::numeric_limits<double>::infinity());
    EXPECT_EQ(relative_change(zero, zero), 0);
    // The bias by a prior: one parameter, M = 1, b = 1; theta = 1 without it and 1 / (1 + 1/c^2) with it.
    Records const data{.psi = Eigen::MatrixXd::Ones(1, 1), .y = Vector<double>::Ones(1), .names = {}};
    auto const at = [&](Problem<double> const& problem) { return certified(problem, data, {1}).front(); };
    CertifiedSolution const without = at({.size = 1, .prior = std::nullopt});
    EXPECT_NEAR(relative_change(at({.size = 1, .prior = Prior<double>{.variance = 3}}), without), 0.25, 1e-15);
    EXPECT_NEAR(relative_change(at({.size = 1}), without), 1 / 16385.0, 1e-19);
    CertifiedSolution const none(1, 2, 0, Status::unresolved);
    EXPECT_TRUE(std::isnan(relative_change(none, a)) && std::isnan(relative_change(a, none)));
    EXPECT_THROW(relative_change(a, b, Vector<double>{{1.0}}), std::invalid_argument);
}

/// Nearly parallel regressors on a grid of powers of two: kappa of the Gram matrix about 2^(2k).
Records nearly_parallel(int k, double y) {
    Records out{.psi = Eigen::MatrixXd(2, 6), .y = Vector<double>::Zero(6), .names = {}};
    for (Index i = 0; i < 6; ++i) {
        double const x = double(i % 3 + 1), z = x + std::ldexp(double(i % 2), -k);
        out.psi.col(i) << x, z;
        if (y != 0) out.y[i] = y * (x + std::ldexp(z, -40));
    }
    return out;
}

/// theta is zero exactly at any precision, so that P alone asks for more bits; and theta's small component alone.
TEST(ReferencePromise, HoldsOfWhatIsCertified) {
    for (double const lambda : {1.0, 0.75})
        for (int const k : {10, 30, 45})
            for (double const y : {0.0, 1.0})
                for (int const digits : {30, 60, 90}) {
                    Problem<double> problem{.size = 2, .forgetting = lambda, .prior = std::nullopt};
                    for (CertifiedSolution const& e : certified(problem, nearly_parallel(k, y), {3, 6}, digits)) {
                        ASSERT_EQ(e.status(), Status::certified);
                        BallMatrix const &theta = e.enclosure()->theta, &P = e.enclosure()->covariance;
                        Float largest_P, largest_theta, size;
                        for (Index i = 0; i < 2; ++i) {
                            arf_abs(size, arb_midref(theta(i, 0)));
                            arf_max(largest_theta, largest_theta, size);
                            for (Index j = 0; j < 2; ++j) {
                                arf_abs(size, arb_midref(P(i, j)));
                                arf_max(largest_P, largest_P, size);
                            }
                        }
                        // 10^digits times the radius
                        auto const scaled = [&](mag_srcptr radius) {
                            Float out, ten(10.0);
                            arf_set_mag(out, radius);
                            for (int n = 0; n < digits; ++n) arf_mul(out, out, ten, ARF_PREC_EXACT, ARF_RND_DOWN);
                            return out;
                        };
                        Float floor,
                            tiny(1e-40);  // a component so much smaller than the largest is held to that; one here is
                                          // zero
                        arf_mul(floor, largest_theta, tiny, ARF_PREC_EXACT, ARF_RND_DOWN);
                        for (Index i = 0; i < 2; ++i) {
                            arf_abs(size, arb_midref(theta(i, 0)));
                            arf_max(size, size, floor);
                            EXPECT_LE(arf_cmp(scaled(arb_radref(theta(i, 0))), size), 0) << k << " " << digits;
                            for (Index j = 0; j < 2; ++j)
                                EXPECT_LE(arf_cmp(scaled(arb_radref(P(i, j))), largest_P), 0) << k << " " << digits;
                        }
                        EXPECT_LE(e.radius(), std::pow(10.0, -digits));
                        EXPECT_LE(e.covariance_radius(), 2 * std::pow(10.0, -digits));
                        EXPECT_EQ(e.bits() % 64, 0);
                        EXPECT_EQ(e.rank(), 2);
                    }
                }
}

// --- the largest precision, and zero ---------------------------------------------------------------------------------

/// Rows (x, x) -> y: the difference of the two parameters is known from the prior alone.
Records twins(Index rows) {
    Records data{.psi = Eigen::MatrixXd(2, rows), .y = Vector<double>(rows), .names = {}};
    for (Index k = 0; k < rows; ++k) {
        data.psi.col(k).setConstant(double(k % 5) - 2);
        data.y[k] = double(k % 3);
    }
    return data;
}

TEST(Certified, AllOf65536BitsAreTried) {
    // The prior is 2^-52000 of the data: between three quarters of 2^16 bits and all of them.
    CertifiedSolution const exact = certified({.size = 2, .forgetting = 0.5}, twins(52000), {52000}).front();
    EXPECT_EQ(exact.status(), Status::certified);
    EXPECT_EQ(exact.bits(), 65536);
    EXPECT_EQ(certified({.size = 2, .forgetting = 0.5}, twins(66000), {66000}).front().status(), Status::unresolved);
}

/// One row that carries theta0 to exactly zero (`off` = 0), and the inverse of P0 is no binary fraction.
struct ToZero {
    Problem<double> problem;
    Records data;
};
ToZero one_parameter(double off) {
    Records data{.psi = Eigen::MatrixXd::Constant(1, 1, 1), .y = Vector<double>::Constant(1, -1 + off), .names = {}};
    return {{.size = 1, .prior = Prior<double>{.variance = 3, .theta = Vector<double>::Constant(1, 3)}}, data};
}
ToZero two_parameters(double lambda, double off) {  // P0^-1 = [2 -1; -1 5] / 9
    Matrix<double> const P0 = (Matrix<double>(2, 2) << 5, 1, 1, 2).finished();
    Vector<double> const s = Eigen::Vector2d(-3, 4), theta = P0 * s;
    Records data{.psi = Eigen::MatrixXd::Identity(2, 2), .y = -s, .names = {}};
    data.y[0] *= lambda;  // two rows: the prior weighs lambda^2, the first row lambda
    data.y[1] *= lambda * lambda;
    data.y[1] += off;
    return {{.size = 2, .forgetting = lambda, .prior = Prior<double>{.theta = theta, .covariance = P0}}, data};
}

TEST(Certified, ZeroIsCertifiedUnderAnInexactPrior) {
    for (ToZero const& to : {one_parameter(0), two_parameters(1, 0), two_parameters(0.5, 0), two_parameters(0.75, 0)}) {
        Index const k = to.data.rows();
        CertifiedSolution const exact = certified(to.problem, to.data, {k}).front();
        ASSERT_EQ(exact.status(), Status::certified) << k << " " << to.problem.forgetting;
        EXPECT_EQ(exact.radius(), 0);
        for (Reference const& x : exact.theta()) EXPECT_EQ(x, 0);
        for (std::string const& text : exact.theta_strings()) EXPECT_EQ(text, "0");
        EXPECT_EQ(exact.theta_digits(Vector<Reference>::Zero(k)), std::numeric_limits<double>::infinity());
        EXPECT_EQ(exact.theta_digits(Vector<Reference>::Ones(k)), -std::numeric_limits<double>::infinity());
        EXPECT_LT(exact.covariance_radius(), 1e-30);
    }
}

TEST(Certified, NearlyZeroIsNotZero) {
    for (double const off : {0x1p-40, -0x1p-50})
        for (ToZero const& to : {one_parameter(off), two_parameters(1, off), two_parameters(0.5, off)}) {
            CertifiedSolution const exact = certified(to.problem, to.data, {to.data.rows()}).front();
            ASSERT_EQ(exact.status(), Status::certified);
            EXPECT_LT(exact.radius(), 1e-30);
            EXPECT_GT(exact.radius(), 0);
            EXPECT_NE(exact.theta()[to.data.rows() - 1], 0);
        }
}

/// Columns of both signs of which the third is the difference of the first two: their magnitudes are independent.
TEST(Certified, ARankIsThatOfTheSignedNumbers) {
    Records data{.psi = Eigen::MatrixXd(3, 12), .y = Vector<double>::Ones(12), .names = {}};
    for (Index k = 0; k < 12; ++k) {
        double const a = double(k * 7 % 11) - 5, b = double(k * 5 % 9) - 4;
        data.psi.col(k) << a, b, a - b;
    }
    CertifiedSolution const singular = certified({.size = 3, .prior = std::nullopt}, data, {12}).front();
    EXPECT_EQ(singular.status(), Status::singular);
    EXPECT_EQ(singular.rank(), 2);
    data.psi(2, 11) += 0x1p-30;
    EXPECT_EQ(certified({.size = 3, .prior = std::nullopt}, data, {12}).front().status(), Status::certified);
}

/// 2^-t <= 10^-digits for t = bits(digits), and hardly more, where digits log2(10) is just above a whole number:
/// denominators of its continued fraction.
template <class Bits>
bool suffice(Bits bits) {
    Reference const log2_10 = log(Reference(10)) / log(Reference(2));
    for (long const digits : {1L, 30L, 28L, 146L, 4004L, 12655L, 76573L, 1838395L, 13456039L, 44240665L, 579001193L}) {
        Reference const t = digits * log2_10, given = bits(digits);
        if (given < t || given > t * (1 + Reference(1e-9)) + 1) return false;
    }
    return true;
}
TEST(Certified, BitsForDigitsSuffice) {
    EXPECT_TRUE(suffice(&balls::bits_for));
    EXPECT_FALSE(suffice([](long digits) { return long(std::ceil(double(digits) * 3.3219280948873624)); }))
        << "log2(10) to nearest";
    EXPECT_FALSE(suffice([](long digits) { return balls::bits_for(digits) + 1; }));
}

// --- tails and quantiles against closed forms in 257 bits, and against another library -------------------------------

double nearest(Reference const& x) { return static_cast<double>(x); }

TEST(Distributions, AreTheirClosedFormsToTheLastBit) {
    Seed seed{8};
    Reference const pi = 4 * atan(Reference(1));
    for (int k = 0; k < 60; ++k) {
        double const x = 30 * seed.uniform(), n = 1 + double(seed.next() % 40), p = seed.uniform();
        EXPECT_EQ(correctly::chi_squared_tail(2, x), nearest(exp(-Reference(x) / 2)));
        EXPECT_EQ(correctly::chi_squared_tail(4, x), nearest(exp(-Reference(x) / 2) * (1 + Reference(x) / 2)));
        EXPECT_EQ(correctly::fisher_tail(2, n, x), nearest(pow(1 + 2 * Reference(x) / n, Reference(-n / 2))))
            << x << " " << n;
        EXPECT_EQ(correctly::student_quantile(1, p), nearest(tan(pi * (Reference(p) - Reference(0.5))))) << p;
        Reference const a = 2 * Reference(p) - 1;
        EXPECT_EQ(correctly::student_quantile(2, p), nearest(a / sqrt(2 * Reference(p) * (1 - Reference(p))))) << p;
    }
}
TEST(Distributions, AgreeWithBoost) {
    Seed seed{9};
    for (int k = 0; k < 40; ++k) {
        double const n = 1 + 400 * seed.uniform(), m = 1 + 30 * seed.uniform(), x = 3 * seed.uniform(),
                     p = 0.9 + 0.099 * seed.uniform();
        double const tail = cdf(complement(boost::math::chi_squared(n), n * x)),
                     f = cdf(complement(boost::math::fisher_f(m, n), x));
        EXPECT_NEAR(correctly::chi_squared_tail(n, n * x) / tail, 1, 1e-11) << n << " " << x;
        EXPECT_NEAR(correctly::fisher_tail(m, n, x) / f, 1, 1e-11) << m << " " << n << " " << x;
        EXPECT_NEAR(correctly::student_quantile(n, p) / quantile(boost::math::students_t(n), p), 1, 1e-11)
            << n << " " << p;
    }
}
TEST(Distributions, OfManyDegreesOfFreedom) {
    for (double const n : {1e4, 1e6, 123456.75}) {
        EXPECT_NEAR(correctly::student_quantile(n, 0.975) / quantile(boost::math::students_t(n), 0.975), 1, 1e-11) << n;
        EXPECT_NEAR(correctly::fisher_tail(2, n, 3.5) / cdf(complement(boost::math::fisher_f(2, n), 3.5)), 1, 1e-11)
            << n;
        EXPECT_NEAR(correctly::chi_squared_tail(n, n) / cdf(complement(boost::math::chi_squared(n), n)), 1, 1e-9) << n;
    }
    EXPECT_EQ(correctly::fisher_tail(2, 1e6, 1e9), 0) << "far below the least number";
}
TEST(Distributions, EndsAndMisuse) {
    double const inf = std::numeric_limits<double>::infinity(), none = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(correctly::chi_squared_tail(3, 0), 1);
    EXPECT_EQ(correctly::chi_squared_tail(3, inf), 0);
    EXPECT_EQ(correctly::fisher_tail(2, 3, -1), 1);
    EXPECT_EQ(correctly::fisher_tail(2, 3, inf), 0);
    EXPECT_EQ(correctly::student_quantile(5, 0.5), 0);
    EXPECT_EQ(correctly::student_quantile(5, 0.25), -correctly::student_quantile(5, 0.75));
    for (double const x :
         {correctly::chi_squared_tail(0, 1), correctly::chi_squared_tail(2, none), correctly::fisher_tail(none, 2, 1),
          correctly::fisher_tail(1, -2, 1), correctly::student_quantile(3, 1), correctly::student_quantile(3, 0),
          correctly::student_quantile(none, 0.9)})
        EXPECT_NE(x, x);
}

}  // namespace
}  // namespace rlslab
