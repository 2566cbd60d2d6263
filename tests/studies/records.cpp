// The map of winners: its laws where they are known, and the statistics of its claims on a table that obeys the laws.
#include "studies/maps/winner_reading.hpp"
#include "studies/published/survey_data.hpp"

#include <rlslab/core/input_error.hpp>
#include <rlslab/studies/study.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

namespace rlslab {

using namespace studies;
namespace {

MapCell cell(int bits, double kappa, bool rotated, double c2 = 1, double rows = 1000) {
    return {bits, 1, rows, c2, 1e-3, {1, 1 / std::sqrt(kappa), 1 / kappa}, rotated, "generic"};
}

TEST(Map, TheErrorInUDependsOnNoWordWithoutDrift) {
    for (char const* const form : {"symmetric", "joseph", "information", "ud"}) {
        MapCell const of_float = cell(24, 100, true), of_double = cell(53, 100, true);
        EXPECT_DOUBLE_EQ(law_of(form, of_float).covariance / of_float.u(),
                         law_of(form, of_double).covariance / of_double.u())
            << form;
    }
}
TEST(Map, InUnitsTheConditionIsInNoErrorOfP) {
    for (std::string const& form : all_forms()) {
        if (form == "conventional" || form == "potter") continue;
        double const at_10 = law_of(form, cell(53, 10, false, 1e-6)).covariance,
                     at_1e6 = law_of(form, cell(53, 1e6, false, 1e-6)).covariance;
        EXPECT_NEAR(at_1e6 / at_10, 1, 1e-3) << form;
    }
}
TEST(Map, RotatedItIsInAStoredPAsItsSquareAndInAFactorOnce) {
    auto const grows = [](char const* form) {  // with P0 beyond kappa^2, so that the data decide
        double const N = 1e6, low = law_of(form, cell(53, 1e4, true, 1e9, N)).covariance,
                     high = law_of(form, cell(53, 1e5, true, 1e9, N)).covariance;
        return std::log10(high / low);
    };
    EXPECT_NEAR(grows("ud"), 1, 0.1);
    EXPECT_NEAR(grows("information"), 2, 0.1);
    EXPECT_NEAR(grows("symmetric"), 2, 0.1);
}
TEST(Map, DefinitenessEndsNearTheReciprocalOfU) {
    EXPECT_FALSE(law_of("symmetric", cell(24, 1, false, 0x1p20)).broken);
    EXPECT_TRUE(law_of("symmetric", cell(24, 1, false, 0x1p24)).broken);
    EXPECT_FALSE(law_of("ud", cell(24, 1, false, 0x1p60)).broken);
}

/// A line of cells in which every form keeps what the laws say, less `sabotage` digits of P in symmetric.
Table obedient(double sabotage) {
    std::vector<std::string> columns{"regime", "size",           "spectrum",       "theta",    "noise",
                                     "basis",  "prior_exponent", "kappa_exponent", "replicate"};
    size_t const factors = columns.size();
    for (std::string const& measure : map_measures()) columns.push_back(measure);
    Table out(columns);
    for (double const kappa : {0.0, 0.125, 0.25, 0.375, 0.5}) {
        std::vector<Cell> row{"float memory 100", 4.0, "geometric", "generic", 1e-3, "rotated", 0.5, kappa, 1.0};
        MapCell const at = map_cell([&](std::string_view name) -> Cell const& { return row[out.index(name)]; });
        for (std::string const& form : all_forms()) {
            MapLaw const law = law_of(form, at);
            double const broken = law.broken ? NAN : 0, less = form == "symmetric" ? sabotage : 0;
            for (double const error : {law.theta, law.theta, law.covariance})
                row.emplace_back(broken - std::log10(std::min(error, 1.0)) - less);
        }
        row.insert(row.end(), {"S", "F"});
        EXPECT_EQ(row.size(), factors + map_measures().size());
        out.add(row);
    }
    return out;
}
TEST(Map, ItsStatisticsAreOneWhereTheLawsHoldAndCanFail) {
    Table const good = obedient(0), bad = obedient(4);
    for (Statistic const& statistic : {boundaries_foretold(0.01), family_foretold(all_forms()),
                                       family_foretold(plain_forms()), loss_foretold("symmetric", 1e-6)})
        EXPECT_EQ(statistic(good), 1);
    EXPECT_EQ(loss_foretold("symmetric", 0.5)(bad), 0);
    EXPECT_GT(largest_loss("symmetric", all_forms())(bad), 3);
    EXPECT_GT(cells_lost("symmetric", all_forms(), 3)(bad), cells_lost("symmetric", all_forms(), 3)(good));
}

// The records of the survey: the list, those in the program, their scaling; and one line where the others are not.
using namespace studies::survey_data;

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
