// Every citation in the tree resolves: pages by item or section, papers, links, paths, tests and studies by name. No
// formula was wrapped.
#include "tests/house/citations.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rlslab::citations {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

Tree const& tree() {
    static Tree const value = tree_of(RLSLAB_SOURCE_DIR);
    return value;
}

TEST(Citations, OfEveryFileResolve) {
    for (auto const& [path, text] : tree().texts) EXPECT_THAT(faults(tree(), path, text), IsEmpty()) << path;
}
TEST(Citations, AreLookedForInAllRoomsAndFound) {
    std::map<std::string, size_t> cited;
    for (auto const& [path, text] : tree().texts) {
        size_t& count = cited[path.substr(0, path.find('/'))];
        each(flattened(text), "docs/(?:theory|literature)\\.md [0-9]", [&](auto const&) { ++count; });
    }
    for (char const* room : {"src", "variants", "studies", "tests", "docs", "README.md", "CONTRIBUTING.md"})
        EXPECT_TRUE(std::ranges::any_of(tree().texts, [&](auto const& file) { return file.first.starts_with(room); }))
            << room;
    EXPECT_GE(cited["studies"], 60u);
    for (char const* room : {"src", "tests", "docs"}) EXPECT_GE(cited[room], 2u) << room;
    EXPECT_GE(tree().studies.size(), 28u);
    EXPECT_GE(tree().pages.at("docs/literature.md").sources.size(), 70u);
}

/// The fifteen questions stand on two pages, with one status each.
TEST(Citations, AnswersHaveOneStatus) {
    std::string const of = flattened(tree().texts.at("docs/questions.md")),
                      table = tree().texts.at("docs/literature.md");
    for (int k = 1; k <= 15; ++k) {
        std::smatch answer, row;
        ASSERT_TRUE(
            std::regex_search(of, answer, std::regex("\\*\\*" + std::to_string(k) + "\\. [^*]*\\*\\* (In part)?")));
        ASSERT_TRUE(std::regex_search(
            table, row, std::regex("\n\\| " + std::to_string(k) + " \\| [^|]* \\| (answered|in part): ")));
        EXPECT_EQ(row[1] == "in part", answer[1].matched) << k;
    }
}

/// What is planted has a ~ where the tree's own check would find it in this file.
std::string planted(char const* text) { return replaced(text, "~", ""); }
struct Planted {
    char const *path, *text, *fault;
};
class False : public testing::TestWithParam<Planted> {};
TEST_P(False, IsRefused) {
    auto const& [path, text, fault] = GetParam();
    EXPECT_THAT(faults(tree(), path, planted(text)), Contains(HasSubstr(fault))) << planted(text);
}
INSTANTIATE_TEST_SUITE_P(
    Citations, False,
    testing::Values(
        Planted{"src/a.hpp", "// docs/~theory.md 99", "no 99 in docs"},
        Planted{"src/a.hpp", "/// as docs/~theory.md\n    /// 99 has it", "no 99 in docs"},
        Planted{"src/a.hpp", "// docs/~theory.md 12 to 99, 4", "no 99 in docs"},
        Planted{"README.md", "docs/~theory.md 4, 6 and 98", "no 98 in docs"},
        Planted{"studies/a.cpp", ".source = \"docs/~literature.md \"\n          \"3.13\"", "no 3.13 in docs"},
        Planted{"studies/a.cpp", "docs/~literature.md 3.9 to 3.13", "no 3.13 in docs"},
        Planted{"README.md", "docs/~nist.md 2", "no 2 in docs"},
        Planted{"studies/a.cpp", "docs/~theory.md 28, law vi", "no row vi in docs"},
        Planted{"studies/a.cpp", "docs/~theory.md 12, law i", "no row i in docs"},
        Planted{"studies/a.cpp", "docs/~literature.md 2, F1 to F16", "no row F16 in docs"},
        Planted{"studies/a.cpp", "docs/~literature.md 5, question 16", "no row 16 in docs"},
        Planted{"src/a.hpp", "see docs/~lecture.md", "no page docs"},
        Planted{"studies/a.cpp", "derived (theo~ry 16)", "without its page"},
        Planted{"tests/a.cpp", "// lite~rature 3.5", "without its page"},
        Planted{"tests/a.cpp", "// (lite~rature, 3.5)", "without its page"},
        Planted{"studies/a.cpp", "lite~rature F7-F9", "without its page"},
        Planted{"studies/a.cpp", "lite~rature open question 8", "without its page"},
        Planted{"tests/a.cpp", "// the theo~ry\n// lines 12 to 19", "without its page"},
        Planted{"studies/a.cpp", "Verhaegen 1989 (reca~lled)", "no word of"},
        Planted{"src/a.hpp", "// see DESI~GN.md", "not in the tree"},
        Planted{"src/a.hpp", "// Source: Verhaegen 19~98.", "not in docs/literature.md 6"},
        Planted{"src/a.hpp", "// Golub & Kah~an 1965", "not in docs/literature.md 6"},
        Planted{"src/a.hpp", "// Bo~ehme 1992", "not in docs/literature.md 6"},
        Planted{"README.md", "[page](docs/none.svg)", "no file for"},
        Planted{"docs/speed.md", "[page](docs/theory.md)", "no file for"},
        Planted{"README.md", "[page](#nowhere)", "no anchor for"},
        Planted{"docs/speed.md", "[7](theory.md#97)", "no anchor for"},
        Planted{"docs/speed.md", "[docs/theory.md\n7](theory.md#8)", "says one number"},
        Planted{"README.md", "look at `src/nowhere.hpp`", "no file src/nowhere.hpp"},
        Planted{"README.md", "`<rlslab/nowhere.hpp>`", "no file rlslab"},
        Planted{"docs/speed.md", "Code: `nowhere.hpp`", "occurs 0 times"},
        Planted{"docs/speed.md", "`CMakeLists.cpp` and `citations.cpp`", "occurs 0 times"},
        Planted{"docs/speed.md", "Tests: `Citations.DoNotResolve`", "no test"},
        Planted{"docs/speed.md", "Tests: `Quotations.*`", "no test"},
        Planted{"docs/speed.md", "Studies: `nist`, `of_nothing`.", "no study of_nothing"},
        Planted{"studies/a.cpp", "(study of_nothing)", "no study of_nothing"},
        Planted{"studies/a.cpp", "exact (test Citations.DoNotResolve)", "no test"},
        Planted{"studies/a.cpp", ".formula = R~\"tex(a \\qquad \"\n        \"b)tex\",", "a quote mark in the formula"},
        Planted{"studies/a.cpp", ".formula = R~\"tex(a +\n    b)tex\",", "a line break in the formula"},
        Planted{"studies/a.cpp", ".formula = R~\"tex(a + b)\",", "a formula without an end"}));

TEST(Citations, OfEveryFormThatIsTrueAreTaken) {
    for (Planted const& right :
         {Planted{"src/a.hpp", "/// as docs/theory.md\n    /// 54 has it", ""},
          Planted{"studies/a.cpp", "docs/theory.md 12 to 23, 26; docs/literature.md 3.9 to 3.11", ""},
          Planted{"studies/a.cpp", "docs/literature.md 2, F1 to F6, F12, as far as they go", ""},
          Planted{"studies/a.cpp", "docs/theory.md 28, laws i and ii; docs/literature.md 5, question 8 (Norris)", ""},
          Planted{"src/a.hpp", "Golub 1965; Demmel et al. 2012; Yang & Böhme 1992; Läuchli 1961; made in November 2026",
                  ""},
          Planted{"docs/speed.md", "[docs/theory.md 7](theory.md#7), [3.1](literature.md#3.1), `[](double x)`", ""},
          Planted{"docs/speed.md", "[x](../README.md#choose-a-variant), [y](#missed-by-how-much-and-what-bounds-it)",
                  ""},
          Planted{"README.md",
                  "[a folder](variants), [page](docs/theory.md#corrections), <https://example.org>, `out/report.md`",
                  ""},
          Planted{"README.md", "`<rlslab/variants/ud.hpp>`. One file, `variants/averaged.hpp`. `citations.hpp`", ""},
          Planted{"docs/speed.md", "Tests: `Citations.OfEveryFileResolve`, `Citations.*`. Studies: `nist` (also `ud`).",
                  ""},
          Planted{"studies/a.cpp", ".formula = R~\"tex(a \\\\\n  b \\qquad\n  c)tex\", (study gain_error)", ""}})
        EXPECT_THAT(faults(tree(), right.path, planted(right.text)), IsEmpty()) << right.text;
}

}  // namespace
}  // namespace rlslab::citations
