// The records that the program has in it, and --example.
#include "src/lab/program/examples.hpp"
#include "tests/common/program.hpp"

#include <nlohmann/json.hpp>

namespace {

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
