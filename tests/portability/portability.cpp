// The headers with other compilers, options and processors: options that break rounding are refused or reported, and
// another processor leaves the same bits.
#include "tests/common/files.hpp"

#include <rlslab/core/rounding.hpp>

#include <cfenv>
#include <cstdlib>
#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace rlslab {
namespace {

using files::shell, files::there_is, files::Ran;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// The compiler of this build, and the others that are installed.
std::vector<std::string> compilers() {
    std::vector<std::string> out{RLSLAB_CXX};
    for (char const* other : {"g++", "clang++"})
        if (there_is(other)) out.push_back(other);
    return out;
}
std::string const headers = " -std=c++20 " RLSLAB_HEADER_FLAGS " ";
/// Prints what rounding_faults() says.
constexpr char faults_printed[] = R"(#include <rlslab/core/rounding.hpp>
#include <cstdio>
int main() { for (auto const fault : rlslab::rounding_faults()) std::puts(fault.data()); }
)";

TEST(Options, ThatTakeInfinitiesAwayDoNotCompile) {
    files::Folder const folder;
    std::string const app = folder.file("#include <rlslab/variants/ud.hpp>\n", "app.cpp");
    std::string const least = folder.file("#include <rlslab/core/scalar.hpp>\n", "least.cpp");
    for (std::string const& compiler : compilers()) {
        for (char const* options : {"-ffast-math", "-Ofast", "-O2 -ffinite-math-only"}) {
            Ran const tried = shell(compiler + headers + options + " -fsyntax-only " + least);
            EXPECT_NE(tried.code, 0) << compiler << " " << options;
            EXPECT_THAT(tried.text, HasSubstr("rlslab: -ffast-math or -ffinite-math-only"))
                << compiler << " " << options;
        }
        EXPECT_THAT(shell(compiler + headers + "-ffast-math -fsyntax-only " + app).text,
                    HasSubstr("rlslab: -ffast-math"))
            << compiler;
        Ran const plain = shell(compiler + headers + "-O2 -fsyntax-only " + least);
        EXPECT_EQ(plain.code, 0) << plain.text;
    }
    for (char const* options : {"-funsafe-math-optimizations",
                                "-fassociative-math -fno-signed-zeros -fno-trapping-math", "-freciprocal-math"})
        if (there_is("g++")) {
            EXPECT_THAT(shell("g++" + headers + options + " -fsyntax-only " + least).text,
                        HasSubstr("rlslab: -funsafe-math-optimizations"))
                << options;
        }
}

/// Those that reach no other header of ours first, and one that reaches most.
TEST(Options, OfAnOlderLanguageGetOneMessage) {
    files::Folder const folder;
    for (std::string const header : {"core/scalar.hpp", "core/random.hpp", "input/bytes.hpp", "model/lags.hpp",
                                     "catalogue/native/filter.hpp", "rlslab.hpp"}) {
        std::string const app = folder.file("#include <rlslab/" + header + ">\n", "app.cpp");
        for (std::string const& compiler : compilers())
            for (char const* language : {"11", "17"}) {
                std::string const text =
                    shell(compiler + " " RLSLAB_HEADER_FLAGS " -fsyntax-only -std=c++" + language + " " + app).text;
                EXPECT_THAT(text.substr(0, text.find("error:") + 80), HasSubstr("rlslab needs C++20"))
                    << compiler << " " << header << " " << language;
            }
    }
}
/// clang++ has no macro for this part of -ffast-math: the program tells when it runs.
TEST(Rounding, TellsOfReciprocals) {
    if (!there_is("clang++")) GTEST_SKIP() << "needs clang++";
    files::Folder const folder;
    std::string const source = folder.file(faults_printed, "app.cpp"), app = (folder.path / "app").string();
    for (auto const& [option, expected] :
         {std::pair("", ""), {"-freciprocal-math", "quotients are products with a reciprocal"}}) {
        Ran const built = shell("clang++" + headers + "-O2 -ffp-contract=off " + option + " " + source + " -o " + app);
        ASSERT_EQ(built.code, 0) << built.text;
        EXPECT_THAT(shell(app).text, StartsWith(expected)) << option;
        EXPECT_EQ(shell(app).text.empty(), *expected == '\0') << option;
    }
}
TEST(Rounding, IsAsDefinedHere) { EXPECT_THAT(rounding_faults(), IsEmpty()); }
TEST(Rounding, TellsOfAnotherMode) {
    for (int const mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
        std::fesetround(mode);
        auto const faults = rounding_faults();
        std::fesetround(FE_TONEAREST);
        EXPECT_THAT(faults, ElementsAre(StartsWith("the rounding mode is not to nearest"))) << mode;
    }
    EXPECT_THAT(rounding_faults(), IsEmpty());
}
#ifdef __x86_64__
TEST(Rounding, TellsOfSubnormalsTakenAsZero) {
    unsigned const before = _mm_getcsr();
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    auto const flushed = rounding_faults();
    _mm_setcsr(before | 0x0040);
    auto const taken = rounding_faults();
    _mm_setcsr(before);
    EXPECT_THAT(flushed, ElementsAre(StartsWith("subnormal results are flushed to zero")));
    EXPECT_THAT(taken, ElementsAre(StartsWith("subnormal operands are taken as zero")));
    EXPECT_THAT(rounding_faults(), IsEmpty());
}
TEST(Rounding, TellsOfContraction) {
    if (!__builtin_cpu_supports("fma")) GTEST_SKIP() << "this processor has no fused multiply-add";
    files::Folder const folder;
    std::string const app = folder.file(faults_printed, "app.cpp"), out = (folder.path / "app").string();
    for (std::string const& compiler : compilers())
        for (char const* level : {"-O0 ", "-O2 ", "-O3 "}) {
            auto const told = [&](std::string const& options) {
                return shell(compiler + headers + level + options + " " + app + " -o " + out + " && " + out).text;
            };
            EXPECT_EQ(told("-mfma -ffp-contract=off"), "") << compiler << level;
            std::string const fused = told("-mfma -ffp-contract=fast");
            if (std::string(level) == "-O0 " && fused.empty()) continue;  // g++ contracts where it optimises
            EXPECT_THAT(fused, StartsWith("products and sums are contracted")) << compiler << level;
        }
}
#endif

TEST(Headers, CompileWithTheOtherStandardLibrary) {
    files::Folder const folder;
    std::string const nothing = folder.file("#include <compare>\n", "nothing.cpp"),
                      command = "clang++ -stdlib=libc++" + headers + "-O1 -fsyntax-only ";
    if (!there_is("clang++") || shell(command + nothing).code != 0)
        GTEST_SKIP() << "needs the packages clang, libc++-dev and libc++abi-dev";
    std::string all;
    for (char const* part : {"src", "variants"})
        for (auto const& file :
             std::filesystem::recursive_directory_iterator(std::string(RLSLAB_SOURCE_DIR "/") + part)) {
            std::string const name = std::filesystem::relative(file.path(), RLSLAB_SOURCE_DIR).string();
            bool const library =
                name.find("sparse") != name.npos || name.find("cholmod") != name.npos || name.find("spqr") != name.npos;
            if (file.path().extension() == ".hpp" && name.find("linalg/kernels/") == name.npos &&
                name.find("core/instructions") == name.npos && !library)
                all += "#include <rlslab/" + (name.starts_with("src/") ? name.substr(11) : name) + ">\n";
        }
    Ran const tried = shell(command + folder.file(all, "all.cpp"));
    EXPECT_EQ(tried.code, 0) << tried.text;
}

constexpr char digest_sources[] =
    RLSLAB_SOURCE_DIR "/tests/portability/digest.cpp " RLSLAB_SOURCE_DIR "/tests/portability/asked.cpp ",
               digest_options[] = "-O1 -ffp-contract=off -DNDEBUG -I " RLSLAB_SOURCE_DIR " ";
void expect_the_bits_of_this_machine(std::string const& command) {
    Ran const there = shell(command + " all"), here = shell(RLSLAB_DIGEST " all");
    EXPECT_EQ(there.code, 0);
    EXPECT_THAT(here.text, HasSubstr("\nud double 24 "));
    EXPECT_EQ(there.text, here.text);
}

TEST(CompiledKernels, LeaveTheBitsOfTheHeaders) { expect_the_bits_of_this_machine(RLSLAB_DIGEST_BY_KERNELS); }

/// Of another order of bytes, too (s390x). A minute each: all but the first by option.
struct Processor {
    char const *name, *packages;
    bool asked_for;
};
class Processors : public testing::TestWithParam<Processor> {};
TEST_P(Processors, OfAnotherKindLeaveTheSameBits) {
    auto const [name, packages, asked_for] = GetParam();
    if (asked_for && !std::getenv("RLSLAB_ALL_PROCESSORS"))
        GTEST_SKIP() << "takes a minute: asked for by RLSLAB_ALL_PROCESSORS=1";
    std::string const compiler = std::string(name) + "-linux-gnu-g++", emulator = std::string("qemu-") + name;
    if (!there_is(compiler) || !there_is(emulator))
        GTEST_SKIP() << "needs the packages " << packages << " and qemu-user";
    files::Folder const folder;
    std::string const out = (folder.path / "digest").string();
    Ran const built = shell(compiler + headers + digest_options + "-static " + digest_sources + "-o " + out);
    ASSERT_EQ(built.code, 0) << built.text;
    expect_the_bits_of_this_machine(emulator + " " + out);
}
INSTANTIATE_TEST_SUITE_P(Emulated, Processors,
                         testing::Values(Processor{"aarch64", "g++-aarch64-linux-gnu, libc6-dev-arm64-cross", false},
                                         Processor{"riscv64", "g++-riscv64-linux-gnu, libc6-dev-riscv64-cross", true},
                                         Processor{"s390x", "g++-s390x-linux-gnu, libc6-dev-s390x-cross", true}),
                         [](auto const& tested) { return std::string(tested.param.name); });

TEST(ProcessorsOfPages, WebAssemblyLeavesTheSameBits) {
    if (!std::getenv("RLSLAB_ALL_PROCESSORS")) GTEST_SKIP() << "takes a minute: asked for by RLSLAB_ALL_PROCESSORS=1";
    if (!there_is("em++") || !there_is("node")) GTEST_SKIP() << "needs the packages emscripten and nodejs";
    files::Folder const folder;
    std::string const out = (folder.path / "digest.js").string();  // one file: node's own fetch takes no path
    Ran const built =
        shell("em++" + headers + digest_options + "-s SINGLE_FILE=1 -s TOTAL_STACK=4MB -s INITIAL_MEMORY=64MB " +
              digest_sources + "-o " + out);
    ASSERT_EQ(built.code, 0) << built.text;
    expect_the_bits_of_this_machine("node " + out);
}

}  // namespace
}  // namespace rlslab
