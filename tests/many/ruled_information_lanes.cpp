// Rules of forgetting in packs and fleets, around forms that propagate the inverse of P.
#include "tests/many/lanes.hpp"

#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/information.hpp>
#include <rlslab/variants/qr.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace lanes;

TEST(RuledLanes, HaveTheBitsOfTheirOwnRuleInFormsOfTheInverse) {
    expect_lanes_to_be_ruled_by_each<Qr>();
    expect_lanes_to_be_ruled_by_each<Gentleman>();
    expect_lanes_to_be_ruled_by_each<Information>();
}
TEST(RuledLanes, HaveTheBitsOfTheirOwnRuleInFloat) {
    expect_lanes_to_be_ruled<Gentleman, Kulhavy, float>();
    expect_lanes_to_be_ruled<Gentleman, CovarianceReset, float>();
}
TEST(RuledFleet, EachFilterIsRuledAloneInFormsOfTheInverse) {
    together::expect_fleets_of<double, 8>(Ruled<Qr, Kulhavy, 3>{});
}

}  // namespace
}  // namespace rlslab
