// Elementary functions: every result is the double nearest to the exact one, as 257 bits show it.
#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rlslab {
namespace {

using R = Reference;
/// A function as it is computed, the same in 257 bits, and where it is asked.
struct Row {
    std::function<double(double)> ours;
    std::function<R(R const&)> theirs;
    double from, to;
};
/// How many of so many arguments in [from, to) give another double than the wide result rounded once.
int wrong(Row const& row) {
    Seed seed{3};
    int out = 0;
    for (int k = 0; k < 3000; ++k) {
        double const x = row.from + (row.to - row.from) * seed.uniform();
        out += row.ours(x) != static_cast<double>(row.theirs(R(x)));
    }
    return out;
}

TEST(Elementary, ResultsAreTheNearestDoubles) {
    Row const rows[] = {
        {correctly::exp, [](R const& x) -> R { return exp(x); }, -745, 709},
        {correctly::exp, [](R const& x) -> R { return exp(x); }, -746, -708},  // subnormal
        {correctly::exp2, [](R const& x) -> R { return pow(R(2), x); }, -1075, 1024},
        {correctly::log, [](R const& x) -> R { return log(x); }, 0, 1e6},
        {correctly::log, [](R const& x) -> R { return log(x); }, 0.9, 1.1},
        {correctly::log2, [](R const& x) -> R { return log(x) / log(R(2)); }, 0, 1e6},
        {correctly::log10, [](R const& x) -> R { return log10(x); }, 0, 1e6},
        {correctly::cos, [](R const& x) -> R { return cos(x); }, -1e4, 1e4},
        {correctly::sin, [](R const& x) -> R { return sin(x); }, -1e4, 1e4},
        {[](double x) { return correctly::pow(10, x); }, [](R const& x) -> R { return pow(R(10), x); }, -320, 308},
        {[](double x) { return correctly::pow(x, 7.5); }, [](R const& x) -> R { return pow(x, R(7.5)); }, 0, 1e3},
        {[](double x) { return correctly::hypot(x, 3); }, [](R const& x) -> R { return sqrt(x * x + 9); }, -20, 20},
        {[](double x) { return correctly::atan2(x, 3); }, [](R const& x) -> R { return atan(x / 3); }, -20, 20}};
    for (Row const& row : rows) EXPECT_EQ(wrong(row), 0) << &row - rows;
    EXPECT_GT(wrong({[](double x) { return correctly::exp2(x * 3.3219280948873623); },
                     [](R const& x) -> R { return pow(R(10), x); }, -320, 308}),
              0);
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
