// rlslab sweep: the variants on a record, over values of factors; its digits are compare's. rlslab study with other
// factors, described, and found by paper and subject.
#include "tests/common/program.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// The cells of the rows below the names of the columns.
std::vector<std::map<std::string, std::string>> cells_of(std::string const& csv) {
    std::vector<std::string> names;
    std::vector<std::map<std::string, std::string>> out;
    for (std::string const& line : lines_of(without_run(csv))) {
        std::istringstream row(line);
        std::vector<std::string> cells;
        for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
        if (names.empty()) {
            names = cells;
            continue;
        }
        out.emplace_back();
        for (size_t i = 0; i < names.size(); ++i) out.back()[names[i]] = cells.at(i);
    }
    return out;
}

/// Whether digits, in tenths, are the median of compare's path, in thousandths, from row 2 d on. A trial is one draw of
/// the roundings, and so is the path; compare's own median is of four draws and more.
bool is_median(double tenths, json const& compared, json const& result, char const* measure) {
    int const row = 2 * compared.at("data").at("size").get<int>();
    std::vector<double> digits;
    for (size_t c = 0; c < compared.at("checkpoints").size(); ++c) {
        json const& at = result.at("path").at(measure).at(c);
        if (compared.at("checkpoints")[c] >= row) digits.push_back(at.is_null() ? -HUGE_VAL : at.get<double>());
    }
    std::ranges::sort(digits);
    double const median = digits[(digits.size() - 1) / 2];
    return tenths == median || std::abs(tenths - median) < 0.0506;
}

TEST_F(Program, SweepsARecordWithTheDigitsOfCompare) {
    std::string const record = "ok.csv --input u --output y --order 1 ";
    Outcome const swept = shell("rlslab sweep " + record +
                                "--vary forgetting=0.96875,1 --vary arithmetic=float,p11 --row-orders 3 --out sweep");
    ASSERT_EQ(swept.code, 0) << swept.err;
    auto const rows = cells_of(read(folder / "sweep/sweep.csv"));
    std::map<std::string, int> count;
    for (auto const& row : rows) ++count[row.at("arithmetic") + ' ' + row.at("forgetting")];
    // Eighteen dense variants; three orders of rows where forgetting = 1.
    EXPECT_EQ(count,
              (std::map<std::string, int>{{"float 0.96875", 18}, {"float 1", 54}, {"p11 0.96875", 18}, {"p11 1", 54}}));
    json const compared = json::parse(
        shell("rlslab compare " + record + "--forgetting 0.96875 --arithmetic float,p11 --json --no-timings").out);
    int checked = 0;
    for (json const& result : compared.at("results"))
        for (auto const& row : rows)
            if (row.at("forgetting") == "0.96875" && row.at("variant") == result.at("variant") &&
                row.at("arithmetic") == result.at("arithmetic")) {
                EXPECT_TRUE(is_median(std::stod(row.at("worst")), compared, result, "worst")) << result;
                EXPECT_TRUE(is_median(std::stod(row.at("P")), compared, result, "covariance")) << result;
                ++checked;
            }
    EXPECT_EQ(checked, 36);
    EXPECT_THAT(read(folder / "sweep/sweep.csv"), HasSubstr("# command: rlslab sweep ok.csv --input u"));
    EXPECT_THAT(read(folder / "sweep/report.html"), HasSubstr("sha256"));
    EXPECT_FALSE(fs::is_empty(folder / "sweep/figures"));
}
/// By a converter of this test, which fails the second time it is asked for one.
TEST_F(Program, DrawsPdfBesideSvg) {
    std::string const sweep =
        "sweep ok.csv --input u --output y --order 1 --vary variant=ud --vary forgetting=0.98,0.99,1 ";
    write("rsvg-convert", "#!/bin/bash\n[[ ! -e $4 && $5 == *.svg ]] && /bin/cp -- \"$5\" \"$4\"\n");
    Outcome const drawn = shell("chmod +x rsvg-convert; PATH=$PWD; rlslab " + sweep + "--figures pdf --out a");
    ASSERT_EQ(drawn.code, 0) << drawn.err;
    for (char const* name : {"sweep-1", "sweep-2"}) {
        std::string const svg = read(folder / "a/figures" / (std::string(name) + ".svg"));
        EXPECT_GT(svg.size(), 1000u);
        EXPECT_EQ(svg, read(folder / "a/figures" / (std::string(name) + ".pdf")));
    }
    shell("rlslab " + sweep + "--out b");
    EXPECT_EQ(read(folder / "a/report.html"), read(folder / "b/report.html"));
    for (auto const& file : fs::directory_iterator(folder / "b/figures")) EXPECT_EQ(file.path().extension(), ".svg");
    Outcome const again = shell("PATH=$PWD rlslab " + sweep + "--figures pdf --out a");
    EXPECT_EQ(again.code, 2);
    EXPECT_THAT(again.err, HasSubstr("rlslab: --figures pdf: a/figures/"));
    refused(sweep + "--figures png --out c", "--figures svg pdf png");
    Outcome const none = shell("mkdir empty; PATH=$PWD/empty; rlslab " + sweep + "--figures pdf --out c");
    EXPECT_EQ(none.code, 2);
    EXPECT_EQ(none.err, "rlslab: --figures: expected rsvg-convert in PATH, which makes them\n");
    EXPECT_FALSE(fs::exists(folder / "c"));
}
TEST_F(Program, SweepsInPartsWithTheSameBytes) {
    std::string const sweep =
        "rlslab sweep ok.csv --input u --output y --vary order=1,2,3 --vary prior=scaled,1e4 "
        "--vary variant=ud,qr --vary arithmetic=bfloat16-stochastic ";
    ASSERT_EQ(shell(sweep + "--out whole --threads 1").code, 0);
    for (char const* part : {"1/2", "2/2"}) {
        Outcome const one = shell(sweep + "--out parts --part " + part);
        EXPECT_EQ(one.code, 0) << one.err;
        EXPECT_THAT(one.err, HasSubstr("3 of 6 trials"));
    }
    ASSERT_EQ(shell(sweep + "--out parts").code, 0);
    for (char const* file : {"sweep.csv", "report.html"})
        EXPECT_EQ(read(folder / "whole" / file), read(folder / "parts" / file)) << file;
    EXPECT_EQ(cells_of(read(folder / "whole/sweep.csv")).size(), 12u);
    for (char const* part : {"1/2", "2/2"})
        ASSERT_EQ(shell(sweep + "--out apart" + std::string(part, 1) + " --part " + part).code, 0);
    refused(sweep.substr(7) + "--vary forgetting=1 --from apart1 --from apart2 --out none", "--from apart1");
    refused(sweep.substr(7) + "--from whole --out none", "--from whole");
    refused(sweep.substr(7) + "--from apart1 --part 1/2 --out none", "--from --part");
    EXPECT_EQ(shell(sweep + "--from apart1 --out none").code, 2) << "a part is missing";
    ASSERT_EQ(shell(sweep + "--from apart1 --from apart2 --out merged").code, 0);
    EXPECT_EQ(read(folder / "whole/sweep.csv"), read(folder / "merged/sweep.csv"));
}
TEST_F(Program, SweepsArithmeticsByTheirUsualNames) {
    std::string const sweep = "rlslab sweep ok.csv --input u --output y --order 1 --vary variant=ud ";
    ASSERT_EQ(shell(sweep + "--vary arithmetic=half,fp32").code, 0);
    std::vector<std::string> found;
    for (auto const& row : cells_of(read(folder / "sweep/sweep.csv"))) found.push_back(row.at("arithmetic"));
    EXPECT_THAT(found, testing::ElementsAre("binary16", "float"));
    refused(sweep.substr(7) + "--vary arithmetic=half,binary16", "--vary arithmetic binary16 twice");
}
TEST_F(Program, SweepsOrdersOfARecordFromStandardInput) {
    std::string const sweep = "--input u --output y --vary variant=ud --vary order=1,2 ";
    ASSERT_EQ(shell("rlslab sweep ok.csv " + sweep + "--out file").code, 0);
    Outcome const piped = shell("cat ok.csv | rlslab sweep - " + sweep + "--out piped");
    ASSERT_EQ(piped.code, 0) << piped.err;
    EXPECT_EQ(without_run(read(folder / "piped/sweep.csv")), without_run(read(folder / "file/sweep.csv")));
    ASSERT_EQ(shell("rlslab sweep ok.csv --input u --output y --order 2 --vary variant=ud --out one").code, 0);
    for (auto const& row : cells_of(read(folder / "one/sweep.csv"))) EXPECT_EQ(row.at("order"), "2");
}
TEST_F(Program, DrawsASweepOverPriorsWithoutTheScaledOne) {
    Outcome const swept = shell(
        "rlslab sweep ok.csv --input u --output y --order 1 --vary prior=scaled,1e2,1e4,1e308 --vary variant=ud,qr");
    ASSERT_EQ(swept.code, 0) << swept.err;
    EXPECT_EQ(cells_of(read(folder / "sweep/sweep.csv")).size(), 16u);
    EXPECT_THAT(read(folder / "sweep/figures/sweep-1.svg"), HasSubstr("c^2 of P0"));
    std::string const page = read(folder / "sweep/report.html");
    EXPECT_THAT(page, Not(HasSubstr("claims hold")));  // it has none
    EXPECT_THAT(page, Not(HasSubstr("How many claims")));
    EXPECT_THAT(page, Not(HasSubstr("full budget")));
}
TEST_F(Program, RefusesPartsOfTwoSweepsInOneFolder) {
    std::string const sweep = "sweep ok.csv --input u --output y --order 1 --vary variant=ud --out shared ";
    ASSERT_EQ(shell("rlslab " + sweep + "--part 1/2").code, 0);
    refused(sweep + "--vary prior=1,2 --part 1/2", "holds parts of another sweep");
    refused("study slicot --out shared --part 1/2", "holds parts of other studies");
    refused("merge shared --out merged", "expected studies, budget and seed as rlslab study --part writes them");
    ASSERT_EQ(shell("rlslab " + sweep).code, 0);
    EXPECT_EQ(shell("rlslab " + sweep + "--vary prior=1,2 --part 1/2").code, 0);  // the other is finished
    refused("study slicot --out shared",
            "--out shared: holds what rlslab sweep made (sweep.csv); expected another folder");
    ASSERT_EQ(shell("rlslab study slicot --out studies --quiet").code, 0);
    refused("sweep ok.csv --input u --output y --out studies", "--out studies: holds what rlslab study made");
}
TEST_F(Program, WarnsInASweepOfAColumnThatCounts) {
    write("counts.csv", "u,y\n" + rows(40, [](int k) { return std::to_string(k); }));
    Outcome const swept = shell("rlslab sweep counts.csv --input u --output y --order 1 --vary variant=ud");
    EXPECT_EQ(swept.code, 0) << swept.err;
    EXPECT_THAT(swept.err, HasSubstr("rlslab: warning: column u counts upwards"));
}

// --- studies ---------------------------------------------------------------------------------------------------------

/// The rows of a study's table that hold the text, without the lines of provenance.
std::multiset<std::string> rows_with(std::string const& csv, std::string const& part) {
    std::multiset<std::string> out;
    for (std::string const& line : lines_of(csv))
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
    for (std::string const& line : lines_of(said.out)) EXPECT_LE(line.size(), 100u) << line;
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
