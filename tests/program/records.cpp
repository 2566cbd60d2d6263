// Records for the program: simulated ones, in all supported formats, with columns of any name; what excitation says of
// them; columns that count upwards, as dates and numbers of rows do, and are named where they are regressors.
#include "src/lab/program/record_options.hpp"
#include "tests/common/program.hpp"

#include <rlslab/input/counting.hpp>
#include <rlslab/model/excitation.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace rlslab {
namespace {

using nlohmann::json;
using Simulate = Program;
using DataFiles = Program;

/// Beside what messages.txt has refused.
TEST_F(Simulate, TakesWhatIsJustEnough) {
    for (std::string const words :
         {"--samples 100 --delay 99", "--b 0 --noise 1", "--samples 1", "--b 1e-140", "--a -0.5,0.25 --samples 30"})
        EXPECT_EQ(shell("rlslab simulate " + words).code, 0) << words;
}

TEST_F(DataFiles, AreReadInEveryForm) {
    ASSERT_EQ(shell("rlslab simulate --a=-0.5 --samples 200 --noise 0.1 >u.csv; gzip -k u.csv; { echo 'sep=;'; tr ,. "
                    "';,' <u.csv; } >german.csv;"
                    "tr , ' ' <u.csv >blanks; tr , '|' <u.csv >bars; cat german.csv | gzip >german")
                  .code,
              0);
    Outcome const plain = shell("rlslab excitation u.csv --input u --json");
    ASSERT_EQ(plain.code, 0) << plain.err;
    for (std::string const file : {"u.csv.gz", "german.csv", "german", "blanks", "bars --separator bar"}) {
        Outcome const run = shell("rlslab excitation " + file + " --input u --json");
        auto const found = [](std::string const& said) {  // not the file's name, and not the run
            size_t const from = said.find("\"input\"");
            return said.substr(from, said.find("\"run\"") - from);
        };
        EXPECT_EQ(found(run.out), found(plain.out)) << file << run.err;
    }
    EXPECT_EQ(shell("rlslab excitation - --input u <german").code, 0);
    write("doubt.csv", "u;y\n1,234;2\n2;3\n");
    EXPECT_EQ(shell("rlslab excitation doubt.csv --input u --decimal , --max-order 1").code, 1) << "read: no model";
    for (std::string const command :
         {"compare --order 1 --no-timings --csv --arithmetic float", "identify --order 1 --json",
          "compare --regressors u --no-timings --csv --variants ud"})
        EXPECT_EQ(shell("rlslab " + command + (command.find("--regressors") == command.npos ? " --input u" : "") +
                        " german --output y")
                      .code,
                  0)
            << command;
}
TEST_F(DataFiles, AColumnWhoseNameHoldsACommaStandsInQuotes) {
    std::ofstream file(folder / "comma.csv");
    file << "\"u,,1\",y\n";
    Seed seed{7};
    for (int k = 0; k < 60; ++k)
        file << std::round(1000 * seed.bell()) << ',' << std::round(1000 * seed.bell()) << '\n';
    file.close();
    std::string const quoted = "'\"u,,1\"' --output y";
    for (std::string const command : {"compare comma.csv --order 1 --input ", "identify comma.csv --order 1 --input ",
                                      "compare comma.csv --regressors "}) {
        Outcome const run = shell("rlslab " + command + quoted);
        EXPECT_LE(run.code, 1) << command << run.err;
        EXPECT_THAT(run.out, testing::HasSubstr("u,,1")) << command;
    }
    refused("compare comma.csv --input '\"u,,1' --output y --order 1", "comma.csv u,,1 y");
}
TEST_F(DataFiles, AColumnAsMatlabNamesItNeedsNoQuotes) {
    write("matrix.csv", "\"x(:,2)\",y\n" + rows(60, [](int k) { return std::to_string(k * 5 % 13); }));
    for (std::string const command : {"compare matrix.csv --order 1 --input", "identify matrix.csv --order 1 --input",
                                      "compare matrix.csv --regressors"}) {
        Outcome const run = shell("rlslab " + command + " 'x(:,2)' --output y");
        EXPECT_LE(run.code, 1) << command << run.err;
        EXPECT_THAT(run.out, testing::HasSubstr("x(:,2)")) << command;
    }
    refused("compare matrix.csv --regressors 'x(:,2),v' --output y", "v");
}

/// What `rlslab excitation` prints is what the library computes.
TEST_F(DataFiles, ExcitationIsThatOfTheLibrary) {
    auto const write_column = [&](Signal const& x) {
        std::string text = "u\n";
        for (double const v : x) text += fmt::format("{}\n", v);
        write("one.csv", text);
    };
    auto const run = [&](std::string const& words) {
        Outcome const out = shell("rlslab excitation one.csv --input u " + words);
        EXPECT_EQ(out.code, 0) << out.err;
        return out.out;
    };
    Signal const x = prbs(5, 40);
    write_column(x);
    Excitation const e = excitation(x, 4);
    json const said = json::parse(run("--max-order 4 --json"));
    EXPECT_EQ(said["samples"], 40);
    EXPECT_EQ(said["exciting_of_order"], 4);
    EXPECT_EQ(said["exact_order"], 4);
    EXPECT_EQ(said["persistent_order"], 4);
    EXPECT_EQ(said["changes"], e.changes);
    EXPECT_EQ(said["resolution"], e.resolution);
    EXPECT_EQ(said["constant_at_start"], e.constant_at_start);
    for (size_t i = 0; i < 4; ++i)
        EXPECT_EQ(said["orders"][i], (json{{"order", i + 1},
                                           {"least_eigenvalue", e.orders[i].least},
                                           {"condition", e.orders[i].condition},
                                           {"definite", true},
                                           {"resolved", true},
                                           {"rows_that_carry", e.orders[i].carried}}));
    std::string const table = run("--max-order 4");
    EXPECT_THAT(table, Names("exciting 4 model 3"));
    EXPECT_THAT(run("--max-order 50"), Names("exciting 20 19")) << "40 samples: 21 windows of 20";
    Signal step(100, 0.06);
    std::fill_n(step.begin(), 60, 0.05);
    write_column(step);
    EXPECT_THAT(run("--max-order 4"), Names("exciting 4 1 99 2 once"));
}
TEST(Counting, IsGrowthByStepsOfWhichMostAreEqual) {
    std::vector<double> x;
    for (int k = 0; k < 9; ++k) x.push_back(1990 + k);
    EXPECT_EQ(counting_step(x), std::nullopt) << "nine";
    x.push_back(1999);
    EXPECT_EQ(counting_step(x), 1);
    x.push_back(2000);
    x[3] = NAN;
    EXPECT_EQ(counting_step(x), 1) << "one is missing";
    x[4] = x[5];
    EXPECT_EQ(counting_step(x), std::nullopt) << "equal numbers";
    // Weeks as numbers of eight digits: 7 within a month.
    EXPECT_EQ(counting_step(
                  {19580329, 19580405, 19580412, 19580419, 19580426, 19580503, 19580510, 19580517, 19580524, 19580531}),
              7);
    EXPECT_EQ(counting_step({1, 2, 3, 4, 5, 7, 9, 12, 15, 19, 20}), std::nullopt) << "half of the steps";
    std::vector<double> seconds;
    for (int k = 0; k < 100; ++k) seconds.push_back(1e4 + 0.01 * k);
    ASSERT_TRUE(counting_step(seconds));
    EXPECT_NEAR(*counting_step(seconds), 0.01, 1e-8) << "rounding does not matter";
}
TEST_F(Program, NamesARegressorThatCounts) {
    std::string text = "date,u,y\n";
    std::uint64_t bits = 1;
    for (int k = 0; k < 60; ++k) {
        bits = bits * 6364136223846793005u + 1442695040888963407u;
        text += std::to_string(20240101 + k) + ',' + std::to_string(bits >> 56) + ',' +
                std::to_string((bits >> 50) & 255) + '\n';
    }
    write("dates.csv", text);
    for (std::string const command :
         {"compare dates.csv --regressors date,u --output y --intercept --arithmetic double --no-timings --json",
          "compare dates.csv --regressors date,u --output y --detrend --arithmetic double --no-timings --json",
          "identify dates.csv --input date,u --output y --na 0 --nb 0 --json"}) {
        Outcome const run = shell("rlslab " + command);
        EXPECT_THAT(run.out, Names("column date 1")) << command << run.err;
    }
    EXPECT_THAT(shell("rlslab compare dates.csv --regressors u --output y --arithmetic double --no-timings --json").out,
                testing::Not(Names("column date")));
}

// The records that the program has in it, and --example.
using namespace rlslab::program;
using nlohmann::json;
using testing::HasSubstr;

TEST_F(Program, PrintsItsExamplesAsTheirFiles) {
    Outcome const list = shell("rlslab example");
    for (Example const& example : examples()) {
        std::string const name(example.name), file = name + ".csv";
        EXPECT_THAT('\n' + list.out, HasSubstr('\n' + name + ' ')) << "in the list";
        EXPECT_THAT(read(fs::path(root) / "studies/data/README.md"), HasSubstr('`' + file + '`'))
            << "source and licence";
        Outcome const printed = shell("rlslab example " + name);
        EXPECT_EQ(printed.code, 0) << printed.err;
        int found = 0;
        for (char const* place : {"studies/data", "studies/data/nist", "studies/data/examples"})
            if (fs::path const path = fs::path(root) / place / file; fs::exists(path)) {
                EXPECT_EQ(printed.out, read(path)) << name;
                ++found;
            }
        EXPECT_EQ(found, 1) << name;
    }
    EXPECT_EQ(examples().size(), 6u);
}
TEST_F(Program, ComparesAnExampleAsItsFile) {
    ASSERT_EQ(shell("rlslab example sales > sales.csv; rlslab example longley > longley.csv").code, 0);
    auto const answer = [&](std::string const& words) {
        Outcome const run = shell("rlslab compare " + words + " --json --no-timings");
        EXPECT_NE(run.code, 2) << run.err;
        json out = json::parse(run.out);
        out.at("run").erase("command");
        return out;
    };
    EXPECT_EQ(answer("--example sales"), answer("sales.csv --input lead --output sales --order 2 --detrend"));
    EXPECT_EQ(answer("--example sales --order 1"), answer("sales.csv --input lead --output sales --order 1 --detrend"));
    EXPECT_EQ(answer("--example sales --regressors lead,sales[k-1]"),
              answer("sales.csv --output sales --regressors lead,sales[k-1]"))
        << "a model of one's own in place of the example's";
    EXPECT_EQ(answer("--example longley --arithmetic float"),
              answer("longley.csv --output y --regressors one,x1,x2,x3,x4,x5,x6 --arithmetic float"));
}
TEST_F(Program, ConventionalLosesDefinitenessInFloatOnTwoExamples) {
    std::string broken;
    for (Example const& example : examples()) {
        json const run = json::parse(shell("rlslab compare --example " + std::string(example.name) +
                                           " --variants conventional,ud --arithmetic float --json --no-timings")
                                         .out);
        for (json const& result : run.at("results"))
            if (json const& breakdown = result.at("breakdown"); !breakdown.is_null())
                broken += std::string(example.name) + ' ' + result.at("variant").get<std::string>() + ' ' +
                          breakdown.at("kind").get<std::string>() + '\n';
    }
    EXPECT_EQ(broken, "longley conventional indefinite\nfilip conventional indefinite\n");
}
TEST_F(Program, SweepsAnExample) {
    ASSERT_EQ(shell("rlslab sweep --example sales --vary order=1,2 --vary variant=ud").code, 0);
    EXPECT_THAT(read(folder / "sweep/sweep.csv"), HasSubstr("# source: sales.csv, 150 rows"));
    ASSERT_EQ(shell("rlslab sweep --example airquality --vary variant=ud --out other").code, 0);
}

}  // namespace
}  // namespace rlslab
