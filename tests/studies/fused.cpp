// FusedDouble: fused means fused, and every other product is rounded.
#include "studies/published/fused_double.hpp"

#include <rlslab/core/random.hpp>

#include <gtest/gtest.h>

namespace rlslab::studies {
namespace {

TEST(Fused, AProductIsFusedIntoASumAndRoundedElsewhere) {
    using T = FusedDouble;
    Seed seed{3};
    int different = 0;
    for (int n = 0; n < 1000; ++n) {
        double const a = seed.bell(), b = seed.bell(), c = seed.bell(), d = seed.bell();
        T const A(a), B(b), C(c), D(d);
        EXPECT_EQ(double(T(C + A * B)), std::fma(a, b, c));
        EXPECT_EQ(double(T(A * B + C)), std::fma(a, b, c));
        EXPECT_EQ(double(T(C - A * B)), std::fma(-a, b, c));
        EXPECT_EQ(double(T(A * B - C)), std::fma(a, b, -c));
        EXPECT_EQ(double(T(A * B + C * D)), std::fma(c, d, a * b));
        EXPECT_EQ(double(T(A * B - C * D)), std::fma(-c, d, a * b));
        EXPECT_EQ(double(T(A * B)), a * b);
        EXPECT_EQ(double(T(A * B / C)), a * b / c);
        EXPECT_EQ(double(T((A * B) * C)), a * b * c);
        T sum = C;
        sum += A * B;
        sum -= C * D;
        EXPECT_EQ(double(sum), std::fma(-c, d, std::fma(a, b, c)));
        different += std::fma(a, b, c) != c + a * b;
    }
    EXPECT_GT(different, 100) << "or nothing was tested";
}

}  // namespace
}  // namespace rlslab::studies
