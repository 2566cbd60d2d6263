// The house keeps its rules: one list of variants, files of the size their kind should have.
#include "catalogue/catalogue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

namespace rlslab {
namespace {

namespace fs = std::filesystem;
fs::path const root = RLSLAB_SOURCE_DIR;

long lines(fs::path const& path) {
    std::ifstream file(path);
    return std::count(std::istreambuf_iterator<char>(file), {}, '\n');
}
std::string text(fs::path const& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<fs::path> sources(char const* folder) {
    std::vector<fs::path> out;
    for (auto const& file : fs::recursive_directory_iterator(root / folder))
        if (file.path().extension() == ".hpp" || file.path().extension() == ".cpp") out.push_back(file.path());
    return out;
}

/// Headers in variants/ that hold the list or the boundary, not a variant; and the recursions in order, which take columns.
std::set<std::string> const not_a_variant{"variants", "instances", "erase", "order_recursive", "order_recursive_qr"};

std::set<std::string> variant_files() {
    std::set<std::string> out;
    for (auto const& file : fs::directory_iterator(root / "variants"))
        if (file.path().extension() == ".hpp" && !not_a_variant.contains(file.path().stem())) out.insert(file.path().stem());
    return out;
}

TEST(House, EveryVariantFileIsInTheListUnderItsName) {
    std::set<std::string> names;
    for (Entry const& entry : catalogue()) names.emplace(entry.variant);
    EXPECT_THAT(names, testing::ContainerEq(variant_files()));
    for (std::string const& name : variant_files())
        EXPECT_NE(text(root / "variants/variants.hpp").find("<rlslab/variants/" + name + ".hpp>"), std::string::npos) << name;
}
TEST(House, EveryPairOccursOnceInTheCatalogue) {
    std::set<std::pair<std::string_view, std::string_view>> pairs;
    for (Entry const& entry : catalogue()) EXPECT_TRUE(pairs.emplace(entry.variant, entry.arithmetic->name).second);
    size_t dense = 0;
    for (auto const& [variant, arithmetic] : pairs) dense += !variant.ends_with("_sparse");
    EXPECT_EQ(dense, (variant_files().size() - 2) * arithmetics().size());    // the sparse two are binary64 only
}
TEST(House, AVariantIsAPageAndEndsWithItsClaim) {
    for (std::string const& name : variant_files()) {
        fs::path const file = root / "variants" / (name + ".hpp");
        // The sparse variants carry their library's calling conventions besides the algorithm.
        EXPECT_LE(lines(file), name.ends_with("_sparse") ? 115 : 90) << file;
        EXPECT_GE(lines(file), 30) << file;
        std::string const code = text(file);
        EXPECT_NE(code.rfind("static_assert("), code.npos) << file << ": no claim";
        EXPECT_GT(code.rfind("static_assert("), code.rfind("};\n")) << file;
        EXPECT_NE(code.find("(1)"), std::string::npos) << file << ": no formula block";
        EXPECT_NE(code.find("Source"), std::string::npos) << file << ": no source";
    }
}
TEST(House, NoFileIsLongerThanFourHundredLines) {
    for (char const* folder : {"src", "variants", "tests", "bench", "studies", "compare", "program", "report"})
        for (fs::path const& file : sources(folder)) EXPECT_LE(lines(file), 400) << file;
}
TEST(House, TheRendererStandsOnTheCoreAlone) {
    for (fs::path const& file : sources("report")) {
        std::ifstream lines(file);
        for (std::string line; std::getline(lines, line);) {
            if (line.starts_with("#include \"")) { EXPECT_TRUE(line.starts_with("#include \"report/") || line.find("page_assets.hpp") != line.npos) << file << ": " << line; }
            if (line.starts_with("#include <rlslab/")) { EXPECT_TRUE(line.starts_with("#include <rlslab/core/")) << file << ": " << line; }
        }
    }
}
TEST(House, EveryFileSaysWhatItIs) {
    for (char const* folder : {"src", "variants", "tests", "bench", "studies", "compare", "program", "report"})
        for (fs::path const& file : sources(folder)) EXPECT_EQ(text(file).substr(0, 3), "// ") << file;
}

}  // namespace
}  // namespace rlslab
