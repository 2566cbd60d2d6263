// Every result says which run it is from; rlslab cite.
#include "src/lab/program/bibliography.hpp"
#include "tests/common/program.hpp"

#include <rlslab/catalogue/catalogue.hpp>

#include <nlohmann/json.hpp>

#include <fstream>
#include <regex>
#include <set>

namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string const data = std::string(RLSLAB_SOURCE_DIR) + "/studies/data/sales.csv";
/// sha256sum studies/data/sales.csv
constexpr char const* digest = "a7c0bca5c98e0bd8118af18dc1d6a110b1d7f2d0877c985a669b5e59f7f1ab57";

TEST_F(Program, SaysTheRunInEveryAnswer) {
    for (std::string const& command :
         {"compare " + data + " --input lead --output sales --order 1",
          "identify " + data + " --input lead --output sales --order 1", "excitation " + data + " --input lead"}) {
        json const run = json::parse(shell("rlslab " + command + " --json --quiet").out).at("run");
        EXPECT_EQ(run.at("command"), "rlslab " + command);  // not the words that change no byte
        EXPECT_EQ(run.at("file"), data);
        EXPECT_EQ(run.at("sha256"), digest);
        EXPECT_EQ(run.at("rows"), 150);
        EXPECT_FALSE(run.at("revision").get<std::string>().empty());
        EXPECT_THAT(run.at("compiler"), HasSubstr("-ffp-contract=off"));
        EXPECT_TRUE(run.contains("instruction_set"));
        EXPECT_THAT(run.at("date"), testing::MatchesRegex("20..-..-..T..:..:..Z"));
        json const undated = json::parse(shell("rlslab " + command + " --json --no-timings").out).at("run");
        EXPECT_FALSE(undated.contains("date") || undated.contains("instruction_set"));
    }
}
TEST_F(Program, SaysTheRunInFiles) {
    std::string const options = data + " --input lead --output sales --order 1 --no-timings --out made";
    ASSERT_EQ(shell("rlslab compare " + options).code, 0);
    EXPECT_THAT(read(folder / "made/compare.csv"), StartsWith("# command: rlslab compare "));
    EXPECT_THAT(read(folder / "made/compare.html"), HasSubstr(std::string("<code>") + digest));
    ASSERT_EQ(shell("rlslab identify " + options + " --window 50").code, 0);
    EXPECT_THAT(read(folder / "made/tracked.csv"), HasSubstr(std::string("# sha256: ") + digest));
    EXPECT_THAT(read(folder / "made/model.html"), HasSubstr(std::string("<code>") + digest));
    EXPECT_THAT(read(folder / "made/model.html"), Not(HasSubstr("date: ")));
}
TEST_F(Program, ItsOwnRecordsSayTheirRunAndAreRead) {
    write("made.csv", shell("rlslab simulate --samples 200 --b 1,2 --seed 3").out);
    EXPECT_THAT(read(folder / "made.csv"), StartsWith("# command: rlslab simulate --samples 200 --b 1,2 --seed 3\n"));
    EXPECT_EQ(shell("rlslab identify made.csv --input u --output y --order 1").code, 0);
}
TEST_F(Program, QuotesTheWordsOfItsCommandForAShell) {
    write("a b.csv", read(data));
    json const run = json::parse(shell("rlslab excitation 'a b.csv' --input \"lead\" --json").out).at("run");
    EXPECT_EQ(run.at("command"), "rlslab excitation 'a b.csv' --input lead");
}
TEST_F(Program, SaysItsVersionAsJson) {
    json const said = json::parse(shell("rlslab --version --json").out);
    for (char const* key : {"version", "revision", "compiler", "instruction_set"}) EXPECT_TRUE(said.contains(key));
    EXPECT_THAT(shell("rlslab --version").out, HasSubstr(said.at("version").get<std::string>()));
    std::string const revision = said.at("revision"), line = shell("rlslab --version").out;
    EXPECT_EQ(line.ends_with(" (" + revision + ")\n"), revision != "of no repository") << line;
}

TEST_F(Program, CitesItselfAndTheSourcesOfVariants) {
    std::string const alone = shell("rlslab cite").out, both = shell("rlslab cite ud potter").out;
    EXPECT_THAT(alone,
                testing::AllOf(StartsWith("@software{rlslab,"), HasSubstr("version   = {"), HasSubstr("revision ")));
    EXPECT_THAT(both, StartsWith(alone));
    size_t const first = both.find("@book{bierman1977,");
    ASSERT_NE(first, both.npos);
    EXPECT_EQ(both.find("@book{bierman1977,", first + 1), both.npos);  // of both, once
    EXPECT_THAT(both, HasSubstr("@misc{thornton1976,\n  author    = {Thornton, C. L.},\n"));
}
/// A variant has a source with authors and a title; a title is on the page that says what was read; keys differ.
TEST(Bibliography, HasASourceForEveryVariant) {
    auto const flat = [](std::string const& text) { return std::regex_replace(text, std::regex("\\s+"), " "); };
    std::ifstream file(RLSLAB_SOURCE_DIR "/docs/literature.md");
    std::string const page = flat({std::istreambuf_iterator<char>(file), {}});
    std::set<std::string> keys;
    for (auto const& source : rlslab::program::sources()) {
        std::smatch key, title;
        ASSERT_TRUE(std::regex_search(source.bibtex, key, std::regex("^@[a-z]+\\{([a-z0-9]+),\n")));
        EXPECT_TRUE(keys.insert(key[1]).second) << key[1];
        if (std::regex_search(source.bibtex, title, std::regex("  title     = \\{(.*)\\}"))) {
            EXPECT_NE(page.find(std::regex_replace(title[1].str(), std::regex("\\\\"), "")), page.npos) << title[1];
        }
    }
    for (rlslab::CatalogueEntry const* const v : rlslab::one_entry_each()) {
        auto const sources = rlslab::program::sources_of(v->variant);
        EXPECT_FALSE(sources.empty()) << v->variant;
        if (v->variant.ends_with("_delta")) {
            EXPECT_GE(sources.size(), 2u) << v->variant << ": of the form, and of the delta operator";
        }
        for (auto const* const source : sources)
            EXPECT_TRUE(std::regex_search(source->bibtex, std::regex("  author    = \\{[^}]+\\},\n  title     = ")))
                << source->bibtex;
    }
}

}  // namespace
