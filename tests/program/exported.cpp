// Exported filters are compiled by the C compilers that are here, and leave the bits of C++.
#include "src/lab/export/export.hpp"
#include "tests/common/files.hpp"
#include "tests/embedded/exported.h"

#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>

#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <unistd.h>

namespace rlslab {

template <class T>
struct Encoding<Counted<T>> : Encoding<T> {  // a state is walked, not written
    static void write(Counted<T> const& x, std::byte* to) { Encoding<T>::write(x.value(), to); }
    static bool read(std::byte const*, Counted<T>&) { return false; }
};

namespace {

namespace fs = std::filesystem;

long rows() {  // a long run, of four parameters: RLSLAB_EXPORTED_ROWS=1000000
    char const* const text = std::getenv("RLSLAB_EXPORTED_ROWS");
    return text ? std::atol(text) : 1000;
}

/// Shows the numbers of a state, in the order of its bytes, to a digest.
struct Numbers : detail::Silent {
    std::uint64_t& digest;
    explicit Numbers(std::uint64_t& to) : digest(to) {}
    template <class X>
    void number(X const& x) {
        if constexpr (!std::same_as<X, bool>) hostile_add(&digest, double(x));
    }
    template <class X>
    void irregular(X const&) {}
};

/// What exported.h says of the same filter in C.
template <class F>
std::uint64_t digest_of(int d, bool patient) {
    using T = typename F::scalar;
    hostile_rows r = hostile_start(ArithmeticTraits<T>::digits == 53);
    auto const begun = [&] {
        return F({.size = d, .forgetting = T(r.lambda), .prior = Prior<T>{.variance = T(r.variance)}});
    };
    std::uint64_t digest = 0;
    F f = begun();
    for (long k = 0; k < rows(); ++k) {
        std::vector<T> psi(std::size_t(d), T(0));
        hostile_next(&r, d);
        for (int i = 0; i < d; ++i) psi[std::size_t(i)] = T(r.psi[i]);
        Step<T> const s = f.update({psi.data(), d}, T(r.y));
        for (T const x : {s.innovation, s.residual, s.gamma}) hostile_add(&digest, double(x));
        hostile_add(&digest, double(int(s.health)));
        Numbers numbers(digest);
        if (patient || s.health != Health::nonfinite) detail::walk(numbers, f);
        if (k % 97 == 96 || (!patient && s.health == Health::nonfinite)) {
            hostile_begin(&r);
            f = begun();
        }
    }
    return digest;
}

struct Case {
    std::string variant;
    bool in_double;
    int size;
    bool loops = true;
    std::string name() const {
        return variant + (in_double ? "_d" : "_f") + std::to_string(size) + (loops ? "" : "_unrolled");
    }
    std::string upper_name() const {
        std::string out = name();
        for (char& x : out) x = char(std::toupper(static_cast<unsigned char>(x)));
        return out;
    }
    std::string header() const {
        return exporting::c_header({.variant = variant,
                                    .size = size,
                                    .in_double = in_double,
                                    .name = name(),
                                    .made_by = "rlslab export c",
                                    .loops = loops});
    }
};

/// call<F>(size) with the C++ type of a case: its size fixed where that is 4, in `T`.
template <class T, class Call>
auto with_type(Case const& c, Call call) {
    auto const sized = [&]<template <class, int> class V>() {
        if constexpr (std::floating_point<T>)
            if (c.size == 4) return call.template operator()<V<T, 4>>(c.size);
        return call.template operator()<V<T, Dynamic>>(c.size);
    };
    if (c.variant == "ud") return sized.template operator()<Ud>();
    if (c.variant == "ud_delta") return sized.template operator()<UdDelta>();
    if (c.variant == "carlson") return sized.template operator()<Carlson>();
    if (c.variant == "symmetric") return sized.template operator()<Symmetric>();
    if (c.variant == "joseph_rank_two") return sized.template operator()<JosephRankTwo>();
    if (c.variant == "conventional") return sized.template operator()<Conventional>();
    if (c.variant == "gentleman") return sized.template operator()<Gentleman>();
    throw std::logic_error(c.variant);
}

std::vector<Case> const& cases() {
    static std::vector<Case> const all = [] {
        std::vector<Case> out;
        for (std::string_view const variant : exporting::exported_variants())
            for (bool const in_double : {false, true}) {
                if (!exporting::is_exported(variant, in_double)) continue;
                for (int const size : rows() < 100'000 ? std::vector{1, 3, 4, 9} : std::vector{4})
                    out.push_back({std::string(variant), in_double, size});
                out.push_back({std::string(variant), in_double, 4, false});
            }
        return out;
    }();
    return all;
}

fs::path const& folder() {
    static fs::path const path = [] {
        fs::path const out = fs::path(testing::TempDir()) / ("exported_c." + std::to_string(getpid()));
        fs::create_directories(out);
        return out;
    }();
    return path;
}
void write(fs::path const& path, std::string const& text) { std::ofstream(path) << text; }

/// A program that prints the digest of each case.
std::string program_of(std::vector<Case> const& of) {
    std::string out, runs;
    for (Case const& c : of) {
        std::string const name = c.name(), file = name + ".h", NAME = c.upper_name();
        out += "#include \"" + file + "\"\n";
        runs += "DEFINE_RUN(" + name + ", " + NAME + ", " + (c.in_double ? "double" : "float") + ", " +
                std::to_string(c.size) + ")\n";
    }
    out += "#include <stdio.h>\n#include <stdlib.h>\n#include \"" RLSLAB_SOURCE_DIR "/tests/embedded/exported.h\"\n" +
           runs;
    out += "int main(int count, char **words) {\n    long const rows = count > 1 ? atol(words[1]) : 0;\n";
    for (Case const& c : of)
        for (int const patient : {0, 1})
            out += "    printf(\"" + c.name() + " " + std::to_string(patient) +
                   " %016llx\\n\", (unsigned long long)run_" + c.name() + "(rows, " + std::to_string(patient) + "));\n";
    return out + "    return 0;\n}\n";
}

std::vector<std::string> compilers() {
    std::vector<std::string> out;
    for (char const* const name : {"gcc", "clang-16", "clang"})
        if (files::there_is(name) && (out.empty() || out.back() != "clang-16")) out.push_back(name);
    return out;
}
fs::path compiled(std::string const& compiler, std::string const& options, std::string const& source) {
    fs::path const program = folder() / (source + "." + compiler);
    std::string const compile = compiler + " -std=c99 -pedantic -Wall -Wextra -Werror " + options + " " +
                                (folder() / source).string() + " -o " + program.string() + " -lm";
    EXPECT_EQ(std::system(compile.c_str()), 0) << compile;
    return program;
}
/// What the program prints, as name and `patient` to digest.
std::map<std::string, std::string> run(std::string const& compiler, std::string const& options,
                                       std::string const& source) {
    fs::path const program = compiled(compiler, options, source);
    std::istringstream lines(files::output_of(program.string() + " " + std::to_string(rows())));
    std::map<std::string, std::string> out;
    for (std::string name, patient, digest; lines >> name >> patient >> digest;) out[name + " " + patient] = digest;
    return out;
}
std::string hex(std::uint64_t x) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(x));
    return text;
}

class ExportedC : public testing::Test {
protected:
    void SetUp() override {
        if (compilers().empty()) GTEST_SKIP() << "no C compiler";
    }
    static void write_headers() {
        for (Case const& c : cases()) write(folder() / (c.name() + ".h"), c.header());
    }
};

TEST_F(ExportedC, LeavesTheBitsOfCxx) {
    write_headers();
    write(folder() / "all.c", program_of(cases()));
    std::map<std::string, std::string> expected;
    for (Case const& c : cases()) {
        // While a filter has broken down, blocks of rows compute what single rows do not (docs/same_bits.md).
        auto const of = [&]<class F>(int d) { return digest_of<F>(d, false); };
        auto const patient = [&]<class F>(int d) { return digest_of<F>(d, true); };
        expected[c.name() + " 0"] = hex(c.in_double ? with_type<double>(c, of) : with_type<float>(c, of));
        expected[c.name() + " 1"] =
            hex(c.in_double ? with_type<Counted<double>>(c, patient) : with_type<Counted<float>>(c, patient));
    }
    for (std::string const& compiler : compilers())
        for (std::string const level : {"-O0", "-O1", "-O2", "-O3"}) {
            if (rows() < 100'000 && level == "-O1") continue;
            auto const found = run(compiler, level + " -ffp-contract=off", "all.c");
            ASSERT_EQ(found.size(), expected.size());
            for (auto const& [name, digest] : expected)
                EXPECT_EQ(found.at(name), digest) << name << ' ' << compiler << level;
        }
}

/// An operation that is not that of the page is seen, and so is one that is fused.
TEST_F(ExportedC, AnotherOperationLeavesOtherBits) {
    Case const c{"ud", false, 4};
    std::string const header = c.header();
    write(folder() / "one.c", program_of({c}));
    write(folder() / (c.name() + ".h"), header);
    auto const whole = run(compilers().front(), "-O1 -ffp-contract=off", "one.c");
    std::pair<char const*, char const*> const changes[] = {
        {"(psi[0] * f->theta[0]) + (psi[2] * f->theta[2])", "(psi[0] * f->theta[0]) + (psi[1] * f->theta[1])"},
        {"x2 = 0.0f;", "x2 = -0.0f;"},
        {"/ w3[i]", "* (1.0f / w3[i])"},
        {"_F4_SOUND)", "_F4_INDEFINITE)"},
        {"< (4 - i)", "< (3 - i)"}};
    for (auto const& [is, becomes] : changes) {
        std::string changed = header;
        std::size_t const at = changed.find(is, changed.find("_update("));
        ASSERT_NE(at, changed.npos) << is;
        write(folder() / (c.name() + ".h"), changed.replace(at, std::string(is).size(), becomes));
        EXPECT_NE(run(compilers().front(), "-O1 -ffp-contract=off", "one.c"), whole) << becomes;
    }
    write(folder() / (c.name() + ".h"), header);
    if (files::output_of("grep -c -w fma /proc/cpuinfo || true") == "0\n") return;
    EXPECT_NE(run("gcc", "-O2 -mfma -ffp-contract=fast", "one.c"), whole) << "operations were fused";
    EXPECT_EQ(run("gcc", "-std=gnu99 -O2 -mfma", "one.c"), whole) << "the header says so to gcc";
    if (files::there_is("clang-16")) {
        EXPECT_EQ(run("clang-16", "-O2 -mfma -ffp-contract=on", "one.c"), whole) << "the pragma against it is read";
    }
}

/// Options that change bits are refused, and so is a double of another length.
TEST_F(ExportedC, RefusesOtherArithmetics) {
    Case const single{"ud", false, 2}, twice{"ud", true, 2};
    for (Case const& c : {single, twice}) {
        write(folder() / (c.name() + ".h"), c.header());
        write(folder() / "refused.c", "#include \"" + c.name() + ".h\"\nint main(void) { return 0; }\n");
        auto const compiles = [&](std::string const& options) {
            return std::system(
                       ("gcc -c -o /dev/null " + options + " " + (folder() / "refused.c").string() + " 2> /dev/null")
                           .c_str()) == 0;
        };
        if (!files::there_is("gcc")) GTEST_SKIP() << "no gcc";
        EXPECT_TRUE(compiles(""));
        EXPECT_FALSE(compiles("-ffast-math"));
        EXPECT_FALSE(compiles("-ffinite-math-only"));
#ifdef __x86_64__
        EXPECT_FALSE(compiles("-mfpmath=387"));
#endif
        EXPECT_EQ(compiles("-include float.h -UDBL_MANT_DIG -D__DBL_MANT_DIG__=24 -w"), !c.in_double);
    }
}

/// Takes the rows [first, last) of noise.
template <class F>
void take(F& f, int d, hostile_rows& r, int rows) {
    using T = typename F::scalar;
    for (int k = 0; k < rows; ++k) {
        std::vector<T> psi(std::size_t(d), T(0));
        for (T& x : psi) x = T(hostile_noise(&r));
        f.update({psi.data(), d}, T(hostile_noise(&r)));
    }
}
std::string text_of(std::vector<std::byte> const& bytes) {
    return {reinterpret_cast<char const*>(bytes.data()), bytes.size()};
}

/// C++ goes on from C's bytes, and C from those of C++; C refuses damaged ones.
TEST_F(ExportedC, SavesAndLoadsTheStateOfCxx) {
    write_headers();
    for (Case const& c : cases()) {
        if (c.size != 4 || !c.loops) continue;
        std::string const name = c.name(), number = c.in_double ? "double" : "float";
        std::string source = "#include \"" + name +
                             ".h\"\n#include <stdio.h>\n#include \"" RLSLAB_SOURCE_DIR
                             "/tests/embedded/exported.h\"\n#define d " +
                             std::to_string(c.size) + "\n#define number " + number + "\n#define MADE(x) " + name +
                             "_##x\n#define BYTES (int)" + c.upper_name() + R"c(_STATE_BYTES
static void take(MADE(type) *f, hostile_rows *r, int rows) {
    int k, i;
    for (k = 0; k < rows; ++k) {
        number psi[d];
        for (i = 0; i < d; ++i) psi[i] = (number)hostile_noise(r);
        (void)MADE(update)(f, psi, (number)hostile_noise(r));
    }
}
int main(void) {
    static MADE(type) f, g;
    static uint8_t bytes[BYTES];
    hostile_rows r = hostile_start(0);
    int i, bit;
    (void)hostile_next;
    (void)hostile_add;
    if (MADE(init)(&f, 0, 1) || MADE(init)(&f, 2, 1) || MADE(init)(&f, 1, 0) || MADE(init)(&f, 1, -1)) return 1;
    if (!MADE(init)(&f, (number)0.984375, 1000)) return 2;
    take(&f, &r, 50);
    MADE(save)(&f, bytes);
    fwrite(bytes, 1, BYTES, stdout);
    if (fread(bytes, 1, BYTES, stdin) != BYTES) return 3;
    for (i = 0; i < BYTES; ++i)
        for (bit = 0; bit < 8; bit += 7) {
            bytes[i] ^= (uint8_t)(1u << bit);
            if (MADE(load)(&g, bytes)) return 4;
            bytes[i] ^= (uint8_t)(1u << bit);
        }
    if (!MADE(load)(&g, bytes)) return 5;
    take(&g, &r, 50);
    MADE(save)(&g, bytes);
    fwrite(bytes, 1, BYTES, stdout);
    return 0;
}
)c";
        for (std::size_t at; (at = source.find("MADE(type)")) != source.npos;) source.replace(at, 10, name);
        write(folder() / "state.c", source);
        fs::path const program = compiled(compilers().front(), "-O1 -ffp-contract=off", "state.c");
        auto const half_and_whole = [&]<class F>(int size) {
            using T = typename F::scalar;
            F f({.size = size, .forgetting = T(0.984375), .prior = Prior<T>{.variance = T(1000)}});
            hostile_rows r = hostile_start(0);
            take(f, size, r, 50);
            auto const half = state_of(f);
            std::string out = text_of({half.begin(), half.end()});
            take(f, size, r, 50);
            auto const whole = state_of(f);
            return out + text_of({whole.begin(), whole.end()});
        };
        std::string const expected =
            c.in_double ? with_type<double>(c, half_and_whole) : with_type<float>(c, half_and_whole);
        write(folder() / "half", expected.substr(0, expected.size() / 2));
        EXPECT_EQ(files::output_of(program.string() + " < " + (folder() / "half").string()), expected) << name;
    }
}

/// The header of the example is this one, and the function that costs are compared with is the page's.
TEST_F(ExportedC, IsTheHeaderOfTheMicrocontroller) {
    fs::path const root = RLSLAB_SOURCE_DIR;
    std::string const here = files::read(root / "docs/examples/microcontroller/motor.h"),
                      by_hand = files::read(root / "tests/embedded/by_hand.h");
    std::size_t const at = by_hand.find("// Takes one row");
    EXPECT_NE(files::read(root / "docs/embedded.md").find(by_hand.substr(at, by_hand.find("\n}\n", at) - at)),
              std::string::npos);
    EXPECT_EQ(here, exporting::c_header(
                        {.variant = "ud",
                         .size = 3,
                         .name = "motor",
                         .made_by = "rlslab export c --variant ud --size 3 --arithmetic float --name motor"}));
}

/// The rules of MISRA that cppcheck's addon finds broken are those that the header names.
TEST_F(ExportedC, NamesTheRulesOfMisraThatItBreaks) {
    if (!files::there_is("cppcheck")) GTEST_SKIP() << "no cppcheck";
    for (Case const& c : cases()) {
        if (c.size != 4 || !c.loops || (c.variant != "ud" && !c.in_double)) continue;
        std::string const header = c.header();
        write(folder() / (c.name() + ".h"), header);
        write(folder() / "misra.c", "#include \"" + c.name() + ".h\"\n");
        std::string const found =
            files::output_of("cppcheck -q --std=c99 --addon=misra " + (folder() / "misra.c").string() + " 2>&1");
        if (found.find("addon") != found.npos && found.find("misra-c2012") == found.npos) GTEST_SKIP() << found;
        std::set<std::string> rules, named;
        for (std::size_t at = 0; (at = found.find("misra-c2012-", at)) != found.npos; at += 12)
            rules.insert(found.substr(at + 12, found.find(']', at) - at - 12));
        std::size_t const from = header.find("finds broken: ");
        std::istringstream words(header.substr(from + 14, header.find('\n', from) - from - 14));
        for (std::string word; words >> word;)
            if (std::isdigit(static_cast<unsigned char>(word[0]))) named.insert(word);
        EXPECT_EQ(rules, named) << c.name();
    }
}

}  // namespace
}  // namespace rlslab
