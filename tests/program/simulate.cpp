// Options for records that would show nothing are refused in one line; every command reads simulated records in all
// supported formats.
#include "tests/common/program.hpp"

#include <rlslab/core/random.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

namespace rlslab {
namespace {

using Simulate = Program;
using DataFiles = Program;

TEST_F(Simulate, RefusesADelayBeyondTheRecord) {
    refused("simulate --samples 100 --delay 100", "--delay 100 --samples");
    EXPECT_EQ(shell("rlslab simulate --samples 100 --delay 99").code, 0);
}
TEST_F(Simulate, RefusesAnOutputThatDoesNotChange) {
    refused("simulate --noise-colour -0.5", "--noise-colour --noise");
    refused("simulate --b 0", "--b 0");
    refused("simulate --samples 3", "--samples");
    refused("simulate --b 0,0 --a=-0.5", "--b 0");
    EXPECT_EQ(shell("rlslab simulate --b 0 --noise 1").code, 0);
    EXPECT_EQ(shell("rlslab simulate --samples 1").code, 0);
}
TEST_F(Simulate, RefusesNumbersWhoseSquaresVanish) {
    refused("simulate --b 1e-160", "--b 2^-500");
    refused("simulate --b 5e-324", "--b 2^-500");
    refused("simulate --b 0 --noise 1e-300", "--b 2^-500");
    refused("simulate --b 1e160", "2^500");
    EXPECT_EQ(shell("rlslab simulate --b 1e-140").code, 0);
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
        auto const found = [](std::string const& json) {  // not the file's name, and not the run
            size_t const from = json.find("\"input\"");
            return json.substr(from, json.find("\"run\"") - from);
        };
        EXPECT_EQ(found(run.out), found(plain.out)) << file << run.err;
    }
    EXPECT_EQ(shell("rlslab excitation - --input u <german").code, 0);
    for (std::string const command :
         {"compare --order 1 --no-timings --csv --arithmetic float", "identify --order 1 --json",
          "compare --regressors u --no-timings --csv --variants ud"})
        EXPECT_EQ(shell("rlslab " + command + (command.find("--regressors") == command.npos ? " --input u" : "") +
                        " german --output y")
                      .code,
                  0)
            << command;
}
TEST_F(DataFiles, OfADoubtfulFormAreExplained) {
    write("doubt.csv", "u;y\n1,234;2\n2;3\n");
    refused("excitation doubt.csv --input u", "doubt.csv:2 1 u 1,234 --decimal");
    EXPECT_EQ(shell("rlslab excitation doubt.csv --input u --decimal , --max-order 1").code,
              1);  // read, and found to identify nothing
    refused("excitation ok.csv --input u --separator x", "--separator comma semicolon tab bar blank x");
    refused("excitation ok.csv --input u --decimal ';'", "--decimal");
    refused("excitation ok.csv --input u --separator semicolon", "u");
}
TEST_F(DataFiles, AColumnWhoseNameHoldsACommaStandsInQuotes) {
    std::ofstream file(folder / "comma.csv");
    file << "\"u,1\",y\n";
    Seed seed{7};
    for (int k = 0; k < 60; ++k)
        file << std::round(1000 * seed.bell()) << ',' << std::round(1000 * seed.bell()) << '\n';
    file.close();
    std::string const quoted = "'\"u,1\"' --output y";
    for (std::string const command : {"compare comma.csv --order 1 --input ", "identify comma.csv --order 1 --input ",
                                      "compare comma.csv --regressors "}) {
        Outcome const run = shell("rlslab " + command + quoted);
        EXPECT_LE(run.code, 1) << command << run.err;
        EXPECT_THAT(run.out, testing::HasSubstr("u,1")) << command;
    }
    refused("compare comma.csv --input '\"u,1' --output y --order 1", "comma.csv u,1 y");
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
TEST_F(DataFiles, AnEmptyFolderIsNoFolder) {
    refused("compare ok.csv --input u --output y --order 1 --out ''", "--out");
    refused("identify ok.csv --input u --output y --order 1 --out ''", "--out");
}

}  // namespace
}  // namespace rlslab
