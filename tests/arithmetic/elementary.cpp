// Elementary functions: every result is the double nearest to the exact one, as 257 bits show it.
#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rlslab {
namespace {

using One = double(double);
using Wide = Reference(Reference const&);

/// How many of so many arguments in [from, to) give another double than the wide result rounded once.
template <class Ours, class Theirs>
int wrong(Ours ours, Theirs theirs, double from, double to) {
    Seed seed{3};
    int out = 0;
    for (int k = 0; k < 3000; ++k) {
        double const x = from + (to - from) * seed.uniform();
        out += ours(x) != static_cast<double>(theirs(Reference(x)));
    }
    return out;
}

TEST(Elementary, ResultsAreTheNearestDoubles) {
    auto const base_ten = [](auto const& x) { return pow(Reference(10), x); };
    EXPECT_EQ(wrong(
                  correctly::exp, [](Reference const& x) { return Reference(exp(x)); }, -745, 709),
              0);
    EXPECT_EQ(wrong(
                  correctly::exp, [](Reference const& x) { return Reference(exp(x)); }, -746, -708),
              0)
        << "subnormal";
    EXPECT_EQ(wrong(
                  correctly::exp2, [](Reference const& x) { return pow(Reference(2), x); }, -1075, 1024),
              0);
    EXPECT_EQ(wrong(
                  correctly::log, [](Reference const& x) { return Reference(log(x)); }, 0, 1e6),
              0);
    EXPECT_EQ(wrong(
                  correctly::log, [](Reference const& x) { return Reference(log(x)); }, 0.9, 1.1),
              0);
    EXPECT_EQ(wrong(
                  correctly::log2, [](Reference const& x) { return Reference(log(x) / log(Reference(2))); }, 0, 1e6),
              0);
    EXPECT_EQ(wrong(
                  correctly::log10, [](Reference const& x) { return Reference(log10(x)); }, 0, 1e6),
              0);
    EXPECT_EQ(wrong(
                  correctly::cos, [](Reference const& x) { return Reference(cos(x)); }, -1e4, 1e4),
              0);
    EXPECT_EQ(wrong(
                  correctly::sin, [](Reference const& x) { return Reference(sin(x)); }, -1e4, 1e4),
              0);
    EXPECT_EQ(wrong([](double x) { return correctly::pow(10, x); }, base_ten, -320, 308), 0);
    EXPECT_EQ(wrong([](double x) { return correctly::pow(x, 7.5); },
                    [](Reference const& x) { return pow(x, Reference(7.5)); }, 0, 1e3),
              0);
    EXPECT_EQ(wrong([](double x) { return correctly::hypot(x, 3); },
                    [](Reference const& x) { return Reference(sqrt(x * x + 9)); }, -20, 20),
              0);
    EXPECT_EQ(wrong([](double x) { return correctly::atan2(x, 3); },
                    [](Reference const& x) { return Reference(atan(x / 3)); }, -20, 20),
              0);
    EXPECT_GT(wrong([](double x) { return correctly::exp2(x * 3.3219280948873623); }, base_ten, -320, 308), 0);
}
TEST(Elementary, EndsAndSpecialValues) {
    double const inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(correctly::exp(-746), 0);
    EXPECT_EQ(correctly::exp(-745.1), 5e-324);
    EXPECT_EQ(correctly::exp(710), inf);
    EXPECT_EQ(correctly::log(0), -inf);
    EXPECT_TRUE(std::isnan(correctly::log(-1)) && std::isnan(correctly::log(nan)) &&
                std::isnan(correctly::pow(nan, 1)));
    EXPECT_EQ(correctly::atan2(0.0, -1), 3.141592653589793);
    EXPECT_EQ(correctly::atan2(-0.0, -1), -3.141592653589793);
    EXPECT_EQ(correctly::atan2(0, 0), 0);
    EXPECT_EQ(correctly::pow(nan, 0), 1);
    EXPECT_EQ(correctly::pow(10, -324), 0);
    EXPECT_EQ(correctly::pow(10, -323), 1e-323);
    EXPECT_EQ(correctly::pow(10, 309), inf);
    EXPECT_EQ(correctly::pow(10, 22), 1e22);
    EXPECT_EQ(correctly::pow(-2, 3), -8);
    EXPECT_EQ(correctly::log10(1e22), 22);
    EXPECT_EQ(correctly::log10(inf), inf);
    EXPECT_EQ(correctly::hypot(0x3p700, 0x4p700), 0x5p700);
    EXPECT_EQ(correctly::hypot(inf, nan), inf);
}

}  // namespace
}  // namespace rlslab
