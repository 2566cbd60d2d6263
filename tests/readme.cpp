// The README's table of variants is what the Counted scalar measures and the catalogue says.
#include <rlslab/erased.hpp>

#include <gtest/gtest.h>

#include <fstream>
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

}  // namespace
}  // namespace rlslab
