// What a program that was compiled with rlslab.h relies on: symbols, layouts, numbers, and the libraries that come with
// librlslab.so. tests/capi/abi.txt has them as they were recorded.
#include "bindings/c/rlslab.h"
#include "tests/common/files.hpp"

#include <set>
#include <utility>
#include <vector>

namespace rlslab {
namespace {

struct Member {
    char const* name;
    std::size_t offset, size;
};
/// One line for each member. `all` is every member: no byte of the structure is between two of them.
void append(std::string& out, char const* structure, std::size_t size, std::vector<Member> const& all) {
    std::size_t end = 0;
    for (Member const& member : all) {
        EXPECT_EQ(member.offset, end) << structure << "." << member.name << ": a member before it is missing here";
        end = member.offset + member.size;
        out += std::string(structure) + "." + member.name + " " + std::to_string(member.offset) + " " +
               std::to_string(member.size) + "\n";
    }
    EXPECT_EQ(end, size) << structure << ": a member is missing here";
}
template <class Structure, class X>
Member member(char const* name, X Structure::*which) {
    Structure const of{};
    auto const at = [](auto const& x) { return reinterpret_cast<char const*>(&x); };
    return {name, std::size_t(at(of.*which) - at(of)), sizeof(X)};
}

std::string symbols() {
    std::set<std::string> all;  // nm's order depends on the locale
    for (std::string const& line :
         files::lines_of(files::output_of(RLSLAB_NM " -D --defined-only --format=posix " RLSLAB_LIBRARY)))
        all.insert(line.substr(0, line.find_first_of("@ ")));
    all.erase("RLSLAB_1");  // the version itself
    std::string out;
    for (std::string const& name : all) out += name + "\n";
    return out;
}
std::string layouts() {
    std::string out;
    append(out, "rlslab_step", sizeof(rlslab_step),
           {member("innovation", &rlslab_step::innovation), member("residual", &rlslab_step::residual),
            member("gamma", &rlslab_step::gamma), member("health", &rlslab_step::health),
            member("signal", &rlslab_step::signal)});
    using O = rlslab_options;
    append(out, "rlslab_options", sizeof(O),
           {member("bytes", &O::bytes), member("size", &O::size), member("forgetting", &O::forgetting),
            member("prior_variance", &O::prior_variance), member("prior_theta", &O::prior_theta),
            member("prior_covariance", &O::prior_covariance), member("window", &O::window), member("guard", &O::guard),
            member("control", &O::control), member("control_numbers", &O::control_numbers),
            member("control_count", &O::control_count), member("largest_variance", &O::largest_variance),
            member("innovation", &O::innovation), member("least_noise", &O::least_noise),
            member("asymmetry", &O::asymmetry), member("noise_memory", &O::noise_memory),
            member("rebuild_rows", &O::rebuild_rows)});
    using C = rlslab_counts;
    append(out, "rlslab_counts", sizeof(C),
           {member("rows", &C::rows), member("unusable", &C::unusable), member("outliers", &C::outliers),
            member("changes", &C::changes), member("windups", &C::windups), member("breakdowns", &C::breakdowns),
            member("refactored", &C::refactored), member("since", &C::since), member("handed_over", &C::handed_over)});
    using S = rlslab_complex_steps;
    append(out, "rlslab_complex_steps", sizeof(S),
           {member("innovation", &S::innovation), member("residual", &S::residual), member("gamma", &S::gamma),
            member("health", &S::health)});
    return out;
}
std::string numbers() {
    std::string out = "RLSLAB_ABI " + std::to_string(RLSLAB_ABI) + "\n";
    for (auto const& [name, value] :
         std::vector<std::pair<std::string, int>>{{"RLSLAB_OK", RLSLAB_OK},
                                                  {"RLSLAB_NULL", RLSLAB_NULL},
                                                  {"RLSLAB_NAME", RLSLAB_NAME},
                                                  {"RLSLAB_INVALID", RLSLAB_INVALID},
                                                  {"RLSLAB_STATE", RLSLAB_STATE},
                                                  {"RLSLAB_ROOM", RLSLAB_ROOM},
                                                  {"RLSLAB_ABILITY", RLSLAB_ABILITY},
                                                  {"RLSLAB_MEMORY", RLSLAB_MEMORY},
                                                  {"RLSLAB_INTERNAL", RLSLAB_INTERNAL},
                                                  {"RLSLAB_VARIANTS", RLSLAB_VARIANTS},
                                                  {"RLSLAB_ARITHMETICS", RLSLAB_ARITHMETICS},
                                                  {"RLSLAB_GUARDS", RLSLAB_GUARDS},
                                                  {"RLSLAB_CONTROLS", RLSLAB_CONTROLS},
                                                  {"RLSLAB_HEALTHS", RLSLAB_HEALTHS},
                                                  {"RLSLAB_SIGNALS", RLSLAB_SIGNALS}})
        out += name + " " + std::to_string(value) + "\n";
    for (int i = 0; char const* const name = rlslab_name(RLSLAB_HEALTHS, std::size_t(i)); ++i)
        out += "health " + std::to_string(i) + " " + name + "\n";
    for (int i = 0; char const* const name = rlslab_name(RLSLAB_SIGNALS, std::size_t(i)); ++i)
        out += "signal " + std::to_string(i) + " " + name + "\n";
    return out;
}

TEST(Abi, IsAsRecorded) {
    static_assert(sizeof(void*) == 8, "tests/capi/abi.txt is of 64-bit processors");
    std::string const now = symbols() + layouts() + numbers();
    EXPECT_EQ(now, files::read(RLSLAB_SOURCE_DIR "/tests/capi/abi.txt"))
        << "What was added goes into tests/capi/abi.txt. What is gone or has another meaning needs RLSLAB_ABI + 1.";
    EXPECT_EQ(rlslab_abi(), RLSLAB_ABI);
    EXPECT_STREQ(rlslab_version(), RLSLAB_VERSION);
}
TEST(Abi, NoLibraryComesWithItButTheRuntimeOfCpp) {
    std::set<std::string> needed;
    std::string soname;
    for (std::string const& line : files::lines_of(files::output_of(RLSLAB_READELF " -dW " RLSLAB_LIBRARY))) {
        std::size_t const from = line.find('['), to = line.find(".so", from);
        if (line.find("(NEEDED)") != line.npos) needed.insert(line.substr(from + 1, to - from - 1));
        if (line.find("(SONAME)") != line.npos) soname = line.substr(from + 1, line.find(']') - from - 1);
    }
    EXPECT_EQ(soname, "librlslab.so." + std::to_string(RLSLAB_ABI));
    // The dynamic linker of glibc is named for the messages of threads.
    std::erase_if(needed, [](std::string const& name) { return name.starts_with("ld-linux"); });
#ifdef RLSLAB_SANITIZED
    GTEST_SKIP() << "the runtime of a sanitizer comes with the program";
#endif
    EXPECT_THAT(needed, testing::IsSubsetOf({"libstdc++", "libm", "libgcc_s", "libc"}));
    EXPECT_TRUE(needed.contains("libc"));
}

}  // namespace
}  // namespace rlslab
