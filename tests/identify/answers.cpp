// The output of identify for a bad record or a variant that breaks down: words, never a NaN, and the matching exit
// code.
#include <rlslab/catalogue/catalogue.hpp>
#include "src/lab/identify/identify.hpp"
#include "tests/common/exact_fit.hpp"
#include "tests/common/files.hpp"

#include <rlslab/reference/scatter.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sys/wait.h>

namespace rlslab {
using namespace identify;
using namespace report;
namespace {

using testing::HasSubstr;
using testing::Not;

/// u, y of a lightly damped system, with so many decimals: a slow input makes neighbouring columns nearly equal.
std::string record(Signal const& u, double noise, int decimals, std::uint64_t seed = 7) {
    DifferenceEquation const model{.a = {-3.7712, 5.3970, -3.4742, 0.8492}, .b = {{0.001, 0.002}}, .delay = 0, .c = 0};
    Signal xi = white_noise(Index(u.size()), Seed{seed});
    for (double& x : xi) x *= noise;
    Signal const y = simulate(model, {u}, xi);
    std::string out = "u,y\n";
    for (size_t k = 0; k < u.size(); ++k) out += fmt::format("{:.{}f},{:.{}f}\n", u[k], decimals, y[k], decimals);
    return out;
}
Signal slow_input(Index n) {
    Signal u = coloured_noise(n, {-1.98, 0.9801}, Seed{5});
    return u;
}

/// Where a NaN or an infinity stands as a number.
std::vector<std::string> not_numbers(std::string text) {
    static std::regex const code("<(script|style)(?! type=\"application/json\")[^]*?</(script|style)>"),
        word("[^a-z_](nan|inf|infinity)[^a-z_]", std::regex::icase);
    text = std::regex_replace(text, code, " ");
    std::vector<std::string> out;
    for (std::sregex_iterator at(text.begin(), text.end(), word), end; at != end; ++at)
        out.push_back(text.substr(size_t(std::max<long>(0, at->position() - 60)), 120));
    return out;
}

std::vector<std::string> variants() {
    std::vector<std::string> out;
    for (CatalogueEntry const* const entry : one_entry_each()) out.emplace_back(entry->variant);  // each is in double
    return out;
}

void expect_numbers(Identified const& m, std::string const& what) {
    EXPECT_THAT(not_numbers(as_table(m)), testing::IsEmpty()) << what;
    EXPECT_THAT(not_numbers(as_json(m)), testing::IsEmpty()) << what;
    EXPECT_THAT(not_numbers(as_page(m)), testing::IsEmpty()) << what;
    EXPECT_TRUE(nlohmann::json::accept(as_json(m))) << what;
}

TEST(IdentifyAnswers, NoNumberIsMissingForAnIllConditionedRecord) {
    files::Folder const folder;
    std::string const file = folder.file(record(slow_input(1024), 0, 6));
    Identified const m = identify::identify(file, {.inputs = {"u"}, .output = "y", .order = 10});
    EXPECT_GT(m.condition, 1e8);
    ASSERT_EQ(m.parameters.size(), 22u);
    for (Parameter const& p : m.parameters) {
        EXPECT_GT(p.sd, 0) << p.name;
        EXPECT_LT(p.lower, p.upper) << p.name;
    }
    expect_numbers(m, "order 10");
    for (std::string const& warning : m.warnings())
        EXPECT_THAT(warning, Not(HasSubstr("--variant ud"))) << "it is in use";
}

/// The standard deviations of that record, by exact rationals: sigma^2 (Phi'Phi)^-1 without a prior.
TEST(IdentifyAnswers, IllConditionedStandardDeviationsAreThoseOfTheRationals) {
    files::Folder const folder;
    std::string const file = folder.file(record(slow_input(200), 0, 3));
    Columns const columns = read_columns(file, {"u", "y"});
    Records const records = arx_records(columns, "u", "y", arx_of_order(6));
    Index const d = records.parameters(), N = records.rows();
    exact_fit::Fit const exact = exact_fit::of(records);
    Scattered const s = scattered({.size = d, .prior = std::nullopt}, records, {N}).front();
    EXPECT_DOUBLE_EQ(s.scatter.J, static_cast<double>(exact.J));
    EXPECT_DOUBLE_EQ(s.scatter.freedom, double(N - d));
    for (Index i = 0; i < d; ++i)
        EXPECT_DOUBLE_EQ(s.scatter.sd[i], std::sqrt(static_cast<double>(exact.inverse(i, i)))) << i;
    EXPECT_GT(condition(records, 1), 1e4);
}

TEST(IdentifyAnswers, EveryVariantOnEveryRecordAnswersInNumbers) {
    files::Folder const folder;
    std::string const slow = folder.file(record(slow_input(200), 0, 4), "slow.csv"),
                      noisy = folder.file(record(prbs(7, 200), 0.01, 6), "noisy.csv"),
                      tiny = folder.file(
                          "u,y\n" +
                              [] {
                                  std::string out;
                                  Signal const u = white_noise(60, Seed{2}), e = white_noise(60, Seed{3});
                                  for (size_t k = 0; k < u.size(); ++k)
                                      out += fmt::format("{},{}\n", 1e-100 * u[k], 1e90 * (u[k] + e[k]));
                                  return out;
                              }(),
                          "tiny.csv");
    int broken = 0;
    for (std::string const& variant : variants())
        for (std::string const& file : {slow, noisy, tiny})
            for (double const lambda : {1.0, 0.9})
                for (std::optional<double> const& p0 :
                     {std::optional<double>(), std::optional<double>(lambda == 1 ? 0x1p80 : 0x1p40)}) {
                    IdentifyOptions options{.inputs = {"u"}, .output = "y", .order = file == tiny ? 1 : 3};
                    options.variant = variant, options.forgetting = lambda, options.p0 = p0;
                    std::string const what =
                        fmt::format("{} {} lambda {} p0 {}", variant, file, lambda, p0.value_or(0));
                    Identified const m = identify::identify(file, options);
                    expect_numbers(m, what);
                    broken += m.failure.has_value();
                    if (m.failure) {
                        EXPECT_THAT(m.warnings(), testing::Contains(Names(variant + " row"))) << what;
                        EXPECT_THAT(as_json(m), HasSubstr("\"breakdown\": {")) << what;
                    }
                    if (std::ranges::any_of(m.parameters, [](Parameter const& p) { return std::isnan(p.value); })) {
                        EXPECT_TRUE(m.failure) << what;
                        EXPECT_FALSE(m.ljung_box.white()) << what;
                        EXPECT_THAT(as_table(m), Not(HasSubstr("pass for white"))) << what;
                    }
                }
    EXPECT_GT(broken, 0) << "the trial shows nothing";
}

/// The program: its exit code says whether the variant can be believed.
TEST(IdentifyAnswers, AVariantThatBrokeDownExitsWithOneAndIsNamed) {
    files::Folder const folder;
    std::string const file = folder.file(record(slow_input(1024), 0, 6));
    auto const run = [&](std::string const& variant) {
        std::string const out = (folder.path / "out.txt").string();
        int const status =
            std::system(("'" RLSLAB_PROGRAM "' identify '" + file + "' --input u --output y --order 10 --variant " +
                         variant + " > '" + out + "' 2>&1")
                            .c_str());
        std::ifstream in(out);
        return std::pair(WEXITSTATUS(status), std::string(std::istreambuf_iterator<char>(in), {}));
    };
    auto const [bad, said] = run("conventional");
    EXPECT_EQ(bad, 1) << said;
    EXPECT_THAT(said, Names("conventional row 1"));
    EXPECT_THAT(not_numbers(said), testing::IsEmpty());
    EXPECT_EQ(run("ud").first, 0);
}

/// One warning for one cause, and the variant it names is one that does better, by trial.
TEST(IdentifyAnswers, AVariantThatIsRecommendedDoesBetter) {
    files::Folder const folder;
    std::string const file = folder.file(record(prbs(8, 250), 0.01, 6));
    int named = 0;
    for (std::string const& variant : variants()) {
        IdentifyOptions options{.inputs = {"u"}, .output = "y", .order = 4};
        options.variant = variant, options.p0 = 0x1p60;
        Identified const m = identify::identify(file, options);
        for (std::string const& warning : m.warnings())
            if (auto const at = warning.find("--variant "); at != warning.npos) {
                std::string const other = warning.substr(at + 10, warning.find_first_of(" :", at + 10) - at - 10);
                EXPECT_NE(other, variant);
                options.variant = other;
                Identified const better = identify::identify(file, options);
                EXPECT_FALSE(better.failure) << other;
                EXPECT_GT(better.digits, m.failure ? 0 : m.digits) << variant << " -> " << other;
                for (std::string const& again : better.warnings())
                    EXPECT_THAT(again, Not(HasSubstr("--variant"))) << other;
                ++named;
            }
    }
    EXPECT_GT(named, 0);
}

}  // namespace
}  // namespace rlslab
