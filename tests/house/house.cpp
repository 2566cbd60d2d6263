// The house keeps its rules: one list of variants, files of the size their kind should have, folders in one order.
#include <rlslab/catalogue/catalogue.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

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

/// Files of C++ and what is in them, by their path from the project's folder.
using Tree = std::map<std::string, std::string>;

/// This tree. Links are not followed: what they lead to is there under its own name.
Tree const& project() {
    static Tree const tree = [] {
        Tree out;
        for (auto const& room : fs::directory_iterator(root)) {
            std::string const name = room.path().filename();
            if (!room.is_directory() || name.starts_with(".") || name == "build" || name == "out") continue;
            for (auto const& file : fs::recursive_directory_iterator(room))
                if (std::set<std::string>{".hpp", ".cpp", ".h"}.contains(file.path().extension()))
                    out[file.path().lexically_relative(root)] = text(file);
        }
        return out;
    }();
    return tree;
}

std::set<std::string> variant_files() {
    std::set<std::string> out;
    for (auto const& file : fs::directory_iterator(root / "variants"))
        if (file.path().extension() == ".hpp" && file.path().stem() != "variants") out.insert(file.path().stem());
    return out;
}

TEST(House, EveryVariantFileIsInTheListUnderItsName) {
    std::set<std::string> names;
    for (CatalogueEntry const& entry : catalogue()) names.emplace(entry.variant);
    EXPECT_THAT(names, testing::ContainerEq(variant_files()));
    for (std::string const& name : variant_files())
        EXPECT_NE(text(root / "variants/variants.hpp").find("<rlslab/variants/" + name + ".hpp>"), std::string::npos)
            << name;
}
TEST(House, EveryPairOccursOnceInTheCatalogue) {
    std::set<std::pair<std::string_view, std::string_view>> pairs;
    for (CatalogueEntry const& entry : catalogue())
        EXPECT_TRUE(pairs.emplace(entry.variant, entry.arithmetic->name).second);
    size_t dense = 0;
    for (auto const& [variant, arithmetic] : pairs) dense += !variant.ends_with("_sparse");
    EXPECT_EQ(dense, (variant_files().size() - 2) * arithmetics().size());  // the sparse two are binary64 only
}
TEST(House, AVariantIsAPageAndEndsWithItsClaim) {
    for (std::string const& name : variant_files()) {
        fs::path const file = root / "variants" / (name + ".hpp");
        // The sparse variants carry their library's calling conventions besides the algorithm; qr has two formulas.
        EXPECT_LE(lines(file), name.ends_with("_sparse") || name == "qr" ? 115 : 100) << file;
        EXPECT_GE(lines(file), 30) << file;
        std::string const code = text(file);
        EXPECT_NE(code.rfind("static_assert("), code.npos) << file << ": no claim";
        EXPECT_GT(code.rfind("static_assert("), code.rfind("};\n")) << file;
        EXPECT_NE(code.find("(1)"), std::string::npos) << file << ": no formula block";
        EXPECT_NE(code.find("Source"), std::string::npos) << file << ": no source";
    }
}
TEST(House, EveryFastFormIsAPageOfTheList) {
    std::string const list = text(root / "fast/fast.hpp");
    int pages = 0;
    for (auto const& file : fs::directory_iterator(root / "fast")) {
        std::string const name = file.path().stem(), code = text(file.path());
        if (file.path().extension() != ".hpp" || name == "fast" || name == "fast_form") continue;
        ++pages;
        EXPECT_NE(list.find("<rlslab/fast/" + name + ".hpp>"), list.npos) << name;
        EXPECT_NE(code.find("name = \"" + name + "\""), code.npos) << name;
        EXPECT_GT(code.rfind("static_assert("), code.rfind("};\n")) << name << ": no claim";
        EXPECT_NE(code.find("(1)"), code.npos) << name << ": no formula block";
        EXPECT_NE(code.find("Source"), code.npos) << name << ": no source";
        EXPECT_LE(lines(file.path()), 100) << name;
    }
    EXPECT_EQ(pages, 5);
}
TEST(House, NoFileIsLongerThanFourHundredAndFiftyLines) {
    for (auto const& [path, code] : project()) EXPECT_LE(std::ranges::count(code, '\n'), 450) << path;
}

struct Folder {
    std::string path;
    std::vector<std::string> stands_on;  ///< and on all that these stand on
};
/// THE order of the house: a folder includes what it stands on, and nothing else. Each names folders that come before
/// it.
std::vector<Folder> const house{
    {"src/rlslab/core", {}},
    {"src/rlslab/arithmetic", {"src/rlslab/core"}},
    {"src/rlslab/linalg/kernels", {"src/rlslab/arithmetic"}},
    {"src/rlslab/linalg", {"src/rlslab/linalg/kernels"}},
    {"src/rlslab/reference", {"src/rlslab/arithmetic"}},
    {"src/rlslab/input", {"src/rlslab/core"}},
    {"src/rlslab/input/formats", {"src/rlslab/input"}},
    {"src/rlslab/model", {"src/rlslab/linalg", "src/rlslab/reference", "src/rlslab/input"}},
    {"src/rlslab/state", {"src/rlslab/linalg"}},
    {"src/rlslab/adapt", {"src/rlslab/state"}},
    {"src/rlslab/many", {"src/rlslab/adapt"}},
    {"variants", {"src/rlslab/linalg"}},
    {"src/rlslab/gpu", {"src/rlslab/many", "variants"}},
    {"fast", {"src/rlslab/adapt"}},
    {"src/rlslab", {"src/rlslab/many", "variants"}},
    {"catalogue/native", {"src/rlslab/many", "variants"}},
    {"catalogue", {"catalogue/native", "src/rlslab/model"}},
    {"python", {"catalogue/native", "src/rlslab/reference", "src/rlslab/gpu"}},
    {"report", {"src/rlslab/core"}},
    {"compare", {"catalogue", "report", "fast"}},
    {"identify", {"catalogue", "report", "src/rlslab/input/formats"}},
    {"studies/engine", {"catalogue", "report"}},
    {"studies/gain", {"studies/engine"}},
    {"studies/definiteness", {"studies/engine"}},
    {"studies/accuracy", {"studies/engine", "compare"}},
    {"studies/forgetting", {"studies/engine"}},
    {"studies/adapt", {"studies/engine"}},
    {"studies/fast", {"studies/engine", "fast"}},
    {"studies/maps", {"studies/engine"}},
    {"studies/published", {"studies/engine", "compare"}},
    {"capi", {"catalogue/native"}},
    {"bench", {"catalogue", "report", "capi", "fast"}},
    {"program", {"compare", "identify", "studies/engine"}},
    {"site/live", {"catalogue"}},
    {"tests/compilers", {"variants"}},
    {"tests/portability", {"catalogue"}},
    {"tests/consumer", {"catalogue"}},
    {"tests/embedded", {"src/rlslab/many", "variants"}},
    {"examples/echo_canceller", {"src/rlslab/many", "variants"}},
    {"examples/battery_cell", {"src/rlslab/many", "variants"}},
    {"examples/guarded_oven", {"src/rlslab/many", "variants"}},
    {"examples/drift_and_silence", {"src/rlslab/many", "variants"}},
    {"examples/many_sensors", {"src/rlslab/many", "variants"}},
    {"examples/chosen_at_run_time", {"catalogue/native"}},
    {"examples/own_study", {"studies/engine"}},
    {"examples/own_bench", {}},
    {"examples/microcontroller", {"src/rlslab/many", "variants"}},
    {"examples/microcontroller/board", {}},
    {"tests/long_run", {"catalogue"}},
    {"tests/optimised", {"studies/engine"}},
    {"tests/fuzz", {"program"}},
    {"tests/mpi", {"src/rlslab/many", "variants"}},
    {"tests/common", {"catalogue"}},
    {"tests/core", {"tests/common"}},
    {"tests/arithmetic", {"tests/common", "tests/compilers"}},
    {"tests/linalg", {"tests/common"}},
    {"tests/reference", {"tests/common"}},
    {"tests/input", {"tests/common", "src/rlslab/input/formats"}},
    {"tests/model", {"tests/common"}},
    {"tests/state", {"tests/common"}},
    {"tests/adapt", {"tests/common", "tests/long_run"}},
    {"tests/many", {"tests/common"}},
    {"tests/gpu", {"tests/common", "src/rlslab/gpu"}},
    {"tests/fast", {"tests/common", "fast"}},
    {"tests/fast/peer", {"tests/fast", "bench"}},
    {"tests/variants", {"tests/common", "compare", "studies/engine", "studies/gain"}},
    {"tests/catalogue", {"tests/common"}},
    {"tests/report", {"tests/common", "report"}},
    {"tests/compare", {"tests/common", "compare"}},
    {"tests/identify", {"tests/common", "identify", "studies/engine"}},
    {"tests/studies", {"tests/common", "studies/definiteness", "studies/maps", "studies/published"}},
    {"tests/program", {"tests/common", "program"}},
    {"tests/bench", {"tests/common", "bench"}},
    {"tests/capi", {"tests/common", "capi"}},
    {"tests/house", {"tests/common"}},
    {"tests/live", {"tests/common", "site/live"}},
    {"tests/alone", {"tests/common", "capi", "fast"}},
};

/// What each folder stands on, itself included.
std::map<std::string, std::set<std::string>> foundations() {
    std::map<std::string, std::set<std::string>> out;
    for (Folder const& folder : house) {
        std::set<std::string> under{folder.path};
        for (std::string const& direct : folder.stands_on) under.insert(out.at(direct).begin(), out.at(direct).end());
        out[folder.path] = under;
    }
    return out;
}

std::string folder_of(std::string const& path) { return fs::path(path).parent_path(); }

/// The files of the tree that a text includes: <rlslab/...> is below src, where rlslab/variants, rlslab/fast,
/// rlslab/catalogue and rlslab/studies are links; what is in quotes starts at the project's folder.
std::vector<std::string> included(std::string const& code) {
    std::vector<std::string> out;
    std::istringstream lines(code);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string word, name;
        words >> word;
        if (word == "#") words >> word, word = "#" + word;
        if (word != "#include" || !(words >> name)) continue;
        bool const quoted = name.front() == '"';
        name = name.substr(1, name.find_first_of("\">", 1) - 1);
        if (quoted) out.push_back(name);
        else if (name.starts_with("rlslab/variants/") || name.starts_with("rlslab/fast/") ||
                 name.starts_with("rlslab/catalogue/"))
            out.push_back(name.substr(7));
        else if (name.starts_with("rlslab/studies/")) out.push_back("studies/engine/" + name.substr(15));
        else if (name.starts_with("rlslab/")) out.push_back("src/" + name);
    }
    return out;
}

/// One line for each include that leads nowhere, or to a folder on which its own does not stand, and for each folder
/// without a place in the order; and one for each folder that, by way of others, includes itself.
std::vector<std::string> faults(Tree const& tree) {
    std::vector<std::string> out;
    auto const under = foundations();
    std::map<std::string, std::set<std::string>> reached;  // folders, by the folder that includes of them
    for (auto const& [path, code] : tree) {
        std::string const from = folder_of(path);
        if (!under.contains(from)) out.push_back(path + ": its folder has no place in the house");
        for (std::string const& target : included(code)) {
            std::string const to = folder_of(target);
            if (!tree.contains(target)) {
                out.push_back(path + ": " + target + " is not in the tree");
                continue;
            }
            if (under.contains(from) && !under.at(from).contains(to))
                out.push_back(path + ": does not stand on " + target);
            if (from != to) reached[from].insert(to);
        }
    }
    for (size_t growing = 1, before = 0; growing != before;) {  // until ways of any length are in it
        before = growing;
        growing = 0;
        for (auto& [from, to] : reached) {
            for (std::string const& by : std::set(to))
                if (auto const further = reached.find(by); further != reached.end())
                    to.insert(further->second.begin(), further->second.end());
            growing += to.size();
        }
    }
    for (auto const& [from, to] : reached)
        if (to.contains(from)) out.push_back(from + ": in a circle");
    return out;
}

using testing::Contains;
using testing::IsEmpty;
using testing::Not;

TEST(House, NothingPointsUpAndNothingGoesRound) {
    EXPECT_GT(project().size(), 250u);
    EXPECT_THAT(faults(project()), IsEmpty());
}
TEST(House, AnArrowUpIsRefusedInEveryFolder) {
    auto const under = foundations();
    Tree tree = project();
    std::vector<std::string> expected;
    for (Folder const& above : house) {
        std::string const target = above.path + "/planted_target.hpp";
        tree[target] = "";
        for (Folder const& below : house) {
            if (under.at(below.path).contains(above.path)) continue;
            std::string const path = below.path + "/planted.hpp";
            tree[path] += above.path.starts_with("src/") ? "#include <" + target.substr(4) + ">\n"
                                                         : "#include \"" + target + "\"\n";
            expected.push_back(path + ": does not stand on " + target);
        }
    }
    EXPECT_GT(expected.size(), 400u);
    std::vector<std::string> const found = faults(tree);
    for (std::string const& line : expected) EXPECT_TRUE(std::ranges::count(found, line)) << line;
}
TEST(House, ACircleIsRefused) {
    Tree tree = project();
    tree["src/rlslab/core/planted.hpp"] =
        "// By way of two others.\n#pragma once\n\n#  include <rlslab/reference/certified.hpp>\n";
    EXPECT_THAT(faults(tree),
                testing::IsSupersetOf({"src/rlslab/core: in a circle", "src/rlslab/arithmetic: in a circle",
                                       "src/rlslab/reference: in a circle"}));
    EXPECT_THAT(faults({{"report/a.hpp", "#include \"bench/b.hpp\"\n"}, {"bench/b.hpp", ""}}),
                Not(Contains("bench: in a circle")));
}
/// The files that include themselves by way of others, and the files between two such circles: a file that includes
/// none of the rest, or that none of the rest includes, is in no circle.
std::set<std::string> files_in_circles(Tree const& tree) {
    std::map<std::string, std::set<std::string>> targets;
    for (auto const& [path, code] : tree)
        for (std::string const& target : included(code)) targets[path].insert(target);
    for (size_t before = 0; before != targets.size();) {
        before = targets.size();
        std::set<std::string> includers, included_ones;
        for (auto const& [path, of_path] : targets)
            for (std::string const& target : of_path)
                if (targets.contains(target)) includers.insert(path), included_ones.insert(target);
        std::erase_if(targets, [&](auto const& file) {
            return !includers.contains(file.first) || !included_ones.contains(file.first);
        });
    }
    std::set<std::string> out;
    for (auto const& [path, of_path] : targets) out.insert(path);
    return out;
}
TEST(House, NoFileIncludesItselfByWayOfOthers) {
    EXPECT_THAT(files_in_circles(project()), IsEmpty());
    Tree tree = project();
    tree["src/rlslab/core/planted.hpp"] = "#include <rlslab/core/problem.hpp>\n";
    EXPECT_THAT(files_in_circles(tree), IsEmpty());
    tree["src/rlslab/core/scalar.hpp"] += "#include <rlslab/core/planted.hpp>\n";
    EXPECT_THAT(files_in_circles(tree),
                testing::IsSupersetOf({"src/rlslab/core/planted.hpp", "src/rlslab/core/problem.hpp",
                                       "src/rlslab/core/stored.hpp", "src/rlslab/core/scalar.hpp"}));
    EXPECT_THAT(files_in_circles({{"report/a.hpp", "#include \"report/a.hpp\"\n"}}),
                testing::ElementsAre("report/a.hpp"));
}
/// What a file includes of the tree, and what that includes.
std::set<std::string> reached_from(Tree const& tree, std::string const& start) {
    std::set<std::string> out;
    std::vector<std::string> left{start};
    while (!left.empty()) {
        std::string const path = left.back();
        left.pop_back();
        if (!tree.contains(path) || !out.insert(path).second) continue;
        for (std::string const& target : included(tree.at(path))) left.push_back(target);
    }
    return out;
}
/// The files below catalogue/native from which one of these libraries is included.
std::set<std::string> native_files_that_need_a_library(Tree const& tree) {
    std::set<std::string> out;
    for (auto const& [path, code] : tree) {
        if (!path.starts_with("catalogue/native/")) continue;
        for (std::string const& file : reached_from(tree, path))
            for (char const* library : {"<boost/", "<fmt/", "<mpfr.h>", "<gmp.h>", "<flint/", "<arb.h>", "<zlib.h>"})
                if (tree.at(file).find(std::string("#include ") + library) != std::string::npos) out.insert(path);
    }
    return out;
}
TEST(House, TheNativeLayerNeedsEigenAlone) {
    EXPECT_THAT(native_files_that_need_a_library(project()), IsEmpty());
    Tree tree = project();
    tree["catalogue/native/planted.hpp"] = "#include <rlslab/arithmetic/quad.hpp>\n";
    EXPECT_THAT(native_files_that_need_a_library(tree), testing::ElementsAre("catalogue/native/planted.hpp"));
}
TEST(House, AnIncludeThatLeadsNowhereAndAFolderWithoutAPlaceAreRefused) {
    Tree tree = project();
    tree["variants/planted.hpp"] =
        "#include <rlslab/problem.hpp>\n#include \"page.hpp\"\n#include <vector>\n#include <rlslab/variants/ud.hpp>\n";
    tree["attic/planted.cpp"] = "";
    EXPECT_THAT(faults(tree),
                testing::UnorderedElementsAre("variants/planted.hpp: src/rlslab/problem.hpp is not in the tree",
                                              "variants/planted.hpp: page.hpp is not in the tree",
                                              "attic/planted.cpp: its folder has no place in the house"));
}
TEST(House, EveryFileSaysWhatItIs) {
    for (auto const& [path, code] : project()) EXPECT_EQ(code.substr(0, 3), "// ") << path;
}

}  // namespace
}  // namespace rlslab
