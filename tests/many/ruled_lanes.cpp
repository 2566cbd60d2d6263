// Rules of forgetting in packs and fleets.
#include "tests/many/lanes.hpp"

#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace lanes;

TEST(RuledLanes, HaveTheBitsOfTheirOwnRuleInFormsOfP) {
    expect_lanes_to_be_ruled_by_each<Ud>();
    expect_lanes_to_be_ruled_by_each<Carlson>();
    expect_lanes_to_be_ruled_by_each<Symmetric>();
}
TEST(RuledLanes, HaveTheBitsOfTheirOwnRuleWhereTheSizeIsNotKnown) {
    expect_lanes_to_be_ruled<Ud, Fortescue, double, 4, Dynamic>();
    expect_lanes_to_be_ruled<Ud, RotatingRidge, double, 4, Dynamic>();
}
TEST(RuledFleet, EachFilterIsRuledAlone) {
    together::expect_fleets_of<double, 8>(Ruled<Symmetric, CovarianceReset, 3>{});
    together::expect_fleets_of<double, 4>(Ruled<Ud, RotatingRidge, Dynamic>{});
}
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
TEST(RuledLanes, RefuseNumbersThatAreNotAlike) {
    using P = Pack<double, 4>;
    P phi(0.9);
    EXPECT_NO_THROW((Forgetting<Ud<P, 2>, Kulhavy<P>>(Problem<P>{}, {.forgetting = phi})));
    phi.set(1, 0.8);
    EXPECT_THROW((Forgetting<Ud<P, 2>, Kulhavy<P>>(Problem<P>{}, {.forgetting = phi})), std::invalid_argument);
}
template <class F, class Rule>
concept CanBeRuled = requires { typename Forgetting<F, Rule>; };
static_assert(CanBeRuled<Ud<Pack<double, 8>, 4>, Kulhavy<Pack<double, 8>>>);
static_assert(!CanBeRuled<QrBlock<Pack<double, 8>, 4>, CovarianceReset<Pack<double, 8>>>);

}  // namespace
}  // namespace rlslab
