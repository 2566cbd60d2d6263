// The records of the survey: the list, those in the program, their scaling; and one line where the others are not.
#include "studies/published/survey_data.hpp"

#include <rlslab/core/input_error.hpp>
#include <rlslab/studies/study.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

namespace rlslab {
using namespace studies;
using namespace studies::survey_data;
namespace {

std::vector<std::string> records_of_study(Budget budget) {
    std::vector<std::string> out;
    for (Study const* study : studies::studies()) {
        if (study->name != "survey") continue;
        std::vector<Factor> const factors = study->factors(budget);
        for (Cell const& record : factors.front().values) out.push_back(std::get<std::string>(record));
    }
    return out;
}

TEST(Survey, UsesEachRecordOnce) {
    std::vector<std::string> const all = used();
    EXPECT_EQ(all.size(), 326u);
    EXPECT_EQ(std::set<std::string>(all.begin(), all.end()).size(), all.size());
    EXPECT_EQ(records_of_study(Budget::full).size(), 109u);
}
TEST(Survey, HasTheQuickBudgetsRecordsInTheProgramWithTheRowsOfTheList) {
    std::string const list(file("records.csv"));
    EXPECT_THAT(records_of_study(Budget::quick),
                testing::UnorderedElementsAre("NIST.longley", "statsmodels.danish_data", "statsmodels.elnino",
                                              "statsmodels.statecrime", "statsmodels.strikes"));
    for (std::string const& name : records_of_study(Budget::quick)) {
        Records const records = records_of(name);
        std::size_t const at = list.find("\n" + name + ",");
        ASSERT_NE(at, list.npos) << name;
        std::string const line = list.substr(at + 1, list.find('\n', at + 1) - at - 1);
        EXPECT_NE(line.find("," + std::to_string(records.rows()) + "," + std::to_string(records.parameters()) + ","),
                  line.npos)
            << line;
    }
}
TEST(Survey, ScalesColumnsAndLeavesTheConstant) {
    Records const records = scaled(records_of("NIST.longley"));
    EXPECT_TRUE((records.psi.row(0).array() == 1).all());
    for (Index i = 1; i < records.parameters(); ++i) {
        EXPECT_NEAR(records.psi.row(i).mean(), 0, 1e-13);
        EXPECT_NEAR(records.psi.row(i).squaredNorm(), double(records.rows() - 1), 1e-12);
    }
    double const mean = records.y.mean();
    EXPECT_NEAR((records.y.array() - mean).matrix().squaredNorm(), double(records.rows() - 1), 1e-10);
    EXPECT_GT(mean, 1) << "y keeps its mean";
    EXPECT_EQ(first_half(records).rows(), 8);
}
TEST(Survey, SaysInOneLineThatTheOtherRecordsAreNotThere) {
    unsetenv("RLSLAB_RECORDS");
    EXPECT_THAT([] { records_of("MASS.hills"); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("RLSLAB_RECORDS=FOLDER")));
    setenv("RLSLAB_RECORDS", "/nowhere", 1);
    EXPECT_THAT([] { records_of("MASS.hills"); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("/nowhere/MASS.hills.csv")));
    unsetenv("RLSLAB_RECORDS");
}

}  // namespace
}  // namespace rlslab
