// What papers take from a run: text that LaTeX can set, and a paper that quotes claims which exist.
#include <rlslab/studies/verdicts.hpp>
#include "tests/common/program.hpp"

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

namespace rlslab::studies {
namespace {

struct Quoted {
    std::string study, number, words;
};
std::vector<Quoted> quoted(std::string const& text) {
    static std::regex const found(
        R"(\\(?:found|listed|measured|claimed|verdict|recorded)\{([a-z_]+)\}\{([0-9]+)\}\{([^}]+)\})");
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

/// What is wrong with the citations of a paper: each is a \\source, each \\source is cited, and begins one entry of the
/// list of sources in docs/literature.md.
std::vector<std::string> wrong_citations(std::string const& paper, std::string const& literature) {
    std::set<std::string> cited, given;
    static std::regex const cite(R"(\\cite\{([a-z0-9,]+)\})"), source(R"(\\source\{([a-z0-9]+)\}\{([^}]+)\})");
    for (std::sregex_iterator at(paper.begin(), paper.end(), cite), end; at != end; ++at) {
        std::istringstream keys((*at)[1]);
        for (std::string key; std::getline(keys, key, ',');) cited.insert(key);
    }
    std::string const entries = literature.substr(literature.find("<a id=\"6\">"));
    std::vector<std::string> out;
    for (std::sregex_iterator at(paper.begin(), paper.end(), source), end; at != end; ++at) {
        std::string const entry = "\n- " + (*at)[2].str(), key = (*at)[1];
        if (!given.insert(key).second) out.push_back(key + " twice");
        if (!cited.contains(key)) out.push_back(key + " is not cited");
        size_t const found = entries.find(entry);
        if (found == entries.npos || entries.find(entry, found + 1) != entries.npos)
            out.push_back(key + ": not one entry of docs/literature.md 6");
    }
    for (std::string const& key : cited)
        if (!given.contains(key)) out.push_back(key + " has no source");
    return out;
}

TEST(Paper, CitesWhatDocsLiteratureHas) {
    std::string const paper = read(root + "/docs/paper/paper.tex"), literature = read(root + "/docs/literature.md");
    EXPECT_THAT(wrong_citations(paper, literature), testing::IsEmpty());
    std::string const list = "<a id=\"6\">\n- Bierman, G. J. One. Read.\n- Bierman, G. J. Two. Cited, not read.\n";
    auto const wrong = [&](std::string const& text) { return wrong_citations(text, list); };
    EXPECT_THAT(wrong(R"(\cite{one} \source{one}{Bierman, G. J. One})"), testing::IsEmpty());
    EXPECT_THAT(wrong(R"(\cite{one,two} \source{one}{Bierman, G. J. One})"), testing::ElementsAre("two has no source"));
    EXPECT_THAT(wrong(R"(\source{one}{Bierman, G. J. One})"), testing::ElementsAre("one is not cited"));
    for (char const* const words : {"Bierman, G. J.", "Nobody"})
        EXPECT_THAT(wrong(std::string(R"(\cite{one} \source{one}{)") + words + "}"), testing::SizeIs(1)) << words;
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

TEST_F(Program, ListsEveryClaimWithItsBand) {
    std::vector<std::string> const lines = lines_of(shell("rlslab list claims").out);
    size_t n = 0;
    for (Study const* study : studies())
        for (size_t i = 0; i < study->claims.size(); ++i, ++n) {
            ASSERT_LT(n, lines.size());
            EXPECT_TRUE(lines[n].starts_with(study->name + '\t' + std::to_string(i + 1) + '\t')) << lines[n];
            EXPECT_THAT(lines[n], testing::HasSubstr('\t' + study->claims[i].text + '\t'));
            EXPECT_EQ(std::ranges::count(lines[n], '\t'), 6) << lines[n];
        }
    EXPECT_EQ(lines.size(), n);
}

TEST_F(Program, AStudyLeavesTablesAndNumbersForPapers) {
    ASSERT_EQ(shell("rlslab study slicot --out out").code, 0);
    std::string const table = read(folder / "out" / "tables" / "slicot.tex"),
                      numbers = read(folder / "out" / "numbers.tex");
    EXPECT_THAT(table, testing::HasSubstr("\\begin{longtable}"));
    EXPECT_THAT(table, testing::HasSubstr("& holds\\\\\n"));
    EXPECT_THAT(numbers, testing::HasSubstr("\\newcommand{\\runbudget}{quick}"));
    EXPECT_THAT(numbers, testing::HasSubstr("\\csname rls@slicot@1\\endcsname{"));
    EXPECT_THAT(numbers, testing::HasSubstr("\\csname rls@v@slicot@1\\endcsname{holds}"));
}

}  // namespace
}  // namespace rlslab::studies
