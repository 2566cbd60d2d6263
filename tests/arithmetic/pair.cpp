// Pairs of doubles against 257 bits: the errors that the page states, searched for; and what is no number.
#include <rlslab/arithmetic/pair.hpp>

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using R = Reference;
R exact(Pair const& x) { return R(x.high()) + R(x.low()); }

TEST(Pair, ErrsByNoMoreThanItSays) {
    Seed seed{1};
    auto const number = [&seed](double near, int bits) {  // near: half of them cancel
        double const high = seed.next() % 2 == 0 ? -near + near * std::ldexp(seed.bell(), -bits)
                                                 : std::ldexp(seed.bell(), int(seed.next() % 40) - 20);
        return Pair(high) + Pair(high * std::ldexp(seed.bell(), -53 - int(seed.next() % 4)));
    };
    double sum = 0, product = 0, quotient = 0, root = 0;
    auto const look = [](double& worst, Pair const& found, R const& wanted) {
        R const off = abs(R(exact(found) - wanted));
        worst = std::max(worst, wanted == 0 ? double(off != 0) : static_cast<double>(R(off / abs(wanted))));
    };
    for (int i = 0; i < 100000; ++i) {
        Pair const a = number(1, 0), b = number(double(a), int(seed.next() % 60));
        R const x = exact(a), y = exact(b);
        look(sum, a + b, R(x + y)), look(product, a * b, R(x * y)), look(root, sqrt(abs(a)), R(sqrt(R(abs(x)))));
        if (y != 0) look(quotient, a / b, R(x / y));
        EXPECT_EQ(a < b, x < y);
        EXPECT_EQ(a == b, x == y);
    }
    double const u2 = 0x1p-106;
    EXPECT_LE(sum, 3 * u2);
    EXPECT_LE(product, 5 * u2);
    EXPECT_LE(quotient, 15 * u2);
    EXPECT_LE(root, 4 * u2);
    EXPECT_GE(sum, 1.5 * u2) << "the search reaches half of it";
    EXPECT_GE(product, 2.5 * u2) << "the search reaches half of it";
}
TEST(Pair, KeepsWhatIsNoNumber) {
    Pair const infinite(std::numeric_limits<double>::infinity()), zero(0);
    for (Pair const& x : {infinite + Pair(1), infinite * Pair(2), Pair(1) / zero, sqrt(infinite), infinite - Pair(1),
                          Pair(1e308) * Pair(1e308)})
        EXPECT_TRUE(std::isinf(double(x)) || std::isnan(double(x)));
    EXPECT_TRUE(std::isnan(double(infinite - infinite)) && std::isnan(double(zero / zero)) &&
                std::isnan(double(sqrt(Pair(-1)))));
    EXPECT_EQ(double(Pair(1) / infinite), 0);
    EXPECT_TRUE(std::signbit(double(-zero)));
}

}  // namespace
}  // namespace rlslab
