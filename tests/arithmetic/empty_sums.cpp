// A sum of no terms is zero in every arithmetic, whatever was in memory before.
#include <rlslab/arithmetic/arithmetics.hpp>
#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/model/order_recursive_qr.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

/// Leaves 4 KB of ones where the next call has its variables.
[[gnu::noinline]] void litter() {
    unsigned char volatile bytes[4096];
    for (auto& b : bytes) b = 0x3f;
}

template <class T>
[[gnu::noinline]] T dot_of_nothing(Index n) {
    T const x[1] = {T(3)};
    return dot(x, x, n);
}

template <class T>
struct EmptySum : testing::Test {};
using Scalars = testing::Types<BFloat16, BFloat16Stochastic, VariablePrecision, float, double, long double, Quad,
                               Reference, Rational, Counted<double>>;
TYPED_TEST_SUITE(EmptySum, Scalars);
TYPED_TEST(EmptySum, IsZero) {
    litter();
    EXPECT_TRUE(dot_of_nothing<TypeParam>(0) == TypeParam(0));
}
TEST(EmptySumOfPacks, IsZeroInEveryLane) {
    litter();
    EXPECT_TRUE(all(dot_of_nothing<Pack<double, 8>>(0) == Pack<double, 8>(0.0)));
}

template <class T>
[[gnu::noinline]] T J_of_as_many_columns_as_rows() {
    OrderRecursiveQr<T> f((Vector<T>(2) << T(5), T(7)).finished(), 2);
    f.append((Vector<T>(2) << T(1), T(2)).finished());
    f.append((Vector<T>(2) << T(3), T(-1)).finished());
    litter();
    return f.J();
}
TEST(OrderRecursiveQr, NothingIsLeftByAsManyColumnsAsRows) {
    EXPECT_EQ(J_of_as_many_columns_as_rows<double>(), 0);
    EXPECT_EQ(J_of_as_many_columns_as_rows<float>(), 0);
    EXPECT_EQ(J_of_as_many_columns_as_rows<Quad>(), 0);
}
TEST(OrderRecursive, OfNoRows) {
    OrderRecursive<double> const f(Vector<double>(0), 1);
    EXPECT_EQ(f.J(), 0);
}

}  // namespace
}  // namespace rlslab
