// What papers take from a run: text that LaTeX can set, and a paper that quotes claims which exist.
#include <rlslab/studies/latex.hpp>
#include "tests/common/program.hpp"

#include <regex>

namespace rlslab::studies {
namespace {

struct Quoted {
    std::string study, number, words;
};
std::vector<Quoted> quoted(std::string const& text) {
    static std::regex const found(R"(\\(?:found|measured|claimed|verdict)\{([a-z_]+)\}\{([0-9]+)\}\{([^}]+)\})");
    std::vector<Quoted> out;
    for (std::sregex_iterator at(text.begin(), text.end(), found), end; at != end; ++at)
        out.push_back({(*at)[1], (*at)[2], (*at)[3]});
    return out;
}
/// "" or what is wrong with the quotation.
std::string wrong_with(Quoted const& q) {
    for (Study const* study : studies())
        if (study->name == q.study) {
            size_t const n = std::stoul(q.number);
            if (n < 1 || n > study->claims.size()) return q.study + " has no claim " + q.number;
            std::string const& claim = study->claims[n - 1].text;
            return claim.starts_with(q.words) ? "" : q.study + ", claim " + q.number + " is: " + claim;
        }
    return "no study " + q.study;
}

TEST(Paper, QuotesClaimsThatExist) {
    auto const all = quoted(read(root + "/docs/paper/paper.tex"));
    EXPECT_GE(all.size(), 10u);
    for (Quoted const& q : all) EXPECT_EQ(wrong_with(q), "");
    EXPECT_NE(wrong_with({"gain_error", "2", "forms that propagate a factor"}), "");
    EXPECT_NE(wrong_with({"gain_error", "200", "forms"}), "");
    EXPECT_NE(wrong_with({"gain_err", "1", "forms"}), "");
}

TEST(Latex, EscapesWhatItWouldRead) {
    EXPECT_EQ(
        latex("a_b 5 % & {x} ^2 #1 $ ~ \\"),
        "a\\_\\allowbreak{}b 5 \\% \\& \\{x\\} \\textasciicircum{}2 \\#1 \\$ \\textasciitilde{} \\textbackslash{}");
    EXPECT_EQ(latex("λ ≤ 1 ± u²"), "$\\lambda$ $\\le$ 1 $\\pm$ u$^2$");
    EXPECT_EQ(latex(""), "");
}

TEST(Latex, KnowsEverySignOfTheClaims) {
    for (Study const* study : studies())
        for (Claim const& claim : study->claims)
            for (char const c : latex(claim.text + study->question)) {
                EXPECT_GE(static_cast<unsigned char>(c), ' ') << study->name << ": " << claim.text;
                EXPECT_LT(static_cast<unsigned char>(c), 0xc4)
                    << "beyond Latin letters: " << study->name << ": " << claim.text;
            }
}

TEST_F(Program, AStudyLeavesTablesAndNumbersForPapers) {
    ASSERT_EQ(shell("rlslab study gain_identities --out out").code, 0);
    std::string const table = read(folder / "out" / "tables" / "gain_identities.tex"),
                      numbers = read(folder / "out" / "numbers.tex");
    EXPECT_THAT(table, testing::HasSubstr("\\begin{longtable}"));
    EXPECT_THAT(table, testing::HasSubstr("& holds\\\\\n"));
    EXPECT_THAT(numbers, testing::HasSubstr("\\newcommand{\\runbudget}{quick}"));
    EXPECT_THAT(numbers, testing::HasSubstr("\\csname rls@gain_identities@1\\endcsname{"));
    EXPECT_THAT(numbers, testing::HasSubstr("\\csname rls@v@gain_identities@1\\endcsname{holds}"));
}

}  // namespace
}  // namespace rlslab::studies
