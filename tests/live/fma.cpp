// The page's own fused multiply-add: std::fma's bits.
#include <rlslab/arithmetic/format.hpp>
#include <rlslab/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>

extern "C" {
double __real_fma(double x, double y, double z) { return std::fma(x, y, z); }  // what the linker puts there
double __wrap_fma(double x, double y, double z);
}

namespace rlslab::live {
namespace {

bool same(double x, double y, double z) {
    double const ours = __wrap_fma(x, y, z), theirs = std::fma(x, y, z);
    return detail::bits_of(ours) == detail::bits_of(theirs) || (ours != ours && theirs != theirs);
}
TEST(LiveFma, HasTheBitsOfTheTailsThatTheLibraryAsksFor) {
    Seed seed{1};
    for (int i = 0; i < 200'000; ++i) {
        double const x = std::ldexp(seed.bell(), int(seed.next() % 900) - 450),
                     y = std::ldexp(seed.bell(), int(seed.next() % 900) - 450), p = x * y;
        ASSERT_TRUE(same(x, y, -p)) << x << ' ' << y;
        ASSERT_TRUE(same(x, y, -p * (0.4 + 2 * seed.uniform()))) << x << ' ' << y;
        ASSERT_TRUE(same(x, y, std::nextafter(-p, 0))) << x << ' ' << y;
        double const root = std::sqrt(std::fabs(x));
        ASSERT_TRUE(same(-root, root, std::fabs(x))) << x;
    }
}
TEST(LiveFma, HasTheBitsOfEverythingElse) {
    double const numbers[] = {
        0.0,     -0.0,     1,        -1,      0x1p-1074, -0x1p-1022, 0x1p1023, 0x1.fffffffffffffp0,
        0x1p400, 0x1p-400, 0x1p-500, 0x1p511, INFINITY,  -INFINITY,  NAN,      3};
    for (double const x : numbers)
        for (double const y : numbers)
            for (double const z : numbers) EXPECT_TRUE(same(x, y, z)) << x << ' ' << y << ' ' << z;
}

}  // namespace
}  // namespace rlslab::live
