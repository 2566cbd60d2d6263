// Rounding is defined: no byte of a study's table depends on the level at which it is compiled (-O1; here two at -O3),
// nor on the libm that a processor selects. FusedDouble: fused means fused, and every other product is rounded.
#include "studies/published/fused_double.hpp"
#include "tests/common/program.hpp"

#include <rlslab/core/random.hpp>

namespace {

class Optimisation : public Program {};

TEST_F(Optimisation, LeavesEachByteOfATable) {
    std::string const words = " study fused_symmetry sliding_window --budget quick --fresh --out ";
    EXPECT_EQ(shell("rlslab" + words + "plain").code, 0);
    EXPECT_NE(shell(std::string(RLSLAB_STUDIES_OPTIMISED) + words + "optimised").code, 2);
    for (std::string const study : {"fused_symmetry", "sliding_window"}) {
        std::string const table = read(folder / "plain" / (study + ".csv"));
        EXPECT_GT(table.size(), 1000u);
        EXPECT_EQ(without_run(table), without_run(read(folder / "optimised" / (study + ".csv")))) << study;
    }
}

std::string const plain = "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA ";

class Libm : public Program {};

/// Powers of ten by libm.
constexpr char powers[] = R"(awk 'BEGIN { for (k = 1; k < 30000; ++k) printf "%.17g\n", 10 ^ (-k / 1000) }')";

TEST_F(Libm, OfAnOlderProcessorLeavesTheSameTables) {
    if (shell(powers).out == shell(plain + powers).out) GTEST_SKIP() << "this system's libm is the same either way";
    for (std::string const study : {"residual_size", "sliding_window"}) {
        EXPECT_EQ(shell("rlslab study " + study + " --budget quick --fresh --out here").code, 0);
        EXPECT_EQ(shell(plain + "rlslab study " + study + " --budget quick --fresh --out there").code, 0);
        std::string const table = read(folder / "here" / (study + ".csv"));
        EXPECT_GT(table.size(), 1000u);
        EXPECT_EQ(table, read(folder / "there" / (study + ".csv"))) << study;
    }
}

TEST(Fused, AProductIsFusedIntoASumAndRoundedElsewhere) {
    using rlslab::Seed;
    using T = rlslab::studies::FusedDouble;
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
