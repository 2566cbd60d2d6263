// The map of winners: its laws where they are known, and the statistics of its claims on a table that obeys the laws.
#include "studies/maps/winner_reading.hpp"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace rlslab
