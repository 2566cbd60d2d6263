// The libm that a processor selects has no effect: no byte of a table differs, and no source calls libm for a number.
#include "tests/common/program.hpp"

#include <regex>
#include <sstream>

namespace {

using testing::IsEmpty;

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

/// Lines that call libm for a number that may reach data or tables.
std::vector<std::string> calls(std::string const& text) {
    static std::regex const call(
        "(std|math)::(pow|exp|exp2|expm1|log|log2|log10|log1p|a?(sin|cos|tan)h?|atan2|cbrt|hypot|lgamma|tgamma|erfc?|"
        "polar|arg)\\(|"
        "boost/math/(distributions|special)");
    std::vector<std::string> out;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (std::regex_search(line, call)) out.push_back(line);
    return out;
}
TEST(House, NoSourceCallsLibm) {
    for (char const* part : {"src", "variants", "studies"})
        for (auto const& file : fs::recursive_directory_iterator(fs::path(RLSLAB_SOURCE_DIR) / part))
            if (file.path().extension() == ".hpp" || file.path().extension() == ".cpp") {
                EXPECT_THAT(calls(read(file.path())), IsEmpty())
                    << file.path() << ": <rlslab/arithmetic/elementary.hpp> rounds correctly";
            }
    EXPECT_EQ(
        calls("double y = std::log10(x);\nauto z = log(Reference(2)) + std::sqrt(2) + correctly::log(3);\n").size(),
        1u);
}

}  // namespace
