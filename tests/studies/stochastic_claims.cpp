// The words of the claims about hazards: on made-up losses each holds, fails and is undecided where it should.
#include <rlslab/studies/study.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rlslab {
using namespace studies;
namespace studies {
extern Study const stochastic_definiteness;
}
namespace {

/// The verdict of the claim that begins so.
Verdict verdict(std::string const& begins, Table const& t) {
    for (Claim const& claim : stochastic_definiteness.claims)
        if (claim.text.starts_with(begins)) return claim.judge(t).verdict;
    ADD_FAILURE() << "no claim begins with " << begins;
    return Verdict::fails;
}
Table empty() {
    std::vector<std::string> columns;
    for (Factor const& factor : stochastic_definiteness.factors(Budget::quick)) columns.push_back(factor.name);
    columns.insert(columns.end(), stochastic_definiteness.measures.begin(), stochastic_definiteness.measures.end());
    return Table(columns);
}
/// Twenty runs of `steps` steps with `lost` losses each, one more in every other run, where the law expects `predicted`
/// a step.
void add_runs(Table& t, std::string const& variant, std::string const& rounding, double digits, double lost,
              double predicted, double steps = 1000) {
    for (double n = 1; n <= 20; ++n) {
        double const own = lost + (lost > 0 && std::fmod(n, 2) == 0);
        t.add({variant, 0.9, 0.97, digits, rounding, n, steps, own, 0.0, own / steps, predicted, 1.0});
    }
}
Table symmetric(std::string const& rounding, double lost, double predicted, double steps = 1000) {
    Table t = empty();
    add_runs(t, "symmetric", rounding, 7, lost, predicted, steps);
    return t;
}

TEST(HazardClaims, TheLawHoldsFailsOrIsUndecided) {
    EXPECT_EQ(verdict("S4: to nearest", symmetric("nearest", 20, 0.02)), Verdict::holds);
    EXPECT_EQ(verdict("S4: to nearest", symmetric("nearest", 20, 0.002)), Verdict::fails) << "ten times the law";
    EXPECT_EQ(verdict("S4: to nearest", symmetric("nearest", 20, 0.2)), Verdict::fails) << "a tenth of it";
    EXPECT_EQ(verdict("S4: to nearest", symmetric("nearest", 1, 0.0007)), Verdict::undecided)
        << "thirty losses at 2.1 times the law";
    EXPECT_EQ(verdict("S4: to nearest", symmetric("nearest", 0, 0.0001)), Verdict::fails)
        << "two expected: nothing was measured";
    EXPECT_EQ(verdict("S4: stochastic", symmetric("stochastic", 20, 0.02)), Verdict::holds);
    EXPECT_EQ(verdict("S4: stochastic", symmetric("nearest", 20, 0.02)), Verdict::fails) << "no stochastic runs";
}
TEST(HazardClaims, LossesInBurstsCountLess) {
    Table t = empty();  // as many losses, all of them in two of the runs
    for (double n = 1; n <= 20; ++n) {
        double const own = n <= 2 ? 200 : 0;
        t.add({std::string("symmetric"), 0.9, 0.97, 7.0, std::string("nearest"), n, 1000.0, own, 0.0, own / 1000, 0.02,
               1.0});
    }
    EXPECT_EQ(verdict("S4: to nearest", t), Verdict::undecided);
}
TEST(HazardClaims, HalfABit) {
    auto const with = [](double stochastic) {
        Table t = empty();
        add_runs(t, "symmetric", "nearest", 6, 100, 0.1);
        add_runs(t, "symmetric", "nearest", 7, 25, 0.02);
        add_runs(t, "symmetric", "stochastic", 7, stochastic, 0.04);
        return t;
    };
    EXPECT_EQ(verdict("S5", with(50)), Verdict::holds);
    EXPECT_EQ(verdict("S5", with(400)), Verdict::fails) << "costs two bits";
    EXPECT_EQ(verdict("S5", with(100)), Verdict::fails) << "costs a bit";
    EXPECT_EQ(verdict("S5", with(25)), Verdict::fails) << "costs nothing";
    EXPECT_EQ(verdict("S5", with(10)), Verdict::fails) << "costs less than none";
    EXPECT_EQ(verdict("S5", with(70)), Verdict::undecided) << "three quarters";
}
TEST(HazardClaims, OneLossOfAFactorFormIsSeen) {
    Table t = empty();
    for (char const* variant : {"ud", "carlson", "inverse_qr", "qr"}) add_runs(t, variant, "stochastic", 6, 0, 0.1);
    EXPECT_EQ(verdict("S6", t), Verdict::holds);
    t.add({std::string("ud"), 0.9, 0.97, 6.0, std::string("stochastic"), 21.0, 1000.0, 1.0, 0.0, 0.001, 0.1, 1.0});
    EXPECT_EQ(verdict("S6", t), Verdict::fails);
}
TEST(HazardClaims, FewBitsAreComparedWithAll) {
    auto const with = [](double few) {
        Table t = empty();
        add_runs(t, "symmetric", "stochastic", 8, 50, 0.05);
        add_runs(t, "symmetric", "4 bits", 8, few, 0.05);
        add_runs(t, "symmetric", "4 bits and half", 8, 50, 0.05);
        return t;
    };
    EXPECT_EQ(verdict("4 random bits", with(50)), Verdict::holds);
    EXPECT_EQ(verdict("4 random bits", with(150)), Verdict::fails);
    EXPECT_EQ(verdict("4 random bits", with(72)), Verdict::undecided);
}

}  // namespace
}  // namespace rlslab
