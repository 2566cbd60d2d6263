// Studies are compiled at -O1. Rounding is defined, so that no byte of a table depends on that: two of them at -O3.
#include "tests/common/program.hpp"

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

}  // namespace
