// Warnings and what they tell a person to do: each appears where it should, and only there.
#include "src/lab/identify/roots.hpp"
#include "src/lab/identify/remarks.hpp"
#include "src/lab/identify/text.hpp"
#include "tests/identify/options.hpp"

#include <rlslab/model/fit.hpp>
#include <rlslab/model/outliers.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rlslab {
using namespace identify;
using namespace report;
namespace {

using testing::Contains;
using testing::HasSubstr;
using Rank = Remark::Rank;
using testing::IsEmpty;
using testing::Not;

Signal scaled(Signal x, double by) {
    for (double& v : x) v *= by;
    return x;
}
DifferenceEquation const order_three{.a = {-1.2, 0.7, -0.2}, .b = {{0, 1, 0.5, -0.4}}, .delay = 0, .c = 0};

class Advice : public testing::Test {
protected:
    files::Folder const folder;
    Identified identified(Signal const& u, Signal const& y, IdentifyOptions options = {}) const {
        options.inputs = {"u"}, options.output = "y";
        return identify::identify(folder.file(csv({u, y}, "u,y")), options);
    }
};

// --- the order at the limit ------------------------------------------------------------------------------------------

TEST_F(Advice, AnOrderAtTheLimitOfTheSearchNamesAHigherOne) {
    Signal const u = prbs(9, 900), y = simulate(order_three, {u}, scaled(white_noise(900, Seed{1}), 0.05));
    Identified const at_limit = identified(u, y, {.max_order = 2}), below = identified(u, y, {.max_order = 6}),
                     given = identified(u, y, {.order = 2});
    EXPECT_EQ(at_limit.order, 2);
    EXPECT_THAT(at_limit.remarks, Contains(Says(Rank::order, "2 --max-order 4")));
    EXPECT_EQ(below.order, 3);
    EXPECT_THAT(below.warnings(), IsEmpty());
    EXPECT_THAT(given.remarks, Not(Contains(Says(Rank::order, "2"))));
}
TEST_F(Advice, AnOrderThatTheInputLimitsAsksForARicherInput) {
    Signal u(900), v = prbs(9, 900);
    for (size_t k = 0; k < u.size(); ++k) u[k] = std::sin(0.3 * double(k)) + std::sin(0.9 * double(k));
    Identified const m = identified(u, simulate(order_three, {u}, scaled(coloured_noise(900, {-0.5}, Seed{1}), 0.05)),
                                    {.detrend = false});
    ASSERT_EQ(m.excitation[0].order, 4);
    ASSERT_EQ(m.order, 3);
    EXPECT_THAT(m.remarks, Contains(Says(Rank::order, "3 input")));
    EXPECT_THAT(m.remarks, Contains(Says(Rank::excitation, "u 4 3")));
}

// --- worse than the mean ---------------------------------------------------------------------------------------------

TEST_F(Advice, AHeldOutPartThatIsPredictedWorseThanByItsMean) {
    Signal const u = white_noise(600, Seed{2});
    Signal y(600, 0.0);
    for (size_t k = 1; k < 600; ++k)
        y[k] = (k < 400 ? 1 : -1) * u[k - 1] + 0.01 * Seed{k}.bell();  // the gain changes its sign
    Identified const m = identified(u, y, {.order = 1});
    EXPECT_LT(m.held_out_one_step, 0);
    auto const worse =
        Says(Rank::held_out, fmt::format("{:.3g} --order --validate --forgetting 0.99", m.held_out_one_step));
    EXPECT_THAT(m.remarks, Contains(worse));
    EXPECT_THAT(m.remarks, Contains(Says(Rank::held_out, "")).Times(1)) << "one cause, one remark";
    EXPECT_THAT(as_table(m), HasSubstr("warning: held out"));
}
/// A mean that is summed up leaves rounding of a level, and a spread of rounding is none.
TEST_F(Advice, AHeldOutPartAtRestHasNoPercentage) {
    for (double const level : {20.0, 20.3, 20.25, 0.1, 1e6 + 0.1}) {
        Signal u(900, 0.0);
        std::ranges::copy(prbs(7, 500), u.begin());
        Signal y = simulate({.a = {-0.8}, .b = {{0, 0.5}}, .delay = 0, .c = 0}, {u}, Signal(900, 0.0));
        for (size_t k = 0; k < y.size(); ++k) y[k] = k < 600 ? y[k] + level + 1e-4 * Seed{k}.bell() : level;
        Identified const m = identified(u, y, {.order = 1});
        EXPECT_GT(m.fit_one_step, 99);
        EXPECT_EQ(m.held_out_one_step, -INFINITY) << level;
        EXPECT_THAT(m.remarks, Contains(Says(Rank::held_out, "y does not change there"))) << level;
        EXPECT_THAT(m.warnings(), Not(Contains(HasSubstr("do not use it there"))));
        EXPECT_EQ(fit_percent(Vector<double>::Constant(100, level), Vector<double>::Constant(100, level + 1)),
                  -INFINITY);
    }
}
TEST_F(Advice, AHeldOutPartThatIsPredictedButNotSimulated) {
    Signal const u = scaled(white_noise(600, Seed{2}), 0.01);
    Signal y(600, 0.0);
    for (size_t k = 1; k < 600; ++k) y[k] = y[k - 1] + u[k - 1] + 0.3 * Seed{k}.bell();  // a random walk
    Identified const m = identified(u, y, {.order = 1});
    ASSERT_GT(m.held_out_one_step, 0);
    ASSERT_LT(m.held_out_simulated, 0);
    EXPECT_THAT(m.remarks, Contains(Says(Rank::held_out, fmt::format("{:.3g}", m.held_out_simulated))));
    EXPECT_THAT(m.remarks, Not(Contains(Says(Rank::held_out, "--validate"))));
}

// --- residuals that are not white ------------------------------------------------------------------------------------

TEST_F(Advice, ResidualsThatAreNotWhiteSayWhatTheyFollow) {
    Signal const u = prbs(9, 900);
    // Noise with dynamics of its own: nothing to do with u.
    Identified const coloured = identified(u,
                                           simulate({.a = {}, .b = {{1, 0.5}}, .delay = 0, .c = 0}, {u},
                                                    scaled(coloured_noise(900, {-0.9}, Seed{3}), 0.3)),
                                           {.na = 0, .nb = {1}});
    EXPECT_FALSE(coloured.ljung_box.white());
    std::string const own_dynamics = fmt::format("{} --delay --forgetting 0.99", coloured.ljung_box.lags);
    EXPECT_THAT(coloured.remarks, Contains(Says(Rank::whiteness, own_dynamics)));
    // Order 1 of a system of order 3: they follow u.
    Identified const low =
        identified(u, simulate(order_three, {u}, scaled(white_noise(900, Seed{3}), 0.02)), {.order = 1});
    EXPECT_FALSE(low.ljung_box.white());
    EXPECT_THAT(low.remarks, Contains(Says(Rank::order, "past u --order 2")));
    EXPECT_THAT(low.remarks, Not(Contains(Says(Rank::whiteness, own_dynamics))));
    Identified const right =
        identified(u, simulate(order_three, {u}, scaled(white_noise(900, Seed{3}), 0.02)), {.order = 3});
    EXPECT_TRUE(right.ljung_box.white());
    EXPECT_THAT(right.warnings(), IsEmpty());
}
/// A model whose structure was given and that nothing else is wrong with.
Identified unremarkable() {
    Identified m{};
    m.options.inputs = {"u"}, m.options.output = "y", m.options.order = 1, m.options.delay = {0};
    m.order = 1;
    m.ljung_box = {10, 0.5, 25, 24};
    m.bound = 0.3;
    return m;
}
/// The bound is simultaneous: one lag beyond it is a trace of the input, whether the residuals pass for white or not.
TEST_F(Advice, ResidualsThatFollowAnInputAreNamedWhiteOrNot) {
    auto const of_two_lags = [] {
        Identified m = unremarkable();
        m.terms = {{"b0", "u[k]", 0, 0}, {"b1", "u[k-1]", 0, 1}};
        m.parameters = {{"b0", "u[k]", 1, 0.1, 0.8, 1.2}, {"b1", "u[k-1]", 1, 0.1, 0.8, 1.2}};
        return m;
    };
    for (double const p : {0.5, 1e-4}) {
        Identified m = of_two_lags();
        m.ljung_box.p = p;
        m.past_inputs = {{0, 3, -0.5, 0.4, 1}};
        m.remarks = remarks_on(m);
        ASSERT_EQ(m.warnings().size(), p < 0.01 ? 2u : 1u);
        EXPECT_THAT(m.remarks[0], Says(Rank::order, "u -0.5 3 0.4"));
        EXPECT_EQ(m.next(), "--order 2");
        m = of_two_lags();
        m.past_inputs = {{0, 3, -0.5, 0.4, 2}};
        m.remarks = remarks_on(m);
        EXPECT_EQ(m.next(), "--delay 2");
        m = of_two_lags();
        m.ljung_box.p = p;
        m.remarks = remarks_on(m);
        EXPECT_THAT(m.remarks, testing::Conditional(p < 0.01, testing::ElementsAre(Says(Rank::whiteness, "25 --delay")),
                                                    IsEmpty()));
    }
}
/// Of 2000 records of normal residuals 2 are expected to have one, and 12 or more with probability 1e-6.
TEST(AdviceParts, AnOutlierIsWhatNormalResidualsHaveInOneRecordOfAThousand) {
    int found = 0;
    for (std::uint64_t k = 0; k < 2000; ++k) {
        Seed seed{k};
        Signal e(100);
        for (double& x : e)
            x = std::sqrt(-2 * std::log(1 - seed.uniform())) * std::cos(6.283185307179586 * seed.uniform());
        found += outlier_in(e).has_value();
    }
    EXPECT_GT(found, 0);
    EXPECT_LT(found, 12);
    auto const of = [](double size) {
        return outlier_in({1, -1, NAN, size, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1});
    };
    EXPECT_FALSE(of(3));
    ASSERT_TRUE(of(-40));
    EXPECT_EQ(of(-40)->at, 3);
    EXPECT_NEAR(of(-40)->share, 1600.0 / 1618, 1e-15);
    EXPECT_NEAR(of(-40)->deviations, 40 / std::sqrt(1618.0 / 19), 1e-14);
    Signal two(100, 1);
    two[40] = 20, two[41] = -30;
    EXPECT_EQ(outlier_in(two)->at, 41);
    EXPECT_EQ(outlier_in(two, 1)->at, 40) << "whose past output is in the next row";
    EXPECT_FALSE(outlier_in({}));
    EXPECT_FALSE(outlier_in({0, 0}));
    EXPECT_TRUE(outlier_in({0, 0, 1})) << "nothing but this row";
}
TEST(AdviceParts, APoleOnTheUnitCircleIsNamedAsOneOutside) {
    for (std::complex<double> const pole :
         {std::complex<double>(1, 0), {-1, 0}, {0, 1}, {1.001, 0}, {std::nextafter(1, 0), 0}, {-0.999, 0}}) {
        Identified m = unremarkable();
        m.poles = {pole, {0.5, 0}};
        m.remarks = remarks_on(m);
        if (std::abs(pole) >= 1) EXPECT_THAT(m.remarks, Contains(Says(Rank::structure, "pole"))) << pole;
        else EXPECT_THAT(m.warnings(), IsEmpty()) << pole;
    }
}

// --- delay -----------------------------------------------------------------------------------------------------------

TEST(AdviceParts, LeadingCoefficientsThatMayBeZero) {
    std::vector<Term> const terms{{"a1", "", -1, 1},   {"b0", "", 0, 0},    {"b1", "", 0, 1}, {"b2", "", 0, 2},
                                  {"b0[v]", "", 1, 0}, {"b1[v]", "", 1, 1}, {"c", "", -2, 0}};
    auto const parameter = [](double low, double high) { return Parameter{"", "", 0, 1, low, high}; };
    std::vector<Parameter> parameters{parameter(-1, 1), parameter(-1, 1), parameter(0, 2), parameter(1e-9, 2),
                                      parameter(-1, 1), parameter(-2, 0), parameter(-1, 1)};
    EXPECT_EQ(idle_lead(terms, parameters, 0), 2) << "an interval that ends at 0 holds it";
    EXPECT_EQ(idle_lead(terms, parameters, 1), 0) << "all of them: no delay explains that";
    parameters[1] = parameter(-2, -1e-9);
    EXPECT_EQ(idle_lead(terms, parameters, 0), 0);
}
TEST_F(Advice, ADelayIsFound) {
    DifferenceEquation const late{.a = {-0.8}, .b = {{1, 0.5}}, .delay = 3, .c = 0};
    Signal const u = prbs(9, 900), y = simulate(late, {u}, scaled(white_noise(900, Seed{4}), 0.05));
    Identified const m = identified(u, y, {.order = 4});
    EXPECT_THAT(m.remarks, Contains(Says(Rank::delay, "3 u 0 --delay")));
    EXPECT_THAT(as_table(m),
                testing::AllOf(HasSubstr("hint: " + m.hints()[0].substr(0, 30)), HasSubstr("\nnext: --delay 3\n")));
    Identified const then = identified(u, y, {.order = 1, .delay = {3}});
    EXPECT_THAT(then.remarks, Not(Contains(Says(Rank::delay, ""))));
    EXPECT_THAT(then.warnings(), IsEmpty());
    EXPECT_NEAR(then.parameters[1].value, 1, 5 * then.parameters[1].sd);
    EXPECT_EQ(then.parameters[1].regressor, "u[k-3]");
    Identified const once = identified(u, y, {.order = 2, .delay = {2}});
    EXPECT_THAT(once.remarks, Contains(Says(Rank::delay, "u 0 --delay 3")));
}

// --- poles and zeros that cancel -------------------------------------------------------------------------------------

/// One pole 1/2 and one zero 2/5 of z/(z - 1/2) alike: q = 0.1^2 / (sd_a^2 + (sd_b1/b0)^2), against chi^2's quantile of
/// one degree.
TEST(Cancellations, OfRealRootsAreJudgedByTheirStandardDeviations) {
    DifferenceEquation const model{.a = {-0.5}, .b = {{2, -0.8}}, .delay = 0, .c = 0};
    std::vector<Term> const terms{{"a1", "", -1, 1}, {"b0", "", 0, 0}, {"b1", "", 0, 1}, {"c", "", -2, 0}};
    constexpr double quantile = 3.841458820694124;  // 95 %
    for (double const off : {0.999, 1.001}) {
        double const S = 0.01 / quantile * off, sd_a = std::sqrt(0.36 * S), sd_b1 = 2 * std::sqrt(0.64 * S);
        Uncertainty const e{Vector<double>{{sd_a, 0, sd_b1, 7}}, Matrix<double>::Identity(4, 4)};
        auto const found = cancellations(model, terms, e, 0.95);
        ASSERT_EQ(found.size(), off > 1 ? 1u : 0u) << off;
        if (off < 1) continue;
        EXPECT_NEAR(found[0].pole.real(), 0.5, 1e-15);
        EXPECT_NEAR(found[0].zero.real(), 0.4, 1e-15);
        EXPECT_NEAR(found[0].distance, 0.1, 1e-15);
        EXPECT_NEAR(found[0].sd, std::sqrt(S), 1e-15);
        EXPECT_TRUE(cancellations(model, terms, e, 0.94).empty());
    }
    // Errors that move both alike: with correlation c the variance of the difference is sd_p^2 + sd_z^2 - 2 c sd_p
    // sd_z.
    Matrix<double> correlation = Matrix<double>::Identity(4, 4);
    correlation(0, 2) = correlation(2, 0) = 0.96;
    EXPECT_EQ(
        cancellations(model, terms, {Vector<double>{{0.2, 0, 0.4, 0}}, Matrix<double>::Identity(4, 4)}, 0.95).size(),
        1u);
    auto const together = cancellations(model, terms, {Vector<double>{{0.2, 0, 0.4, 0}}, correlation}, 0.95);
    ASSERT_EQ(together.size(), 1u);
    EXPECT_NEAR(together[0].sd, std::sqrt(0.08 - 0.08 * 0.96), 1e-14);
}

/// A pair of complex poles and zeros: gradient and quantile by finite differences and closed form.
TEST(Cancellations, OfComplexRootsAreJudgedInTwoDimensions) {
    DifferenceEquation const model{.a = {-1.2, 0.7}, .b = {{0.5, -0.62, 0.37}}, .delay = 2, .c = 0};
    std::vector<Term> const terms{
        {"a1", "", -1, 1}, {"a2", "", -1, 2}, {"b0", "", 0, 2}, {"b1", "", 0, 3}, {"b2", "", 0, 4}};
    Vector<double> const theta{{-1.2, 0.7, 0.5, -0.62, 0.37}};
    Matrix<double> correlation = Matrix<double>::Identity(5, 5);
    correlation(0, 1) = correlation(1, 0) = -0.7, correlation(0, 3) = correlation(3, 0) = 0.3;
    Uncertainty const e{Vector<double>{{0.02, 0.03, 0.01, 0.03, 0.02}}, correlation};
    auto const difference = [](Vector<double> const& t) {
        DifferenceEquation const m{.a = {t[0], t[1]}, .b = {{t[2], t[3], t[4]}}, .delay = 2, .c = 0};
        return poles(m)[0] - zeros(m)[0];
    };
    Matrix<double> slope(2, 5);
    for (Index i = 0; i < 5; ++i) {
        Vector<double> up = theta, down = theta;
        up[i] += 1e-6, down[i] -= 1e-6;
        auto const by = (difference(up) - difference(down)) / 2e-6;
        slope(0, i) = by.real() * e.sd[i], slope(1, i) = by.imag() * e.sd[i];
    }
    Matrix<double> const S = slope * correlation * slope.transpose();
    auto const delta = difference(theta);
    Vector<double> const x{{delta.real(), delta.imag()}};
    double const q = (x(0) * x(0) * S(1, 1) - 2 * x(0) * x(1) * S(0, 1) + x(1) * x(1) * S(0, 0)) /
                     (S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0));
    ASSERT_GT(q, 0.5);
    double const at = 1 - std::exp(-q / 2);  // the confidence at which q is the quantile
    EXPECT_TRUE(cancellations(model, terms, e, at - 1e-5).empty());
    auto const found = cancellations(model, terms, e, at + 1e-5);
    ASSERT_EQ(found.size(), 1u) << "a pair has one remark";
    EXPECT_NEAR(found[0].sd, std::sqrt(S(0, 0) + S(1, 1)), 1e-8);
    EXPECT_NEAR(found[0].distance, std::abs(delta), 1e-14);
    EXPECT_GT(found[0].pole.imag(), 0);
}
TEST(Cancellations, AreJudgedOnlyWhereTheRootsAreKnown) {
    // Poles 0.5 and 0.5 + g: known to within half their distance g/2, or not. sd of p_1 = 0.5 by a_2 alone: sd / g.
    std::vector<Term> const terms{{"a1", "", -1, 1}, {"a2", "", -1, 2}, {"b0", "", 0, 0}, {"b1", "", 0, 1}};
    double const g = 0.2;
    DifferenceEquation const model{.a = {-(1 + g), 0.5 * (0.5 + g)}, .b = {{1, -0.5}}, .delay = 0, .c = 0};
    for (double const off : {0.99, 1.01}) {
        Uncertainty const e{Vector<double>{{0, g * g / 2 * off, 0, 0.01}}, Matrix<double>::Identity(4, 4)};
        EXPECT_EQ(cancellations(model, terms, e, 0.95).size(), off < 1 ? 1u : 0u) << off;
    }
}
TEST(Cancellations, OfSeveralInputsAreThoseOfAll) {
    std::vector<Term> const terms{
        {"a1", "", -1, 1}, {"b0", "", 0, 0}, {"b1", "", 0, 1}, {"b0", "", 1, 0}, {"b1", "", 1, 1}};
    Uncertainty const e{Vector<double>::Constant(5, 0.01), Matrix<double>::Identity(5, 5)};
    EXPECT_EQ(cancellations({.a = {-0.5}, .b = {{1, -0.5}, {2, -1}}, .delay = 0, .c = 0}, terms, e, 0.95).size(), 1u);
    EXPECT_EQ(cancellations({.a = {-0.5}, .b = {{1, -0.5}, {2, 1}}, .delay = 0, .c = 0}, terms, e, 0.95).size(), 0u);
    EXPECT_EQ(cancellations({.a = {-0.5}, .b = {{0, 1}, {2, -1}}, .delay = 0, .c = 0}, terms, e, 0.95).size(), 0u)
        << "no zero at all";
}
TEST_F(Advice, PolesAndZerosThatCancelNameTheLowerOrder) {
    // Order 1, fitted as order 2: the residuals of order 1 are white, too.
    DifferenceEquation const one{.a = {-0.8}, .b = {{1, 0.5}}, .delay = 0, .c = 0};
    Signal const u = prbs(9, 900), y = simulate(one, {u}, scaled(white_noise(900, Seed{4}), 0.3));
    Identified const m = identified(u, y, {.order = 2});
    ASSERT_EQ(m.cancellations.size(), 1u);
    EXPECT_THAT(m.remarks, Contains(Says(Rank::structure, "pole zero --order 1")));
    EXPECT_THAT(identified(u, y, {.order = 1}).warnings(), IsEmpty());
    EXPECT_THAT(identified(u, y, {.na = 2, .nb = {2}}).remarks, Contains(Says(Rank::structure, "pole zero --na --nb")));
    // Noise of order 2 beside a path of order 1: the pair models the noise, and order 1 alone is not white.
    DifferenceEquation const both{.a = {-0.8 + 1.0, 0.8 - 0.8, -0.64},
                                  .b = {{1, 1.0, 0.8}},
                                  .delay = 0,
                                  .c = 0};  // (1 - 0.8/z)(1 + 1/z + 0.8/z^2)
    Identified const with_noise =
        identified(u, simulate(both, {u}, scaled(white_noise(900, Seed{6}), 0.3)), {.order = 3});
    ASSERT_FALSE(with_noise.cancellations.empty());
    EXPECT_THAT(with_noise.warnings(), Not(Contains(Names("pole zero"))));
    EXPECT_THAT(with_noise.hints(), Contains(Names("3 pole zero 1")));
}

// --- gain and poles --------------------------------------------------------------------------------------------------

TEST(Gains, AreNotGivenWhereAPoleMayLieAtOne) {
    std::vector<Term> const terms{{"a1", "", -1, 1}, {"b0", "", 0, 0}};
    DifferenceEquation const model{.a = {-0.9}, .b = {{2}}, .delay = 0, .c = 0};  // A(1) = 0.1
    auto const of = [&](double sd_a, double t) {
        return gain_of(model, terms, {Vector<double>{{sd_a, 0.5}}, Matrix<double>::Identity(2, 2)}, 0, t);
    };
    EXPECT_NEAR(of(0.0499, 2).first, 20, 1e-12);
    EXPECT_NEAR(of(0.01, 2).second, std::sqrt(25 + 4), 1e-12) << "(0.5 / 0.1)^2 + (20 / 0.1 x 0.01)^2";
    EXPECT_TRUE(std::isnan(of(0.0501, 2).first));
    EXPECT_TRUE(std::isnan(of(0.0499, 2.01).first));
}
TEST_F(Advice, APoleOutsideTheCircleIsNamed) {
    Signal const u = prbs(9, 200), y = simulate({.a = {-1.02}, .b = {{0, 1}}, .delay = 0, .c = 0}, {u},
                                                scaled(white_noise(200, Seed{8}), 0.1));
    Identified const m = identified(u, y, {.order = 1, .detrend = false});
    ASSERT_GE(std::abs(m.poles[0]), 1);
    EXPECT_THAT(m.remarks, Contains(Says(Rank::structure, "pole")));
    EXPECT_THAT(as_table(m), Not(HasSubstr("time constant"))) << "it has none";
}

// --- a standstill ----------------------------------------------------------------------------------------------------

TEST_F(Advice, AStandstillAtTheStartIsNamedFromTwentyOneSamplesOn) {
    for (size_t const constant : {20u, 21u}) {
        Signal u = white_noise(600, Seed{5});
        for (size_t k = 0; k < constant; ++k) u[k] = 0.5;
        Identified const m =
            identified(u, simulate(order_three, {u}, scaled(white_noise(600, Seed{1}), 0.05)), {.order = 3});
        EXPECT_EQ(m.excitation[0].constant_at_start, Index(constant));
        EXPECT_EQ(testing::Value(m.remarks, Contains(Says(Rank::whiteness, "u 21 400"))), constant == 21);
    }
}

}  // namespace
}  // namespace rlslab
