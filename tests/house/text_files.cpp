// Every text of the tree can be read in one window and fetches nothing: its lines are within the width, no address of a
// registry. No source takes a number of libm.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string_view>

namespace rlslab {
namespace {

namespace fs = std::filesystem;
fs::path const root = RLSLAB_SOURCE_DIR;
constexpr long width = 120;  // as in .clang-format and .editorconfig

/// What people write: not data, not what a fuzzer found.
bool written(fs::path const& path) {
    std::string const name = path.filename(), kind = path.extension();
    if (path.string().find("/corpus/") != std::string::npos) return false;
    static constexpr std::string_view kinds[] = {".hpp", ".cpp", ".h",  ".md",  ".cmake", ".css",
                                                 ".js",  ".py",  ".in", ".yml", ".sh",    ".tex"};
    return std::ranges::count(kinds, std::string_view(kind)) > 0 || name == "CMakeLists.txt" ||
           name == "CMakePresets.json" || name == "lab" || name == "run";
}
std::vector<fs::path> texts() {
    std::vector<fs::path> out;
    for (auto const& room : fs::directory_iterator(root)) {
        std::string const name = room.path().filename();
        if (name == "build" || name == "out" || name == ".git") continue;
        if (!room.is_directory()) {
            if (written(room)) out.push_back(room);
            continue;
        }
        for (auto const& file : fs::recursive_directory_iterator(room))
            if (!file.is_directory() && written(file)) out.push_back(file);
    }
    return out;
}
/// In characters: the bytes that begin one.
long columns(std::string const& line) {
    return std::ranges::count_if(line, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; });
}
/// A row of a Markdown table cannot be broken. `whole`: a listing between lines of ```, or a row of a formula, may be
/// wider.
bool too_wide(std::string const& line, bool markdown, bool whole = false) {
    return columns(line) > (whole ? 140 : width) && !(markdown && line.starts_with("|"));
}

TEST(TextFiles, NoLineIsBeyondTheWidth) {
    ASSERT_GT(texts().size(), 300u);
    for (fs::path const& path : texts()) {
        std::ifstream file(path);
        long number = 0;
        bool listing = false, formula = false;
        for (std::string line; std::getline(file, line);) {
            if (line.starts_with("```")) listing = !listing;
            formula = formula || line.find("R\"tex(") != line.npos;
            EXPECT_FALSE((++number, too_wide(line, path.extension() == ".md", listing || formula)))
                << path.lexically_relative(root) << ":" << number;
            if (line.find(")tex\"") != line.npos) formula = false;
        }
    }
    EXPECT_TRUE(too_wide(std::string(121, 'x'), true));
    EXPECT_FALSE(too_wide(std::string(140, 'x'), true, true));
    EXPECT_TRUE(too_wide(std::string(141, 'x'), true, true));
    EXPECT_FALSE(too_wide("|" + std::string(121, 'x'), true));
    EXPECT_TRUE(too_wide("|" + std::string(121, 'x'), false));
    EXPECT_FALSE(too_wide(
        [] {
            std::string kappas;
            for (int i = 0; i < 120; ++i) kappas += "\u03ba";
            return kappas;
        }(),
        false));
}

/// What a build could fetch from: an address in what is run. Packages come by name through their ordinary clients.
bool fetches(std::string const& line) {
    static std::regex const address(R"((https?|ftp|git|ssh)://|git@)");
    return std::regex_search(line, address);
}
TEST(TextFiles, NothingThatIsRunHoldsAnAddress) {
    for (fs::path const& path : texts()) {
        std::string const name = path.filename(), kind = path.extension();
        if (name != "lab" && name != "run" && name != "CMakeLists.txt" && kind != ".cmake" && kind != ".py" &&
            kind != ".in")
            continue;
        std::ifstream file(path);
        for (std::string line; std::getline(file, line);)
            EXPECT_FALSE(fetches(line)) << path.lexically_relative(root) << ": " << line;
    }
    EXPECT_TRUE(fetches("curl -O https://example.org/rlslab.tar.gz"));
    EXPECT_FALSE(fetches("apt-get install rlslab  # at any speed: 1 / 2"));
}

/// Lines that call libm for a number that may reach data or tables.
std::vector<std::string> calls(std::istream&& lines) {
    static std::regex const call(
        "(std|math)::(pow|exp|exp2|expm1|log|log2|log10|log1p|a?(sin|cos|tan)h?|atan2|cbrt|hypot|lgamma|tgamma|erfc?|"
        "polar|arg)\\(|"
        "boost/math/(distributions|special)");
    std::vector<std::string> out;
    for (std::string line; std::getline(lines, line);)
        if (std::regex_search(line, call)) out.push_back(line);
    return out;
}
TEST(TextFiles, NoSourceCallsLibm) {
    for (char const* part : {"src", "variants", "studies"})
        for (auto const& file : fs::recursive_directory_iterator(root / part))
            if (file.path().extension() == ".hpp" || file.path().extension() == ".cpp") {
                EXPECT_THAT(calls(std::ifstream(file.path())), testing::IsEmpty())
                    << file.path() << ": <rlslab/arithmetic/elementary.hpp> rounds correctly";
            }
    EXPECT_EQ(calls(std::istringstream(
                        "double y = std::log10(x);\nauto z = log(Reference(2)) + std::sqrt(2) + correctly::log(3);\n"))
                  .size(),
              1u);
}

}  // namespace
}  // namespace rlslab
