// A column that counts upwards as dates and numbers of rows do is named where it is a regressor.
#include "tests/common/program.hpp"

#include <rlslab/input/counting.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rlslab {
namespace {

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

}  // namespace
}  // namespace rlslab
