// The rlslab program as a person or a script uses it: what it prints, where, and with which exit code. Every result
// says which run it is from; rlslab cite.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/studies/journal.hpp>
#include "src/lab/program/bibliography.hpp"
#include "src/lab/report/json.hpp"
#include "tests/common/program.hpp"

#include <nlohmann/json.hpp>

#include <regex>
#include <set>
#include <sys/resource.h>
#include <unistd.h>

namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST_F(Program, RefusesAFolderThatAnotherRunIsWriting) {
    fs::create_directory(folder / "busy");
    rlslab::studies::FolderLock const other(folder / "busy");
    refused("study gain_error --out busy", "busy");
    EXPECT_FALSE(fs::exists(folder / "busy" / "gain_error.csv"));
}
TEST_F(Program, ReadsStandardInput) {
    std::string const options = " --input u --output y --order 1 --arithmetic double";
    Outcome run = shell("printf \"u,y\\n1,2\" | rlslab compare -" + options);
    EXPECT_EQ(run.code, 2);
    EXPECT_EQ(run.err, "rlslab: standard input: 3 parameters need at least 3 rows, found 1\n");
    run = shell("rlslab compare - < ok.csv" + options);
    EXPECT_EQ(run.code, 0) << run.err;
}
TEST_F(Program, RefusesALineOfTwoGigabytesAtOnceAndInLittleMemory) {
    Outcome const run =
        shell("head -c 2000000000 /dev/zero | tr \"\\0\" 1 | rlslab compare - --input u --output y --order 1");
    EXPECT_EQ(run.code, 2);
    EXPECT_EQ(run.err, "rlslab: standard input:1: expected a line of at most 1 MiB\n");
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    EXPECT_LT(usage.ru_maxrss, 500 * 1024) << "kB, sanitizers included";
}
TEST_F(Program, AListDoesNotSwallowTheFileBehindIt) {
    Outcome const run =
        shell("rlslab compare --output y --variants ud,qr --arithmetic double --regressors u ok.csv --csv");
    EXPECT_EQ(run.code, 0) << run.err;
    std::string const table = without_run(run.out);
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3) << run.out;
}
TEST_F(Program, JsonHasTheKeysThatAreDocumented) {
    Outcome const run = shell("rlslab compare '" + root +
                              "/studies/data/sales.csv' --input lead --output sales --order 2 --json --all");
    ASSERT_EQ(run.code, 0) << run.err;
    json const out = json::parse(run.out);
    EXPECT_EQ(out["data"]["rows"], 148);
    EXPECT_EQ(out["data"]["size"], 5);
    EXPECT_LE(out["reference"]["radius"].get<double>(), 1e-30);
    EXPECT_GT(out["reference"]["bits"].get<int>(), 100);
    for (char const* key : {"condition", "prior_bias"}) EXPECT_TRUE(out["reference"][key].is_number_float()) << key;
    ASSERT_EQ(out["reference"]["theta"].size(), 5u);
    for (std::string const theta : out["reference"]["theta"]) {
        std::string const digits = theta.substr(0, theta.find('e'));
        EXPECT_EQ(std::count_if(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c); }), 30)
            << theta;
    }
    ASSERT_EQ(out["results"].size(), rlslab::catalogue().size());
    for (json const& r : out["results"]) {
        // the keys named below, variant, arithmetic, spread, path, runs, broken, other_orders, foretold, predicted
        EXPECT_EQ(r.size(), 16u);
        EXPECT_EQ(r["other_orders"]["runs"], 3);
        for (auto const& [of, at_the_end] : {std::pair{"theta", "theta_digits"},
                                             {"worst", "theta_digits_worst"},
                                             {"covariance", "covariance_digits"}}) {
            EXPECT_EQ(r["path"][of].size(), out["checkpoints"].size());
            EXPECT_EQ(r["path"][of].back(), r[at_the_end]);
        }
        for (char const* key :
             {"theta_digits", "theta_digits_worst", "covariance_digits", "asymmetry", "operations", "ns_per_update"})
            EXPECT_TRUE(r.at(key).is_number() || r.at(key).is_null()) << key;
        EXPECT_TRUE(r["breakdown"].is_null() ||
                    (r["breakdown"]["step"].is_number_integer() &&
                     std::set<std::string>{"indefinite", "nonfinite"}.contains(r["breakdown"]["kind"])));
    }
    ASSERT_EQ(out["recommendation"].size(), rlslab::arithmetics().size());
    for (json const& r : out["recommendation"]) {
        EXPECT_TRUE(r["variant"].is_string() || r["variant"].is_null());
        EXPECT_FALSE(r["why"].get<std::string>().empty());
    }
}
TEST_F(Program, CsvAndJsonAgreeAndTablesArePlainInAPipe) {
    std::string const command = "rlslab compare ok.csv --input u --output y --order 1 --no-timings --all";
    json const results = json::parse(shell(command + " --json").out)["results"];
    std::istringstream csv(without_run(shell(command + " --csv").out));
    std::string line;
    std::getline(csv, line);
    EXPECT_EQ(line,
              "variant,arithmetic,theta_digits,theta_digits_worst,covariance_digits,breakdown_step,breakdown_kind,"
              "foretold_step,asymmetry,operations,ns_per_update,runs,broken,theta_low,theta_median,theta_high,"
              "worst_low,worst_median,worst_high,"
              "covariance_low,covariance_median,covariance_high,other_orders,other_broken,other_theta_low,"
              "other_theta_median,other_theta_high,other_worst_low,other_worst_median,other_worst_high,"
              "other_covariance_low,other_covariance_median,other_covariance_high,predicted_covariance,"
              "predicted_at_least");
    for (json const& r : results) {
        ASSERT_TRUE(std::getline(csv, line));
        std::string const digits = r["theta_digits"].is_null() ? "" : r["theta_digits"].dump();
        EXPECT_TRUE(line.starts_with(r["variant"].get<std::string>() + "," + r["arithmetic"].get<std::string>() + "," +
                                     digits + ","))
            << line;
    }
    EXPECT_FALSE(std::getline(csv, line));
    Outcome const table = shell(command);
    EXPECT_THAT(table.out, Not(HasSubstr("\033")));
    EXPECT_THAT(table.out, testing::ContainsRegex("\nin double +use [a-z_]+ +keeps "));
    EXPECT_EQ(table.err, "");
}
TEST_F(Program, TheSameBytesForAnyNumberOfThreadsAndOnEveryRun) {
    for (std::string const file : {"studies/data/sales.csv --input lead --output sales --order 2 --forgetting 0.99",
                                   "../shared/data/gas_furnace.csv --input u --output y --order 4"}) {
        if (!fs::exists(root + "/" + file.substr(0, file.find(' ')))) {
            std::printf("left out: %s is not here\n", file.c_str());
            continue;
        }
        std::string const command = "cd '" + root + "'; rlslab compare " + file + " --no-timings --json --threads ";
        std::string const one = shell(command + "1").out;
        EXPECT_GT(one.size(), 10000u);
        EXPECT_EQ(one, shell(command + "2").out) << file;
        EXPECT_EQ(one, shell(command + "2").out) << file;
    }
}
TEST(ReportJson, HasAValueForEachNameOrForNone) {
    EXPECT_EQ(rlslab::report::object("a b", {1, "x"}).dump(), R"({"a":1,"b":"x"})");
    EXPECT_EQ(rlslab::report::object("a b", {}).dump(), R"({"a":null,"b":null})");
    EXPECT_THROW(rlslab::report::object("a b", {1}), std::invalid_argument);
    EXPECT_THROW(rlslab::report::object("a", {1, 2}), std::invalid_argument);
}
TEST_F(Program, ListsWhatThereIsAndHelps) {
    json const list = json::parse(shell("rlslab list --json").out);
    std::set<std::string_view> variants;  // not by one_entry_each, which the list is made of
    for (rlslab::CatalogueEntry const& entry : rlslab::catalogue()) variants.insert(entry.variant);
    EXPECT_EQ(list["variants"].size(), variants.size());
    EXPECT_EQ(list["arithmetics"].size(), rlslab::arithmetics().size());
    EXPECT_TRUE(list["studies"].is_array());
    std::string const text = shell("rlslab list").out;
    for (char const* kind : {"variants", "arithmetics"})
        for (json const& item : list[kind]) EXPECT_THAT(text, HasSubstr(item["name"].get<std::string>()));
    std::string parts;
    for (std::string const part : {"variants", "arithmetics", "rounding", "studies"}) {
        parts += (parts.empty() ? "" : "\n") + shell("rlslab list " + part).out;
        json const alone = json::parse(shell("rlslab list --json " + part).out);
        ASSERT_EQ(alone.size(), 2u) << part << ", and the run";
        for (auto const& [key, value] : alone.items())
            EXPECT_TRUE(key == "run" || value == list[key]) << part << ' ' << key;
    }
    EXPECT_EQ(parts, text);
    for (char const* command : {"rlslab --help", "rlslab compare --help", "rlslab list --help", "rlslab --version"})
        EXPECT_EQ(shell(command).code, 0) << command;
}

// --- which run it is from --------------------------------------------------------------------------------------------

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
    std::string const page = flat(read(root + "/docs/literature.md"));
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
