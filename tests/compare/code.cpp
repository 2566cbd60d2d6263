// The code that `compare` prints, for C++, a board and C, compiles as it stands, and its filter learns the same bits as
// the catalogue's.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/compare.hpp"
#include "src/lab/compare/digits_answer.hpp"
#include "tests/common/files.hpp"

#include <rlslab/model/lags.hpp>
#include <rlslab/model/regression.hpp>
#include <rlslab/variants/variants.hpp>

#include <cxxabi.h>
#include <fstream>
#include <map>

namespace rlslab {
using namespace compare;
using namespace report;
namespace {

namespace fs = std::filesystem;

std::string hex(double x) {
    char text[64];
    std::snprintf(text, sizeof text, "%a", x);
    return text;
}

/// For each word of --code: the files and the compiler of a program that feeds the code each row in rows.txt, and gives
/// theta after each, a line each, as hexadecimal numbers.
struct Fed {
    char const *file, *program, *compile;
};
std::map<std::string_view, Fed> const fed{
    {"cpp",
     {"filter.cpp", R"(#include "filter.cpp"
#include <cstdio>
#include <vector>
int main() {
    using T = std::remove_cvref_t<decltype(filter.theta()[0])>;
    std::FILE* const rows = std::fopen("rows.txt", "r");
    std::vector<T> psi(size_t(filter.theta().size()));
    for (double x;;) {
        for (T& p : psi) { if (std::fscanf(rows, "%la", &x) != 1) return 0; p = T(x); }
        if (std::fscanf(rows, "%la", &x) != 1) return 1;
        auto const step = filter.update(psi, T(x));
        if (step.health != rlslab::Health::sound) return 2;
        for (size_t i = 0; i < psi.size(); ++i) std::printf("%a ", double(filter.theta()[i]));
        std::printf("\n");
    }
}
)",
      RLSLAB_COMPILE
      " -O0 -Wall -Wextra -Wpedantic -Werror -Wno-unknown-warning-option -Wno-maybe-uninitialized main.cpp"}},
    {"board",
     {"filter.cpp", R"(#include "filter.cpp"
#include <cstdio>
template <class R, int d, class T>
int run(rlslab::Step<T> (&taken)(R const (&)[d], R), void (&told)(R (&)[d])) {
    std::FILE* const rows = std::fopen("rows.txt", "r");
    R row[d];
    for (double x;;) {
        for (R& p : row) { if (std::fscanf(rows, "%la", &x) != 1) return 0; p = R(x); }
        if (std::fscanf(rows, "%la", &x) != 1) return 1;
        if (taken(row, R(x)).health != rlslab::Health::sound) return 2;
        told(row);
        for (R const p : row) std::printf("%a ", double(p));
        std::printf("\n");
    }
}
int main() { return run(take, theta); }
)",
      RLSLAB_COMPILE " -O1 -fno-exceptions -fno-rtti -DNDEBUG -Wall -Wextra -Werror main.cpp"}},
    {"c",
     {"filter.c", R"(#include "filter.c"
#include <stdio.h>
#ifndef SCALED
#define take rlslab_update
#define theta rlslab_theta
#endif
int main(void) {
    double row[64], out[64], y;
    rlslab_step step;
    FILE *rows = fopen("rows.txt", "r");
    rlslab_filter *filter = new_filter();
    size_t d = rlslab_size(filter), i;
    if (filter == 0) return 3;
    for (;;) {
        for (i = 0; i < d; ++i) if (fscanf(rows, "%la", &row[i]) != 1) return rlslab_free(filter), 0;
        if (fscanf(rows, "%la", &y) != 1) return 1;
        if (take(filter, row, y, &step) != RLSLAB_OK || step.health != 0) return 2;
        if (theta(filter, out) != RLSLAB_OK) return 4;
        for (i = 0; i < d; ++i) printf("%a ", out[i]);
        printf("\n");
    }
}
)",
      RLSLAB_COMPILE_C " -O1 -pedantic -Wall -Wextra -Werror"}}};

std::string learnt_by(std::string const& text, Records const& records, std::string_view word = "cpp") {
    Fed const& by = fed.at(word);
    files::Folder const folder;
    std::ofstream(folder.path / (word == "c" ? "main.c" : "main.cpp"))
        << (text.find("\nrlslab_status take(") != text.npos ? "#define SCALED\n" : "") << by.program;
    std::ofstream(folder.path / by.file) << text;
    std::ofstream rows(folder.path / "rows.txt");
    for (Index k = 0; k < records.rows(); ++k) {
        for (Index i = 0; i < records.parameters(); ++i) rows << hex(records.psi(i, k)) << ' ';
        rows << hex(records.y[k]) << '\n';
    }
    rows.close();
    std::string const in = "cd '" + folder.path.string() + "' && ";
    if (std::system((in + by.compile + " -o main").c_str()) != 0) return "does not compile:\n" + text;
    if (std::system((in + "./main > out.txt").c_str()) != 0) return "does not run:\n" + text;
    return files::read(folder.path / "out.txt");
}

/// The same of the catalogue's filter, in units of the record: its columns are taken times the filter's powers of two.
std::string learnt_by_the_catalogues(Comparison const& c, Records records, CodedFilter const& coded) {
    Prior<double> prior = c.scaled_prior ? c.scaled_prior->prior() : Prior<double>{.variance = *c.options.p0};
    std::vector<int> exponents = coded.exponents;
    exponents.resize(size_t(records.parameters()));
    for (Index i = 0; i < records.parameters(); ++i) records.psi.row(i) *= std::ldexp(1.0, exponents[size_t(i)]);
    records.y *= std::ldexp(1.0, coded.output_exponent);
    std::string out;
    Problem<double> const problem{.size = records.parameters(), .forgetting = c.options.forgetting, .prior = prior};
    CatalogueEntry const* const entry = find_entry(coded.variant, coded.arithmetic);
    if (!entry) return "no such entry";
    std::unique_ptr<AnyFilter> const filter =
        c.options.composition.empty() ? entry->make(problem, Seed{1})
                                      : composed(c.options.composition, coded.variant, coded.arithmetic, problem);
    for (Index k = 0; k < records.rows(); ++k) {
        filter->update(records.sample(k), records.y[k]);
        Vector<Reference> const theta = filter->theta();
        for (Index i = 0; i < theta.size(); ++i)
            out += hex(std::ldexp(static_cast<double>(theta[i]), exponents[size_t(i)] - coded.output_exponent)) + " ";
        out += '\n';
    }
    return out;
}
std::string learnt_by_the_catalogues(Comparison const& c, Records const& records) {
    return learnt_by_the_catalogues(c, records, {.variant = coded(c)->variant, .arithmetic = coded(c)->arithmetic});
}

void expect_the_code_to_learn_the_same(Records const& records, CompareOptions options) {
    options.timings = false;
    Comparison const c = compare::compare(records, options);
    ASSERT_NE(coded(c), nullptr);
    std::string const expected = learnt_by_the_catalogues(c, records);
    EXPECT_GT(expected.size(), 1000u);
    EXPECT_TRUE(learnt_by(code(c), records) == expected) << code(c);
    EXPECT_TRUE(learnt_by(code(c, "c"), records, "c") == expected) << code(c, "c");
}

Records arx(char const* file, char const* u, char const* y, int order, bool intercept = false) {
    Arx model = arx_of_order(order);
    model.intercept = intercept;
    return arx_records(read_columns(std::string(RLSLAB_SOURCE_DIR "/") + file, {u, y}), u, y, model);
}

/// On rows of which the guard has nothing to tell.
TEST(GuardedCode, CompilesAndLearnsTheSameBits) {
    Records const records = arx("studies/data/sales.csv", "lead", "sales", 2);
    Comparison const c = compare::compare(records, {.arithmetics = {"float"}, .timings = false});
    ASSERT_NE(coded(c), nullptr);
    std::string const text = code(c, {.variant = coded(c)->variant, .arithmetic = "float", .guarded = true});
    EXPECT_NE(text.find("rlslab::Guarded<"), text.npos);
    EXPECT_TRUE(learnt_by(text, records) == learnt_by_the_catalogues(c, records)) << text;
}

/// On rows of which its guard has nothing to tell.
TEST(Board, CompilesWithoutExceptionsAndLearnsTheSameBits) {
    Records const records = arx("studies/data/sales.csv", "lead", "sales", 2);
    for (CompareOptions options : {CompareOptions{.forgetting = 0.98, .arithmetics = {"float"}},
                                   {.variants = {"qr"}, .arithmetics = {"double"}},
                                   {.p0 = 1e7, .variants = {"kalman"}, .arithmetics = {"double"}}}) {
        options.timings = false;
        Comparison const c = compare::compare(records, options);
        ASSERT_NE(coded(c), nullptr);
        EXPECT_TRUE(learnt_by(code(c, "board"), records, "board") == learnt_by_the_catalogues(c, records))
            << code(c, "board");
    }
}

/// Numbers that float does not hold squared are scaled in the code.
TEST(ScaledCode, LearnsTheSameBits) {
    Records records{.psi = Matrix<double>(2, 200), .y = Vector<double>(200), .names = {"p0", "p1"}};
    Seed seed{406};
    for (Index k = 0; k < records.rows(); ++k) {
        double const u = seed.bell(), v = seed.bell();
        records.psi.col(k) << std::ldexp(u, 70), v;
        records.y[k] = std::ldexp(u + 2 * v + 0.05 * seed.bell(), 70);
    }
    DigitsAnswer const answer = digits_answer(records, {.arithmetics = {"float"}, .digits = 0.5});
    ASSERT_TRUE(answer.chosen() && !answer.chosen()->exponents.empty());
    ASSERT_TRUE(answer.guard && answer.guard->same_bits);
    std::string const expected =
        learnt_by_the_catalogues(answer.chosen()->comparison, records,
                                 {.variant = std::string(answer.choice()->result->entry->variant),
                                  .arithmetic = "float",
                                  .exponents = answer.chosen()->exponents,
                                  .output_exponent = answer.chosen()->output_exponent});
    for (char const* word : {"board", "c"})
        EXPECT_TRUE(learnt_by(code(answer, word), records, word) == expected) << code(answer, word);
    EXPECT_NE(code(answer, "python").find("psi * scale, y * "), std::string::npos);
}

class ComposedCode : public testing::TestWithParam<Composition> {};
TEST_P(ComposedCode, CompilesAndLearnsTheSameBits) {
    expect_the_code_to_learn_the_same(
        arx("studies/data/sales.csv", "lead", "sales", 2),
        {.forgetting = 0.96875, .variants = {"ud"}, .arithmetics = {"float"}, .composition = GetParam()});
}
INSTANTIATE_TEST_SUITE_P(
    Compositions, ComposedCode,
    testing::Values(Composition{.window = 60, .guard = "reset"},
                    Composition{.control = "kulhavy", .parameters = {0.97, 0}},
                    Composition{.control = "random_walk", .parameters = {1e-4}, .guard = "rebuild"}),
    [](auto const& one) { return one.param.control + std::to_string(one.param.window) + one.param.guard; });

struct Source {
    char const *file, *input, *output;
    int order;
};
class Code : public testing::TestWithParam<Source> {};
TEST_P(Code, OfARealRecordCompilesAndLearnsTheSameBits) {
    auto const& [file, input, output, order] = GetParam();
    if (!fs::exists(fs::path(RLSLAB_SOURCE_DIR) / file)) GTEST_SKIP() << "left out: " << file << " is not here";
    expect_the_code_to_learn_the_same(arx(file, input, output, order),
                                      {.forgetting = 0.98, .arithmetics = {"float", "double"}});
}
INSTANTIATE_TEST_SUITE_P(Records, Code,
                         testing::Values(Source{"studies/data/sales.csv", "lead", "sales", 2},
                                         Source{"../shared/data/gas_furnace.csv", "u", "y", 4},
                                         Source{"../shared/data/hair_dryer.csv", "u", "y", 4},
                                         Source{"../shared/data/heat_exchanger.csv", "u", "y", 4}),
                         [](auto const& source) { return fs::path(source.param.file).stem().string(); });

TEST(Code, OfManyParametersAGivenPriorAndAFactorOfTheInformation) {
    expect_the_code_to_learn_the_same(
        arx("studies/data/sales.csv", "lead", "sales", 9, true),
        {.p0 = 1e7, .variants = {"qr"}, .arithmetics = {"double"}});  // 20: of dynamic size
}
TEST(Code, OfAWholeNumberThatFloatDoesNotHold) {
    expect_the_code_to_learn_the_same(arx("studies/data/sales.csv", "lead", "sales", 1),
                                      {.p0 = 16777217, .variants = {"carlson"}, .arithmetics = {"float"}});
}

/// Names that would end a comment, or go on with it, do not.
TEST(Code, SurvivesAnyNameOfAColumn) {
    Records const records = arx("studies/data/sales.csv", "lead", "sales", 1);
    Comparison c = compare::compare(records, {.arithmetics = {"float"}, .timings = false});
    c.model.output = printable("x\\\n*/ \n #error");
    c.model.regressors = {printable("a\\"), printable("b\n#error \\"),
                          printable("?"
                                    "?/")};
    c.names = c.model.regressors;
    c.model.means = {{"m\\", 0.1}, {"n\\", -2}};
    EXPECT_EQ(learnt_by(code(c), records), learnt_by_the_catalogues(c, records));
}

TEST(Code, NamesTheClassOfEveryVariantThatThereIs) {
    for_each(Variants<double>{}, []<class F>() {
        int status = 0;
        char* const name = abi::__cxa_demangle(typeid(F).name(), nullptr, nullptr, &status);
        EXPECT_EQ(std::string(name).substr(0, std::string(name).find('<')), "rlslab::" + class_of(F::name));
        std::free(name);
    });
}

/// The first lines a person sees, whole.
TEST(Code, TheModelStandsAboveTheFilter) {
    Comparison c{};
    c.rows = 10, c.size = 3, c.names = {"a1", "b0", "1"};
    c.options.forgetting = 0.98;
    c.options.p0 = 4;
    c.model = {"f.csv", "y[k]", {"-y[k-1]", "u[k]", "1"}, {{"u", 0.5}, {"y", -2.25}}};
    static Arithmetic const single{"float", 24, -126, 127, false, nullptr};
    static CatalogueEntry const entry{"inverse_qr", &single, false, 1, "covariance", false, Family{}, nullptr, nullptr};
    Result r{.entry = &entry};
    r.spread = PerMeasure<Spread>{{5, 6, 7}, {4, 5, 6}, {5, 6, 7}};
    r.operations = 10;
    c.results = {r};
    c.recommendations = {{"float", "inverse_qr", ""}};
    EXPECT_EQ(code(c),
              "#include <rlslab/variants/inverse_qr.hpp>\n\n"
              "// y[k] = psi'theta,  psi = (-y[k-1], u[k], 1)\n"
              "// theta = (a1, b0, 1)\n"
              "// the columns as the filter takes them: (u less 0.5, y less -2.25)\n"
              "rlslab::InverseQr<float, 3> filter({.size = 3, .forgetting = 0.98, .prior = "
              "rlslab::Prior<float>{.variance = 4.0}});\n"
              "// a row: step = filter.update(psi, y); use theta() if step.health is sound\n");
    EXPECT_EQ(verdict(c),
              "in float  use inverse_qr  keeps 6.0 digits of theta (5.0 to 7.0), 5.0 of its worst component, 6.0 of P; "
              "10 operations\n");
}

}  // namespace
}  // namespace rlslab
