// Tails and quantiles against closed forms in 257 bits, and against another library.
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/reference/distributions.hpp>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <gtest/gtest.h>

namespace rlslab {
namespace {

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
