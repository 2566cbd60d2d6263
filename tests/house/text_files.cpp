// Every text of the tree can be read in one window and fetches nothing: its lines are within the width, no address of a
// registry. No source takes a number of libm. The tables of README and docs/compare.md: costs there, and in the
// docstrings of variants, are those that the Counted scalar measures; what README has to use is what compare shows.
#include <rlslab/catalogue/catalogue.hpp>
#include "src/lab/compare/words.hpp"
#include "tests/common/files.hpp"

#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/variants/information.hpp>

#include <algorithm>
#include <array>
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

// --- tables of variants ----------------------------------------------------------------------------------------------

std::string operations(CatalogueEntry const& entry, Index d) {
    auto const count = cost(entry.variant, d);
    return count ? std::to_string(count->total()) : "–";
}
/// The start of the row in README, with the operations at d = 10.
std::string short_row(CatalogueEntry const& entry) {
    std::ostringstream out;
    out << "| `" << entry.variant << "` | " << entry.propagates << " | " << operations(entry, 10) << " | "
        << (entry.starts_without_prior ? "yes" : "no") << " | ";
    return out.str();
}
/// The row in docs/compare.md.
std::string long_row(CatalogueEntry const& entry) {
    std::ostringstream out;
    out << "| `" << entry.variant << "` | " << entry.propagates << " | ";
    for (Index d : {4, 10, 32}) out << operations(entry, d) << " | ";
    out << (entry.starts_without_prior ? "yes" : "no") << " |\n";
    return out.str();
}
std::string text_of(std::string const& page) { return files::read(RLSLAB_SOURCE_DIR + page); }

TEST(Readme, TheTablesOfVariantsAreMeasured) {
    std::string const readme = text_of("/README.md"), compare = text_of("/docs/compare.md");
    for (CatalogueEntry const* const entry : one_entry_each()) {
        EXPECT_NE(readme.find("\n" + short_row(*entry)), std::string::npos) << "expected in a table of README the row\n"
                                                                            << short_row(*entry);
        EXPECT_NE(compare.find("\n" + long_row(*entry)), std::string::npos) << "expected in docs/compare.md the row\n"
                                                                            << long_row(*entry);
    }
}
/// The text of compare shows those that README has to use, and no others.
TEST(Readme, TheFirstTableIsWhatCompareShows) {
    std::string const readme = text_of("/README.md");
    size_t const ten = readme.find("\nTen to use"), rest = readme.find("\nThe rest, for studies");
    ASSERT_TRUE(ten < rest && rest != readme.npos);
    for (CatalogueEntry const* const entry : one_entry_each()) {
        size_t const row = readme.find("\n| `" + std::string(entry->variant) + "` |", ten);
        EXPECT_EQ(compare::is_shown({}, entry->variant), ten < row && row < rest) << entry->variant;
    }
}
/// The ledger of formulas names what tests each of them.
TEST(Theory, NamesTestsThatAre) {
    std::string tests;
    for (auto const& file : fs::recursive_directory_iterator(root / "tests"))
        if (file.path().extension() == ".cpp") tests += files::read(file.path());
    std::string const ledger = text_of("/docs/theory.md");
    std::regex const name("`([A-Z]\\w+)\\.([A-Z]\\w+)`");
    for (std::sregex_iterator it(ledger.begin(), ledger.end(), name), end; it != end; ++it)
        EXPECT_NE(tests.find('(' + it->str(1) + ", " + it->str(2)), tests.npos) << it->str();
}
/// What a reader takes in at once.
TEST(Readme, IsOnePage) {
    std::string const readme = text_of("/README.md");
    EXPECT_LE(std::ranges::count(readme, '\n'), 120);
    EXPECT_LE(readme.size(), 12 * 1024u);
}

std::string docstring(std::string_view variant) {
    return std::regex_replace(text_of("/variants/" + std::string(variant) + ".hpp"), std::regex("\n *///"), "");
}
/// "per update d^3/6 + 3.5 d^2 + O(d) multiplications" as {1/6, 3.5}; a row of a block counts as an update.
std::array<double, 2> claimed(std::string_view variant,
                              char const* where = "per (?:update|row) ([^:]*?) multiplications") {
    std::string const text = docstring(variant);
    std::smatch claim;
    std::array<double, 2> out{};
    if (!std::regex_search(text, claim, std::regex(where))) return out;
    std::regex const term("([0-9.]*) ?d\\^([23])(?:/([0-9]+))?");
    std::string const terms = std::regex_replace(claim.str(1), std::regex("O\\([^)]*\\)"), "");
    for (std::sregex_iterator it(terms.begin(), terms.end(), term), end; it != end; ++it) {
        double const factor = it->str(1).empty() ? 1 : std::stod(it->str(1)),
                     divisor = it->str(3).empty() ? 1 : std::stod(it->str(3));
        out[it->str(2) == "3" ? 0 : 1] = factor / divisor;
    }
    return out;
}

/// The coefficients of d^3 and d^2 from the counts at four sizes: differences of a polynomial.
std::array<double, 2> measured(auto multiplications) {
    constexpr double h = 16;
    double m[4];
    for (int k = 0; k < 4; ++k) m[k] = double(multiplications(Index(h) * (k + 1)));
    double const cubic = (m[3] - 3 * m[2] + 3 * m[1] - m[0]) / (6 * h * h * h);
    double const square = ((m[2] - 2 * m[1] + m[0]) - 6 * cubic * h * h * 2 * h) / (2 * h * h);
    return {cubic, square};
}

TEST(Docstrings, StateTheMultiplicationsThatAreCounted) {
    for (CatalogueEntry const* const entry : one_entry_each()) {
        if (!cost(entry->variant, 4)) continue;
        auto const said = claimed(entry->variant),
                   counted = measured([&](Index d) { return cost(entry->variant, d)->update.multiplications; });
        EXPECT_NEAR(said[0], counted[0], 0.01) << entry->variant << ": d^3";
        // O(d^2) beside a cubic term may stand for any square; a block's counts are whole numbers a row.
        double const allowed = said[0] >= 1 ? 1e9 : entry->block > 1 ? 0.05 : 0.005;
        EXPECT_NEAR(said[1], counted[1], allowed) << entry->variant << ": d^2";
    }
}
/// "2 d square roots"; a form that does not speak of roots has one at most.
TEST(Docstrings, StateTheSquareRootsThatAreCounted) {
    for (CatalogueEntry const* const entry : one_entry_each()) {
        if (!cost(entry->variant, 10)) continue;
        std::string const text = docstring(entry->variant);
        std::smatch claim;
        bool const said = std::regex_search(text, claim, std::regex("([0-9]*) ?\\bd square roots"));
        long const counted = cost(entry->variant, 10)->update.square_roots,
                   factor = said && claim.length(1) ? std::stol(claim.str(1)) : 1;
        EXPECT_EQ(counted, said ? 10 * factor : std::min(counted, 1L)) << entry->variant;
    }
}
/// The update after rows without report factors and solves twice.
TEST(Docstrings, StateWhatInformationOwesAfterRowsWithoutReport) {
    auto const owed = measured([](Index d) {
        using T = Counted<double>;
        Information<T> f(Problem<T>{.size = d});
        Vector<T> const psi = Vector<T>::Constant(d, T(1));
        auto const update = [&] { return counted([&] { f.update(psi, T(1)); }).multiplications; };
        long const usual = update();
        f.accumulate(psi, T(1));
        return update() - usual;
    });
    auto const said = claimed("information", "another ([^)]*)\\)");
    for (int power : {0, 1}) EXPECT_NEAR(said[size_t(power)], owed[size_t(power)], 0.01) << power;
}

}  // namespace
}  // namespace rlslab
