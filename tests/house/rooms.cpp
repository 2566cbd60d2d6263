// The tree does not grow unseen: no room has more lines, and the tree not more compilations, than rooms.txt says. Who
// needs more raises the number in the same commit, and says there what became shorter.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace rlslab {
namespace {

namespace fs = std::filesystem;
fs::path const root = RLSLAB_SOURCE_DIR, list = root / "tests/house/rooms.txt";

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
            std::ifstream text(at->path());
            out[room] += std::count(std::istreambuf_iterator<char>(text), {}, '\n');
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
