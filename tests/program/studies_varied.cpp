// rlslab study with other factors, described, and found by paper and subject.
#include "tests/common/program.hpp"

#include <nlohmann/json.hpp>

#include <set>
#include <sstream>

namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// The rows of a study's table that hold the text, without the lines of provenance.
std::multiset<std::string> rows_with(std::string const& csv, std::string const& part) {
    std::multiset<std::string> out;
    std::istringstream lines(csv);
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with("#") && line.find(part) != line.npos) out.insert(line);
    return out;
}

TEST_F(Program, VariesTheFactorsOfAStudy) {
    ASSERT_EQ(shell("rlslab study gain_error --out own --quiet").code, 0);
    Outcome const varied = shell("rlslab study gain_error --set variant=ud,joseph --set lambda=0.98,0.95 --out mine");
    EXPECT_EQ(varied.code, 0);
    EXPECT_THAT(varied.out, HasSubstr("not judged: factors changed: variant = ud, joseph; lambda = 0.98, 0.95\n"));
    EXPECT_THAT(varied.out, Not(HasSubstr("Changed against")));
    std::string const own = read(folder / "own/gain_error.csv"), mine = read(folder / "mine/gain_error.csv");
    EXPECT_THAT(mine, HasSubstr("# command: rlslab study gain_error --budget quick --seed 1 --set "
                                "variant=ud,joseph --set lambda=0.98,0.95\n"));
    // What both have is the same bits; what is new is new.
    for (char const* both : {"0.98,ud,", "0.98,joseph,"}) {
        EXPECT_GT(rows_with(own, both).size(), 0u);
        EXPECT_EQ(rows_with(own, both), rows_with(mine, both));
    }
    EXPECT_GT(rows_with(mine, "0.95,ud,").size(), 0u);
    EXPECT_EQ(rows_with(mine, "conventional").size(), 0u);
    json const verdicts = json::parse(read(folder / "mine/verdicts.json")).at("studies").at(0);
    EXPECT_TRUE(verdicts.at("holds").is_null());
    int numbers = 0;
    for (json const& claim : verdicts.at("claims")) {
        EXPECT_EQ(claim.at("verdict"), "not judged: factors changed");
        numbers += !claim.at("measured").get<std::string>().starts_with("no number");
    }
    EXPECT_GT(numbers, 0);
    EXPECT_THAT(varied.out, HasSubstr("\n  not judged "));
    EXPECT_THAT(read(folder / "mine/report.html"), HasSubstr("<b>not judged</b>"));
}
TEST_F(Program, VariesInPartsWithTheSameBytes) {
    std::string const study = "rlslab study gain_error --set variant=ud,joseph --set lambda=0.9";
    ASSERT_EQ(shell(study + " --out whole --threads 1").code, 0);
    for (char const* part : {"1/2", "2/2"})
        ASSERT_EQ(shell(study + " --out part" + part[0] + " --part " + part).code, 0);
    ASSERT_EQ(shell("rlslab merge part1 part2 --out merged").code, 0);
    for (char const* file : {"gain_error.csv", "verdicts.json", "report.html"})
        EXPECT_EQ(read(folder / "merged" / file), read(folder / "whole" / file)) << file;
    refused("study slicot --out part1 --part 1/2", "holds parts of other studies");
}
TEST_F(Program, RefusesAnArithmeticThatAStudysFiltersDoNotHave) {
    for (char const* study : {"guard_signals", "guard_policies"})
        refused(std::string("study ") + study + " --set arithmetic=p11", "exist here in float and double, not in p11");
}
/// A record, and the verdicts of a folder.
TEST_F(Program, ComparesVerdictsWithAFile) {
    ASSERT_EQ(shell("rlslab study slicot --quiet --record own.json --out out").code, 0);
    for (std::string const file : {"own.json", "out/verdicts.json"}) {
        std::string const study = "rlslab study slicot --quiet --out again --against ";
        EXPECT_EQ(shell(study + file).code, 0) << file;
        std::string text = read(folder / file);
        for (size_t at = 0; (at = text.find("\"holds\"", at)) != text.npos; at += 7)
            if (text[at + 7] != ':') text.replace(at, 7, "\"fails\"");
        write("other.json", text);
        Outcome const changed = shell(study + "other.json");
        EXPECT_EQ(changed.code, 1) << file;
        EXPECT_THAT(changed.out, HasSubstr(": holds, fails in the record\n")) << file;
    }
    write("none.json", "{\"slicot\": {\"a claim\": \"perhaps\"}}");
    refused("study slicot --against none.json --out none", "--against: none.json: found \"perhaps\"");
    refused("study slicot --against /dev/zero --out none", "--against /dev/zero 16");
    EXPECT_FALSE(fs::exists(folder / "none"));
}
TEST_F(Program, NamesTheFullBudgetWhereFewSeedsLeaveClaimsUndecided) {
    Outcome const run = shell("rlslab study gain_error_size --out out");
    EXPECT_THAT(run.out, HasSubstr("rlslab study gain_error_size --budget full"));
}
TEST_F(Program, DescribesAStudy) {
    Outcome const said = shell("rlslab study slicot --describe");
    EXPECT_EQ(said.code, 0);
    for (char const* text : {"question    ", "factors\n", "  rows                all, all but the last\n",
                             "measures    ", "claims\n", "band: ", "time here\n  quick ", "\n  full  "})
        EXPECT_THAT(said.out, HasSubstr(text));
    std::istringstream lines(said.out);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
    EXPECT_FALSE(fs::exists(folder / "out"));
}
TEST_F(Program, FindsStudiesByPaperAndSubject) {
    auto const found = [&](std::string const& words) {
        std::set<std::string> out;
        json const said = json::parse(shell("rlslab list studies " + words + " --json").out);
        for (json const& study : said.at("studies")) out.insert(study.at("name").get<std::string>());
        return out;
    };
    EXPECT_THAT(found("Bierman 1977"), testing::Contains("bierman"));
    EXPECT_THAT(found("bierman"), testing::Contains("bierman"));
    EXPECT_THAT(found("Bierman 1977"), Not(testing::Contains("nist")));
    EXPECT_THAT(found("forgetting"), testing::Contains("sqrt_lambda_bias"));
    EXPECT_EQ(found("").size(), json::parse(shell("rlslab list --json").out).at("studies").size());
}

}  // namespace
