// The tables of README and docs/compare.md: costs there, and in the docstrings of variants, are those that the Counted
// scalar measures; what README has to use is what compare shows.
#include <rlslab/catalogue/catalogue.hpp>
#include "src/lab/compare/words.hpp"

#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/variants/information.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace rlslab {
namespace {

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
std::string text_of(char const* page) {
    std::ifstream file(RLSLAB_SOURCE_DIR + std::string(page));
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Readme, TheTablesOfVariantsAreMeasured) {
    std::string const readme = text_of("/README.md"), compare = text_of("/docs/compare.md");
    std::set<std::string_view> seen;
    for (CatalogueEntry const& entry : catalogue())
        if (seen.insert(entry.variant).second) {
            EXPECT_NE(readme.find("\n" + short_row(entry)), std::string::npos)
                << "expected in a table of README the row\n"
                << short_row(entry);
            EXPECT_NE(compare.find("\n" + long_row(entry)), std::string::npos)
                << "expected in docs/compare.md the row\n"
                << long_row(entry);
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
/// What a reader takes in at once.
TEST(Readme, IsOnePage) {
    std::string const readme = text_of("/README.md");
    EXPECT_LE(std::ranges::count(readme, '\n'), 120);
    EXPECT_LE(readme.size(), 12 * 1024u);
}

std::string docstring(std::string_view variant) {
    return std::regex_replace(text_of(("/variants/" + std::string(variant) + ".hpp").c_str()), std::regex("\n *///"),
                              "");
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
    std::set<std::string_view> seen;
    for (CatalogueEntry const& entry : catalogue()) {
        if (!seen.insert(entry.variant).second || !cost(entry.variant, 4)) continue;
        auto const said = claimed(entry.variant),
                   counted = measured([&](Index d) { return cost(entry.variant, d)->update.multiplications; });
        EXPECT_NEAR(said[0], counted[0], 0.01) << entry.variant << ": d^3";
        // O(d^2) beside a cubic term may stand for any square; a block's counts are whole numbers a row.
        double const allowed = said[0] >= 1 ? 1e9 : entry.block > 1 ? 0.05 : 0.005;
        EXPECT_NEAR(said[1], counted[1], allowed) << entry.variant << ": d^2";
    }
}
/// "2 d square roots"; a form that does not speak of roots has one at most.
TEST(Docstrings, StateTheSquareRootsThatAreCounted) {
    std::set<std::string_view> seen;
    for (CatalogueEntry const& entry : catalogue()) {
        if (!seen.insert(entry.variant).second || !cost(entry.variant, 10)) continue;
        std::string const text = docstring(entry.variant);
        std::smatch claim;
        bool const said = std::regex_search(text, claim, std::regex("([0-9]*) ?\\bd square roots"));
        long const counted = cost(entry.variant, 10)->update.square_roots,
                   factor = said && claim.length(1) ? std::stol(claim.str(1)) : 1;
        EXPECT_EQ(counted, said ? 10 * factor : std::min(counted, 1L)) << entry.variant;
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
