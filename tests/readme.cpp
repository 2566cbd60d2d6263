// The costs in the README's table and in the variants' docstrings are those that the Counted scalar measures.
#include "catalogue/catalogue.hpp"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace rlslab {
namespace {

std::string row(Entry const& entry) {
    std::ostringstream out;
    out << "| `" << entry.variant << "` | " << entry.propagates << " | ";
    for (Index d : {4, 10, 32}) {
        auto const count = cost(entry.variant, d);
        out << (count ? std::to_string(count->total()) : "–") << " | ";
    }
    out << (entry.starts_without_prior ? "yes" : "no") << " |";
    return out.str();
}

TEST(Readme, TheTableOfVariantsIsMeasured) {
    std::ifstream file(RLSLAB_SOURCE_DIR "/README.md");
    std::string const text{std::istreambuf_iterator<char>(file), {}};
    std::set<std::string_view> seen;
    for (Entry const& entry : catalogue())
        if (seen.insert(entry.variant).second) {
            EXPECT_NE(text.find("\n" + row(entry) + "\n"), std::string::npos) << "expected the row\n" << row(entry);
        }
}

/// "per update d^3/6 + 3.5 d^2 + O(d) multiplications" as {1/6, 3.5}; a row of a block counts as an update.
std::array<double, 2> claimed(std::string_view variant) {
    std::ifstream file(RLSLAB_SOURCE_DIR "/variants/" + std::string(variant) + ".hpp");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    text = std::regex_replace(text, std::regex("\n *///"), "");
    std::smatch claim;
    std::array<double, 2> out{};
    if (!std::regex_search(text, claim, std::regex("per (?:update|row) ([^:]*?) multiplications"))) return out;
    std::regex const term("([0-9.]*) ?d\\^([23])(?:/([0-9]+))?");
    std::string const terms = std::regex_replace(claim.str(1), std::regex("O\\([^)]*\\)"), "");
    for (std::sregex_iterator it(terms.begin(), terms.end(), term), end; it != end; ++it) {
        double const factor = it->str(1).empty() ? 1 : std::stod(it->str(1)), divisor = it->str(3).empty() ? 1 : std::stod(it->str(3));
        out[it->str(2) == "3" ? 0 : 1] = factor / divisor;
    }
    return out;
}

/// The coefficients of d^3 and d^2 from the counts at four sizes: differences of a polynomial.
std::array<double, 2> measured(std::string_view variant) {
    constexpr double h = 16;
    double m[4];
    for (int k = 0; k < 4; ++k) m[k] = double(cost(variant, Index(h) * (k + 1))->update.multiplications);
    double const cubic = (m[3] - 3 * m[2] + 3 * m[1] - m[0]) / (6 * h * h * h);
    double const square = ((m[2] - 2 * m[1] + m[0]) - 6 * cubic * h * h * 2 * h) / (2 * h * h);
    return {cubic, square};
}

TEST(Docstrings, StateTheMultiplicationsThatAreCounted) {
    std::set<std::string_view> seen;
    for (Entry const& entry : catalogue()) {
        if (!seen.insert(entry.variant).second || !cost(entry.variant, 4)) continue;
        auto const said = claimed(entry.variant), counted = measured(entry.variant);
        EXPECT_NEAR(said[0], counted[0], 0.01) << entry.variant << ": d^3";
        // O(d^2) beside a cubic term may stand for any square; a block's counts are whole numbers a row.
        double const allowed = said[0] >= 1 ? 1e9 : entry.block > 1 ? 0.05 : 0.005;
        EXPECT_NEAR(said[1], counted[1], allowed) << entry.variant << ": d^2";
    }
}

}  // namespace
}  // namespace rlslab
