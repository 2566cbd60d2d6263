// The house keeps its rules: one list of variants, files of the size their kind should have, folders in one order.
#include <rlslab/catalogue/catalogue.hpp>
#include "tests/common/files.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

namespace rlslab {
namespace {

namespace fs = std::filesystem;
fs::path const root = RLSLAB_SOURCE_DIR;

std::string text(fs::path const& path) { return files::read(path); }
long lines(fs::path const& path) { return std::ranges::count(text(path), '\n'); }

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
    std::string const list = text(root / "variants/fast/fast.hpp");
    int pages = 0;
    for (auto const& file : fs::directory_iterator(root / "variants/fast")) {
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

/// THE order of the house: what is right of an arrow includes what is left of it, and all that this stands on. A file
/// belongs to the longest of these names with which its path begins.
constexpr std::string_view order[] = {
    "src/rlslab/core <- src/rlslab/arithmetic <- src/rlslab/linalg <- src/rlslab/state <- src/rlslab/adapt",
    "src/rlslab/core <- src/rlslab/input, src/rlslab/arithmetic <- src/rlslab/reference",
    "src/rlslab/linalg src/rlslab/reference src/rlslab/input <- src/rlslab/model, src/rlslab/adapt <- src/rlslab/many",
    "src/rlslab/linalg <- variants, src/rlslab/adapt <- variants/fast, src/rlslab/many variants <- src/rlslab",
    "src/rlslab/many variants <- src/rlslab/gpu src/catalogue/native, src/rlslab/core <- src/lab/report",
    "src/catalogue/native src/rlslab/model <- src/catalogue",
    "src/catalogue src/lab/report variants/fast <- src/lab/compare src/lab/identify src/lab/export <- src/lab/engine",
    "src/lab/engine <- src/lab/program studies docs/examples, src/catalogue <- docs/site",
    "src/catalogue src/rlslab/gpu <- bindings, src/catalogue src/lab/report variants/fast bindings <- bench",
    "studies bench docs/site src/lab/program <- tests",
};

/// What each room stands on, itself included.
std::map<std::string, std::set<std::string>> foundations() {
    std::map<std::string, std::set<std::string>> out;
    for (std::string_view const row : order) {
        std::set<std::string> left, right;
        std::istringstream words{std::string(row)};
        for (std::string word; words >> word;) {
            bool const ends = word.ends_with(",");
            if (ends) word.pop_back();
            if (word == "<-") left = std::exchange(right, {});
            else {
                right.insert(word);
                out[word].insert(word);
                for (std::string const& under : left) out[word].insert(out.at(under).begin(), out.at(under).end());
            }
            if (ends) left = right = {};
        }
    }
    return out;
}
/// The room of a path; "" where there is none.
std::string room_of(std::string const& path) {
    static auto const rooms = foundations();
    std::string out;
    for (auto const& [room, under] : rooms)
        if (path.starts_with(room + "/") && room.size() > out.size()) out = room;
    return out;
}

std::string folder_of(std::string const& path) { return fs::path(path).parent_path(); }

/// Links of the tree, and where they lead.
std::pair<std::string, std::string> const links[] = {{"src/rlslab/variants/", "variants/"},
                                                     {"src/rlslab/fast/", "variants/fast/"},
                                                     {"src/rlslab/catalogue/", "src/catalogue/"},
                                                     {"src/rlslab/studies/", "src/lab/engine/"}};
/// The files of the tree that a text includes: <rlslab/...> is below src; what is in quotes starts at the project's
/// folder.
std::vector<std::string> included(std::string const& code) {
    std::vector<std::string> out;
    for (std::string const& line : files::lines_of(code)) {
        std::istringstream words(line);
        std::string word, name;
        words >> word;
        if (word == "#") words >> word, word = "#" + word;
        if (word != "#include" || !(words >> name)) continue;
        bool const quoted = name.front() == '"';
        name = name.substr(1, name.find_first_of("\">", 1) - 1);
        if (quoted) out.push_back(name);
        else if (name.starts_with("rlslab/")) {
            name = "src/" + name;
            for (auto const& [link, folder] : links)
                if (name.starts_with(link)) name = folder + name.substr(link.size());
            out.push_back(name);
        }
    }
    return out;
}

/// One line for each include that leads nowhere, or to a room on which its own does not stand, and for each file
/// without a room; and one for each folder that, by way of others, includes itself.
std::vector<std::string> faults(Tree const& tree) {
    std::vector<std::string> out;
    auto const under = foundations();
    std::map<std::string, std::set<std::string>> reached;  // folders, by the folder that includes of them
    for (auto const& [path, code] : tree) {
        std::string const room = room_of(path), from = folder_of(path);
        if (room.empty()) out.push_back(path + ": has no room in the house");
        for (std::string const& target : included(code)) {
            if (!tree.contains(target)) {
                out.push_back(path + ": " + target + " is not in the tree");
                continue;
            }
            if (!room.empty() && !under.at(room).contains(room_of(target)))
                out.push_back(path + ": does not stand on " + target);
            if (std::string const to = folder_of(target); from != to) reached[from].insert(to);
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
TEST(House, AnArrowUpIsRefusedInEveryRoom) {
    auto const under = foundations();
    Tree tree = project();
    std::vector<std::string> expected;
    for (auto const& [above, of_above] : under) {
        std::string const target = above + "/planted_target.hpp";
        tree[target] = "";
        for (auto const& [below, of_below] : under) {
            if (of_below.contains(above)) continue;
            std::string const path = below + "/planted.hpp";
            tree[path] += above.starts_with("src/rlslab") ? "#include <" + target.substr(4) + ">\n"
                                                          : "#include \"" + target + "\"\n";
            expected.push_back(path + ": does not stand on " + target);
        }
    }
    EXPECT_GT(expected.size(), 250u);
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
    EXPECT_THAT(faults({{"src/lab/report/a.hpp", "#include \"bench/b.hpp\"\n"}, {"bench/b.hpp", ""}}),
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
    EXPECT_THAT(files_in_circles({{"src/lab/report/a.hpp", "#include \"src/lab/report/a.hpp\"\n"}}),
                testing::ElementsAre("src/lab/report/a.hpp"));
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
/// The files below src/catalogue/native from which one of these libraries is included.
std::set<std::string> native_files_that_need_a_library(Tree const& tree) {
    std::set<std::string> out;
    for (auto const& [path, code] : tree) {
        if (!path.starts_with("src/catalogue/native/")) continue;
        for (std::string const& file : reached_from(tree, path))
            for (char const* library : {"<boost/", "<fmt/", "<mpfr.h>", "<gmp.h>", "<flint/", "<arb.h>", "<zlib.h>"})
                if (tree.at(file).find(std::string("#include ") + library) != std::string::npos) out.insert(path);
    }
    return out;
}
TEST(House, TheNativeLayerNeedsEigenAlone) {
    EXPECT_THAT(native_files_that_need_a_library(project()), IsEmpty());
    Tree tree = project();
    tree["src/catalogue/native/planted.hpp"] = "#include <rlslab/arithmetic/quad.hpp>\n";
    EXPECT_THAT(native_files_that_need_a_library(tree), testing::ElementsAre("src/catalogue/native/planted.hpp"));
}
TEST(House, AnIncludeThatLeadsNowhereAndAFileWithoutARoomAreRefused) {
    Tree tree = project();
    tree["variants/planted.hpp"] =
        "#include <rlslab/problem.hpp>\n#include \"page.hpp\"\n#include <vector>\n#include <rlslab/variants/ud.hpp>\n";
    tree["attic/planted.cpp"] = "";
    EXPECT_THAT(faults(tree),
                testing::UnorderedElementsAre("variants/planted.hpp: src/rlslab/problem.hpp is not in the tree",
                                              "variants/planted.hpp: page.hpp is not in the tree",
                                              "attic/planted.cpp: has no room in the house"));
}
TEST(House, EveryFileSaysWhatItIs) {
    for (auto const& [path, code] : project()) EXPECT_EQ(code.substr(0, 3), "// ") << path;
}

// The tree does not grow unseen: no room has more lines, and the tree not more compilations, than rooms.txt says. Who
// needs more raises the number in the same commit, and says there what became shorter.

fs::path const list = root / "tests/house/rooms.txt";

/// The rooms: folders of the tree's top, src and bindings by what is in them.
std::vector<std::string> const rooms{"src/rlslab", "src/catalogue", "src/lab",         "variants", "studies",
                                     "bench",      "bindings/c",    "bindings/python", "docs",     "tests"};

/// Lines of C++ by room, and how many files are compiled.
std::map<std::string, long> counted() {
    std::map<std::string, long> out;
    for (std::string const& room : rooms)
        for (fs::recursive_directory_iterator at(root / room), end; at != end; ++at) {
            if (fs::exists(at->path() / "CMakeCache.txt")) at.disable_recursion_pending();  // built there
            std::string const kind = at->path().extension();
            if (!std::set<std::string>{".cpp", ".hpp", ".h", ".inc", ".cu"}.contains(kind)) continue;
            out[room] += lines(at->path());
            out["compilations"] += kind == ".cpp" || kind == ".cu";
        }
    return out;
}

TEST(Rooms, AreNoLargerThanTheyWere) {
    std::map<std::string, long> allowed;
    std::ifstream file(list);
    for (std::string name; file >> name;) file >> allowed[name];
    for (auto const& [name, count] : counted())
        EXPECT_LE(count, allowed[name])
            << name << "; to write tests/house/rooms.txt anew: test_house --gtest_also_run_disabled_tests "
            << "--gtest_filter='Rooms.*Write*'";
}
TEST(Rooms, DISABLED_WriteTheList) {
    std::ofstream file(list);
    for (auto const& [name, count] : counted()) file << name << ' ' << count << '\n';
}

}  // namespace
}  // namespace rlslab
