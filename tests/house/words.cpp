// The words of docs/words.md: identifiers that are gone stay gone, and pages do not use the phrases that docs/words.md
// avoids.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

namespace rlslab {
namespace {

namespace fs = std::filesystem;
fs::path const root = RLSLAB_SOURCE_DIR;

/// Old -> new is in CHANGELOG.md and docs/history.md.
std::vector<std::string> gone(std::string const& code) {
    static std::regex const identifiers(
        "\\b(Present|Simd|in_bits|Brain|Tensor|Datum|absorb|TakesUnreported|TakesGainError|takes_gain_error|"
        "Undisturbed|Disturb|"
        "DividedBy|Downdated|Yardstick|Whiteness|lead_in|whiteness_lags|feed_rows|shrunk|"
        "Crew|Happened|happened_text|hold_down|forget_by|start_at|take_back|take_roots|Carried|Aside|started_over|"
        "start_over|take_root|TakeRoots|take_rows|take_manners|take_first|"
        "Finding|Manners|StoredProblem|AdviseOptions|Described)\\b(?!\\|)|"
        "\\b(settle|weigh|wanted|excess|feed)\\(|"
        "\\b([Ff]it|[Pp]arameter|[Cc]urve)(::|\\.)(low|high)\\b");
    std::vector<std::string> out;
    for (std::sregex_iterator it(code.begin(), code.end(), identifiers), end; it != end; ++it) out.push_back(it->str());
    return out;
}
/// Verbs of speech for data, relative clauses in place of nouns, private metaphors.
std::vector<std::string> avoided(std::string const& prose) {
    static std::regex const phrases(
        "\\b(what (it|they) (has|have|keeps?)|of (those|these|them) (where|that)|of those where there "
        "(is|are)|(is|are|was|were|be) (told|asked for)|(asks?|asked|tells?|told) of|(a|the|each) "
        "(filter|variant|form|matrix|row|number) (asks|tells|says|knows)|to be had|yardstick|nothing that we know "
        "of)\\b",
        std::regex::icase);
    std::vector<std::string> out;
    for (std::sregex_iterator it(prose.begin(), prose.end(), phrases), end; it != end; ++it) out.push_back(it->str());
    return out;
}

std::string text(fs::path const& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}
/// Files of the tree of one of the kinds, by their path from its folder; docs/history.md tells old names.
std::vector<std::string> files(std::vector<std::string> const& kinds) {
    std::vector<std::string> out;
    for (auto it = fs::recursive_directory_iterator(root); it != fs::recursive_directory_iterator(); ++it) {
        std::string const name = it->path().filename(), path = it->path().lexically_relative(root);
        if (name.starts_with(".") || path == "build" || path == "out" || path == "tests/fuzz")
            it.disable_recursion_pending();
        else if (std::ranges::count(kinds, it->path().extension().string()) && path != "docs/history.md")
            out.push_back(path);
    }
    return out;
}
TEST(Words, IdentifiersThatAreGoneStayGone) {
    std::vector<std::string> const code = files({".hpp", ".cpp"});
    ASSERT_GT(code.size(), 400u);
    for (std::string const& path : code)
        if (!path.ends_with("/words.cpp")) {
            EXPECT_THAT(gone(text(root / path)), testing::IsEmpty()) << path;
        }
    EXPECT_EQ(gone("struct Undisturbed {}; f.absorb(psi, y); // nothing to Undisturb"),
              (std::vector<std::string>{"Undisturbed", "absorb"}));
    EXPECT_EQ(gone("curve.low, range.low, fit.lower; // Fit::high"),
              (std::vector<std::string>{"curve.low", "Fit::high"}));
}
/// The comments of C++, one line each: "// a\n// b" reads "a b".
std::string comments(std::string const& code) {
    std::string out;
    std::istringstream lines(code);
    for (std::string line; std::getline(lines, line);) {
        static std::regex const comment("(^|\\s)///?<?\\s*(.*)");
        std::smatch m;
        if (std::regex_search(line, m, comment)) out += m[2].str() + " ";
        else out += "\n";
    }
    return out;
}
/// The literals of C++, one line each: "a" "b" reads "ab". Those are what the program prints; raw ones are skipped.
std::string literals(std::string const& code) {
    std::string out;
    for (size_t at = 0; at < code.size(); ++at) {
        if (code.compare(at, 2, "//") == 0) at = std::min(code.find('\n', at), code.size());
        else if (code.compare(at, 3, "'\"'") == 0) at += 2;
        else if (code.compare(at, 2, "R\"") == 0) {
            size_t const open = std::min(code.find('(', at), code.size());
            std::string const close = ")" + code.substr(at + 2, open - at - 2) + "\"";
            at = std::min(code.find(close, open), code.size()) + close.size() - 1;
        } else if (code[at] == '"') {
            for (++at; at < code.size() && code[at] != '"'; ++at) {
                if (code[at] == '\\') ++at;
                out += at < code.size() ? code[at] : ' ';
            }
            size_t const next = code.find_first_not_of(" \n", at + 1);
            if (next == code.npos || code[next] != '"') out += '\n';
        }
    }
    return out;
}
TEST(Words, PagesCommentsAndOutputDoNotUseThePhrasesThatTheyAvoid) {
    for (std::string const& path : files({".md"})) EXPECT_THAT(avoided(text(root / path)), testing::IsEmpty()) << path;
    for (std::string const& path : files({".hpp", ".cpp"}))
        if (!path.ends_with("/words.cpp")) {
            EXPECT_THAT(avoided(comments(text(root / path))), testing::IsEmpty()) << path;
            EXPECT_THAT(avoided(literals(text(root / path))), testing::IsEmpty()) << path;
        }
    EXPECT_EQ(literals("f(\"a\"\n  \"c\",  // \"b\"\n '\"', R\"x(\"d\")x\", \"e\\\"f\");"), "ac\ne\"f\n");
    EXPECT_EQ(comments("int a;  // one\n/// two\nint b;\n"), "one two \n");
    EXPECT_THAT(avoided("a variance that is not to be had; the filter tells of what it has"),
                testing::ElementsAre("to be had", "the filter tells", "what it has"));
}

}  // namespace
}  // namespace rlslab
