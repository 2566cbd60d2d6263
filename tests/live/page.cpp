// The live page's side of C++, without a browser: the bits it shows are the library's, its measurements are right, and
// nothing that a page can send breaks it.
#include "docs/site/live/page.hpp"
#include "docs/site/live/running.hpp"
#include "docs/site/live/source.hpp"
#include "tests/common/laws.hpp"
#include "tests/common/same.hpp"

#include <rlslab/arithmetic/format.hpp>
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/reference/certified.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <map>

namespace rlslab::live {
namespace {

using testing::HasSubstr;
constexpr std::uint32_t all = ~0u;

int start(std::map<std::string, double> const& chosen = {}, std::uint32_t variants = all) {
    for (int i = 0; i < live_settings(); ++i) {
        auto const it = chosen.find(live_setting_name(i));
        live_values()[i] = it != chosen.end() ? it->second : live_setting_range(i)[3];
    }
    return live_start(variants);
}
int rows(int n) {
    int taken = 0;
    for (int now = 1; now > 0 && taken < n; taken += now) now = live_advance(n - taken);
    return taken;
}
std::uint64_t hash(int v) {
    double const* const s = live_summary(v);
    return std::uint64_t(s[11]) << 32 | std::uint64_t(s[10]);
}
int read(std::string const& text) {
    std::memcpy(live_text(int(text.size())), text.data(), text.size());
    return live_read_table(int(text.size()));
}
int make(int output, std::vector<int> const& inputs, int past, int delays, int constant) {
    for (int const j : inputs) live_add_input(j);
    return live_make_rows(output, past, delays, constant);
}
int place_of(std::string_view name) {
    for (int v = 0; v < live_variants(); ++v)
        if (live_variant_name(v) == name) return v;
    ADD_FAILURE() << name;
    return 0;
}

/// Of theta after each of 300 rows, by the library alone.
template <class F>
std::uint64_t hash_without_the_page(Settings const& settings) {
    using T = typename F::scalar;
    Rows const none;
    Source source(settings, none);
    PrecisionScope const scope(format_of(settings));
    Seed seed{7};
    StochasticStream const stream(seed);
    F filter(problem_as<T>({.size = source.d(),
                            .forgetting = settings.forgetting,
                            .prior = Prior<double>{.variance = std::ldexp(1.0, int(settings.prior))}}));
    std::uint64_t out = 0xcbf29ce484222325;
    Vector<double> psi(source.d());
    for (int k = 0; k < 300; ++k) {
        double y;
        source.next(psi.data(), y);
        Vector<T> row(source.d());
        for (Index i = 0; i < row.size(); ++i) row[i] = T(psi[i]);
        filter.update(row, T(y));
        UncountedScope<T> const uncounted;
        for (T const& x : Vector<T>(filter.theta())) add_to(out, static_cast<double>(x));
    }
    return out;
}
TEST(LivePage, RunsTheLibraryBitForBit) {
    Settings at = starting_settings();
    for (double const bits : {2, 8, 16, 24, 53}) {
        at.bits = bits;
        ASSERT_EQ(start({{"bits", bits}}), 5);
        ASSERT_EQ(rows(300), 300);
        EXPECT_EQ(hash(place_of("ud")), hash_without_the_page<Ud<VariablePrecision>>(at)) << bits;
        EXPECT_EQ(hash(place_of("ud_delta")), hash_without_the_page<UdDelta<VariablePrecision>>(at)) << bits;
        EXPECT_EQ(hash(place_of("conventional")), hash_without_the_page<Conventional<VariablePrecision>>(at)) << bits;
    }
    at.bits = 11, at.exponents = 8, at.rounding = 2;
    ASSERT_EQ(start({{"bits", 11}, {"exponents", 8}, {"rounding", 2}}), 5);
    rows(300);
    EXPECT_EQ(hash(place_of("ud")), hash_without_the_page<Ud<VariablePrecision>>(at));
}
/// All variants' hashes together; `./lab live --check` compares each with the browser's.
TEST(LivePage, LeavesTheRecordedBits) {
    auto const together = [](std::map<std::string, double> const& chosen) {
        start(chosen);
        rows(300);
        std::uint64_t out = 0;
        for (int v = 0; v < live_variants(); ++v) out = out * 31 + hash(v);
        return out;
    };
    EXPECT_EQ(together({}), 12962344100612257771u);
    EXPECT_EQ(together({{"bits", 53}, {"parameters", 8}, {"condition", 4}, {"units", 1}}), 12290396706428834516u);
    EXPECT_EQ(together({{"bits", 8}, {"exponents", 8}, {"rounding", 2}, {"gain_error", -12}}), 6156009072217877236u);
    EXPECT_EQ(together({{"guard", 1}, {"outlier", 1}, {"silent", 1}, {"change", 1}}), 8174236258622160469u);
}
TEST(LivePage, DoesNotDependOnHowRowsAreAskedForOrOnTheOthers) {
    start();
    rows(300);
    std::uint64_t const whole = hash(place_of("ud"));
    start({}, 1u << place_of("ud"));
    for (int k = 0; k < 300; ++k) ASSERT_EQ(live_advance(1), 1);
    EXPECT_EQ(hash(place_of("ud")), whole);
    EXPECT_EQ(live_summary(place_of("qr"))[1], 0) << "does not run";
}
TEST(LivePage, TellsTheFirstIndefiniteRowAndThatItIsReportedLater) {
    start();
    rows(300);
    double const* s = live_summary(place_of("conventional"));
    EXPECT_GT(s[3], 0);
    EXPECT_GE(s[4], s[3]);
    EXPECT_EQ(live_summary(place_of("ud"))[3], 0);
}
TEST(LivePage, AnErrorInTheGainReachesWhatTakesIt) {
    start({{"bits", 53}});
    rows(300);
    std::map<int, std::uint64_t> without;
    for (int v = 0; v < live_variants(); ++v) without[v] = hash(v);
    start({{"bits", 53}, {"gain_error", -20}});
    rows(300);
    for (int v = 0; v < live_variants(); ++v)
        EXPECT_EQ(hash(v) != without[v], live_gain_error_applies(v) != 0) << live_variant_name(v);
}
TEST(LivePage, TheGuardSeesWhatIsSwitchedOn) {
    start({{"bits", 53}, {"guard", 1}, {"outlier", 1}, {"lambda", 1}});
    rows(300);
    double const* s = live_summary(place_of("ud"));
    EXPECT_EQ(s[6], 1) << "outliers";
    EXPECT_EQ(s[9], 0) << "breakdowns";
}

/// Where nothing breaks down the two guards do the same; after a breakdown one processes the last rows again.
TEST(LivePage, GuardsDifferFromABreakdownOn) {
    std::map<int, std::uint64_t> of[2];
    int broke = 0;
    for (int guard : {1, 2}) {
        start({{"guard", guard}});
        rows(300);
        for (int v = 0; v < live_variants(); ++v) of[guard - 1][v] = hash(v);
    }
    for (int v = 0; v < live_variants(); ++v) {
        bool const breaks = live_summary(v)[9] > 0;
        broke += breaks;
        EXPECT_EQ(of[0][v] != of[1][v], breaks) << live_variant_name(v);
    }
    EXPECT_GT(broke, 0);
    EXPECT_LT(broke, live_variants());
    ASSERT_EQ(live_guards(), 2);
    EXPECT_STREQ(live_guard_text(0, 0), "reset");
    EXPECT_STREQ(live_guard_text(1, 0), "rebuild");
    EXPECT_STREQ(live_guard_text(1, 1), "rebuilding");
    for (GuardPolicy const& policy : {guards[0].policy, guards[1].policy})
        EXPECT_EQ(policy.outlier, Action::skip) << "the reference skips the outlier, too";
}

// --- measurements ---------------------------------------------------------------------------------------------------

TEST(LivePage, TheReferenceHasTheDigitsOfTheCertifiedAnswer) {
    ASSERT_EQ(start({{"bits", 53}, {"condition", 3}}, 0), 5);
    rows(200);
    Settings at = starting_settings();
    at.bits = 53, at.condition = 3;
    Source source(at, Rows{});
    Records data{Matrix<double>(5, 200), Vector<double>(200), {}};
    for (int k = 0; k < 200; ++k) source.next(data.psi.col(k).data(), data.y[k]);
    auto const exact = certified({.size = 5, .forgetting = at.forgetting}, data, {200}).front();
    double const* const theta = live_theta(live_variants());
    Vector<Reference> found(5);
    for (int i = 0; i < 5; ++i) found[i] = Reference(theta[i]) + Reference(theta[5 + i]);
    EXPECT_GT(exact.theta_digits(found), 25);  // 31 less those of the condition, squared
}
TEST(LivePage, EigenvaluesAreThoseOfAKnownMatrix) {
    // Q diag(l) Q' with a reflection Q, over 40 decades: small ones keep their digits.
    int const d = 4;
    double const l[] = {1e20, 3, 1e-5, 1e-20}, v[] = {1, 2, 3, 4};
    Square A{};
    for (int i = 0; i < d; ++i)
        for (int j = 0; j < d; ++j)
            for (int k = 0; k < d; ++k) {
                auto const q = [&](int a) { return Pair(a == k ? 1 : 0) - Pair(2 * v[a] * v[k]) / Pair(30); };
                A[size_t(i)][size_t(j)] += q(i) * Pair(l[k]) * q(j);
            }
    auto const found = eigenvalues(A, d);
    EXPECT_NEAR(found[0] / l[0], 1, 1e-15);
    EXPECT_NEAR(found[1] / l[1], 1, 1e-10);
    EXPECT_NEAR(found[2] / l[2], 1, 1e-5) << "106 bits below the largest";
    A[0][0] = Pair(std::numeric_limits<double>::quiet_NaN());
    EXPECT_NE(eigenvalues(A, d)[0], eigenvalues(A, d)[0]);
}
TEST(LivePage, ATinyNegativePivotIsIndefinite) {
    using S = Stored<double>;
    Matrix<double> P = Matrix<double>::Ones(2, 2);
    P(1, 1) = 1 + 1e-15;
    EXPECT_TRUE(is_definite(S{S::Quantity::covariance, S::Form::plain, P}));
    P(1, 1) = 1 - 1e-15;
    EXPECT_FALSE(is_definite(S{S::Quantity::covariance, S::Form::plain, P}));
    EXPECT_FALSE(is_definite(S{S::Quantity::covariance, S::Form::factor, P, Vector<double>::Zero(2)}));
}
TEST(LivePage, PowersOfTwoAreRight) {
    for (double x = -40; x <= 0; x += 0.37) EXPECT_NEAR(power_of_two(x) / std::exp2(x), 1, 1e-13) << x;
    EXPECT_EQ(power_of_two(-3), 0.125);
}

// --- hostile settings and files -------------------------------------------------------------------------------------

TEST(LivePage, RunsAtTheEndsOfEverySetting) {
    for (int i = 0; i < live_settings(); ++i)
        for (int end : {0, 1}) {
            std::string const name = live_setting_name(i);
            if (name == "table") continue;
            double const at = live_setting_range(i)[end];
            // few exponents hold no large P0, and another rounding takes a range
            ASSERT_GT(start({{"bits", 11}, {"exponents", 8}, {"prior", 6}, {name, at}}), 0)
                << name << ' ' << at << ": " << live_message();
            EXPECT_EQ(rows(60), 60);
        }
}
TEST(LivePage, RefusesWhatNoSliderSends) {
    double const nan = std::numeric_limits<double>::quiet_NaN();
    for (auto const& bad : std::vector<std::map<std::string, double>>{{{"bits", 1}},
                                                                      {{"bits", 54}},
                                                                      {{"bits", nan}},
                                                                      {{"parameters", 9}},
                                                                      {{"lambda", 0}},
                                                                      {{"rows", 1e9}},
                                                                      {{"guard", 3}},
                                                                      {{"bits", 53}, {"exponents", 8}},
                                                                      {{"rounding", 2}},
                                                                      {{"exponents", 4}, {"prior", 30}}}) {
        EXPECT_EQ(start(bad), -1) << bad.begin()->first;
        EXPECT_THAT(live_message(), HasSubstr("expected"));
        EXPECT_EQ(live_advance(10), 0);
    }
    read("");
    EXPECT_EQ(start({{"table", 1}}), -1);
}
TEST(LivePage, ReadsTables) {
    ASSERT_EQ(read("\xef\xbb\xbf# a remark\r\nu;\"the; y\";w\r\n1,5;2;x\r\n\r\n?;3;x\r\n-2,5e1;4;x\r\n"), 3);
    EXPECT_EQ(live_table_rows(), 3);
    EXPECT_STREQ(live_column_name(1), "the; y");
    EXPECT_EQ(live_column_missing(0), 1);
    EXPECT_EQ(live_column_missing(2), -1) << "not numbers";
    ASSERT_EQ(make(1, {0}, 0, 0, 1), 2) << live_message();
    EXPECT_EQ(live_rows_made(), 2);
    EXPECT_EQ(live_rows_skipped(), 1);
    EXPECT_STREQ(live_regressor_name(0), "u");
    EXPECT_EQ(live_made_row(1)[0] * live_scale(0), -25);
    EXPECT_EQ(live_made_row(1)[2] * live_scale(2), 4);
    ASSERT_EQ(start({{"table", 1}}), 2);
    EXPECT_EQ(rows(10), 2) << "a table ends";
    EXPECT_EQ(make(1, {2}, 0, 0, 0), -1);
    EXPECT_THAT(live_message(), HasSubstr("line 3, column w: expected a number"));
    ASSERT_EQ(read("1 2\n3   4\n 5 6 \n7 9\n"), 2);
    EXPECT_STREQ(live_column_name(0), "1");
    EXPECT_EQ(live_table_rows(), 4);
    ASSERT_EQ(make(1, {0}, 1, 1, 0), 3) << live_message();
    EXPECT_STREQ(live_regressor_name(0), "2[k-1]");
}
TEST(LivePage, TablesThatAreNoneAreRefusedInALine) {
    std::map<std::string, std::string> const said{
        {"", "found no row"},         {"\n\n#x\n", "found no row"},
        {"a,b\n", "found none"},      {"a,b\n1,2\n1\n", "line 3: expected 2 cells, found 1"},
        {"\"a,b\n1,2", "found none"}, {std::string("\0\0", 2), "found none"},
    };
    for (auto const& [text, expected] : said) {
        EXPECT_EQ(read(text), -1) << text;
        EXPECT_THAT(live_message(), HasSubstr(expected)) << text;
        EXPECT_EQ(make(0, {}, 0, 0, 1), -1);
    }
}
TEST(LivePage, OddColumnsDoNoHarm) {
    ASSERT_EQ(read("y\n1\n2\n4\n"), 1) << "one column";
    EXPECT_EQ(make(0, {}, 1, 0, 0), 1);
    EXPECT_EQ(make(0, {}, 0, 0, 0), -1) << "no parameter";
    EXPECT_EQ(make(7, {}, 0, 0, 1), -1) << "no such column";
    EXPECT_EQ(make(0, {9}, 0, 0, 1), -1);
    EXPECT_EQ(make(0, {}, 20, 0, 0), -1) << "too many parameters";
    ASSERT_EQ(read("u,y\nNaN,1\nNaN,2\n"), 2) << "a column without a number";
    EXPECT_EQ(make(1, {0}, 0, 0, 0), -1);
    EXPECT_THAT(live_message(), HasSubstr("expected at least 1 row without a missing value, found 0"));
    ASSERT_EQ(read("u,y\n1e150,1e-150\n-1e150,3e-150\n2e150,0\n"), 2) << "huge and tiny numbers are scaled";
    ASSERT_EQ(make(1, {0}, 0, 0, 0), 1);
    ASSERT_EQ(start({{"table", 1}, {"bits", 24}}), 1);
    EXPECT_EQ(rows(9), 3);
    EXPECT_GT(live_summary(place_of("ud"))[1], 5);
    ASSERT_EQ(read("u,y\n1e200,1\n2,2\n"), 2) << "beyond what can be squared";
    EXPECT_EQ(live_column_missing(0), -1);
    ASSERT_EQ(read("u,y\n0,0\n0,0\n"), 2) << "zeros";
    ASSERT_EQ(make(1, {0}, 0, 0, 1), 2);
    ASSERT_EQ(start({{"table", 1}}), 2);
    EXPECT_EQ(rows(9), 2);
}
TEST(LivePage, AWideTableHasAllItsColumns) {
    std::string names = "c0", row = "0";
    for (int j = 1; j < 70; ++j) names += ",c" + std::to_string(j), row += "," + std::to_string(j);
    ASSERT_EQ(read(names + "\n" + row + "\n" + row + "\n" + row + "\n"), 70);
    ASSERT_EQ(make(0, {64, 33}, 0, 0, 0), 2) << live_message();
    EXPECT_STREQ(live_regressor_name(0), "c64");
    EXPECT_EQ(live_made_row(2)[1] * live_scale(1), 33);
    EXPECT_EQ(make(0, {}, 0, 0, 1), 1) << "inputs are those added since";
}
TEST(LivePage, ALongTableIsCut) {
    std::string text = "y\n";
    for (long k = 0; k < most_rows + 10; ++k) text += std::to_string(k % 17) + "\n";
    ASSERT_EQ(read(text), 1);
    EXPECT_EQ(live_table_rows(), most_rows);
}

}  // namespace
}  // namespace rlslab::live

// --- its own fused multiply-add has the bits of std::fma -------------------------------------------------------------

extern "C" {
double __real_fma(double x, double y, double z) { return std::fma(x, y, z); }  // what the linker puts there
double __wrap_fma(double x, double y, double z);
}

namespace rlslab::live {
namespace {

bool same(double x, double y, double z) { return rlslab::same(__wrap_fma(x, y, z), std::fma(x, y, z)); }
TEST(LiveFma, HasTheBitsOfTheTailsThatTheLibraryAsksFor) {
    Seed seed{1};
    for (int i = 0; i < 200'000; ++i) {
        double const x = std::ldexp(seed.bell(), int(seed.next() % 900) - 450),
                     y = std::ldexp(seed.bell(), int(seed.next() % 900) - 450), p = x * y;
        ASSERT_TRUE(same(x, y, -p)) << x << ' ' << y;
        ASSERT_TRUE(same(x, y, -p * (0.4 + 2 * seed.uniform()))) << x << ' ' << y;
        ASSERT_TRUE(same(x, y, std::nextafter(-p, 0))) << x << ' ' << y;
        double const root = std::sqrt(std::fabs(x));
        ASSERT_TRUE(same(-root, root, std::fabs(x))) << x;
    }
}
TEST(LiveFma, HasTheBitsOfEverythingElse) {
    double const numbers[] = {
        0.0,     -0.0,     1,        -1,      0x1p-1074, -0x1p-1022, 0x1p1023, 0x1.fffffffffffffp0,
        0x1p400, 0x1p-400, 0x1p-500, 0x1p511, INFINITY,  -INFINITY,  NAN,      3};
    for (double const x : numbers)
        for (double const y : numbers)
            for (double const z : numbers) EXPECT_TRUE(same(x, y, z)) << x << ' ' << y << ' ' << z;
}

}  // namespace
}  // namespace rlslab::live
