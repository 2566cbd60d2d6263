// The parts that `identify` judges by, each beside closed forms, counts and fits by another hand: outliers, remarks,
// delays, poles and zeros that cancel, gains, sums of recursive residuals, limits of noise models.
#include "src/lab/identify/validate.hpp"
#include "tests/identify/said.hpp"

#include <rlslab/model/fit.hpp>
#include <rlslab/model/outliers.hpp>

#include <Eigen/Cholesky>

namespace rlslab {
using namespace identify;
namespace {

using Rank = Remark::Rank;
using testing::Contains;
using testing::IsEmpty;

/// A remark of this rank that names these things.
MATCHER_P2(Says, rank, things, "") {
    return arg.rank == rank && testing::ExplainMatchResult(Names(things), arg.sentence, result_listener);
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
TEST(AdviceParts, ResidualsThatFollowAnInputAreNamedWhiteOrNot) {
    auto const of = [](double p, std::vector<PastInput> past) {
        Identified m = unremarkable();
        m.terms = {{"b0", "u[k]", 0, 0}, {"b1", "u[k-1]", 0, 1}};
        m.parameters = {{"b0", "u[k]", 1, 0.1, 0.8, 1.2}, {"b1", "u[k-1]", 1, 0.1, 0.8, 1.2}};
        m.ljung_box.p = p, m.past_inputs = std::move(past);
        m.remarks = remarks_on(m);
        return m;
    };
    for (double const p : {0.5, 1e-4}) {
        Identified const m = of(p, {{0, 3, -0.5, 0.4, 1}});
        ASSERT_EQ(m.warnings().size(), p < 0.01 ? 2u : 1u);
        EXPECT_THAT(m.remarks[0], Says(Rank::order, "u -0.5 3 0.4"));
        EXPECT_EQ(m.next(), "--order 2");
        EXPECT_EQ(of(p, {{0, 3, -0.5, 0.4, 2}}).next(), "--delay 2");
    }
    EXPECT_THAT(of(0.5, {}).remarks, IsEmpty());
    EXPECT_THAT(of(1e-4, {}).remarks, testing::ElementsAre(Says(Rank::whiteness, "25 --delay")));
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
    EXPECT_FALSE(outlier_in({1, -1, INFINITY})) << "in units of what?";
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

// --- noise models ----------------------------------------------------------------------------------------------------

/// d = 1 by hand: A = sum phi z / sum phi^2, variance sigma^2 P / (2 A - 1). C = 1: sigma^2 P.
TEST(NoiseLimit, IsThatOfOneParameterByHand) {
    Matrix<double> const phi{{1, -2, 0, 3}}, P{{1 / 14.0}};
    EXPECT_NEAR(limit_deviations(phi, {}, P, 4)[0], std::sqrt(4 / 14.0), 1e-15);
    double const A = (1 - 2 * (-2 - 0.5) + 3 * (3 - 0.5 * (0 - 0.5 * -2.5))) / 14;
    EXPECT_NEAR(limit_deviations(phi, {0.5}, P, 4)[0], std::sqrt(4 / 14.0 / (2 * A - 1)), 1e-14);
    EXPECT_TRUE(std::isnan(limit_deviations(Matrix<double>{{1, 1}}, {1.5}, Matrix<double>{{0.5}}, 1)[0])) << "A = 1/4";
}
TEST(FarthestFromOne, IsThatOfAllFrequencies) {
    EXPECT_EQ(farthest_from_one({-0.5}), 0.5);
    EXPECT_EQ(farthest_from_one({0.5, -0.75}), 1.25);
    EXPECT_NEAR(farthest_from_one({0.3, 0.2, 0.1}), 0.6, 1e-15);
    EXPECT_NEAR(farthest_from_one({0, 0, 0, -0.9}), 0.9, 1e-15);
    double most = 0;
    for (int k = 0; k < 100000; ++k) {
        double const w = 3.141592653589793 * k / 100000;
        most = std::max(most, std::abs(0.5 - 0.4 * std::polar(1.0, w) + 0.3 * std::polar(1.0, 2 * w)));
    }
    EXPECT_NEAR(farthest_from_one({0.5, -0.4, 0.3}), most, 2e-3 * most);
}

// --- sums of recursive residuals -------------------------------------------------------------------------------------

/// P(1/2 - U > c) for one number; for five a count over 100000 draws, with four of its standard deviations.
TEST(SquaresLine, TailIsThatOfTheLargestExcess) {
    for (double const c : {0.1, 0.25, 0.49}) EXPECT_NEAR(tail_of_largest_excess(1, c), 0.5 - c, 1e-15);
    constexpr int draws = 100000, n = 5;
    Seed seed{3};
    for (double const c : {0.2, 0.4}) {
        int beyond = 0;
        for (int i = 0; i < draws; ++i) {
            std::array<double, n> U;
            for (double& u : U) u = seed.uniform();
            std::ranges::sort(U);
            bool is = false;
            for (int j = 0; j < n; ++j) is |= (j + 1) / double(n + 1) - U[size_t(j)] > c;
            beyond += is;
        }
        double const tail = tail_of_largest_excess(n, c);
        EXPECT_NEAR(double(beyond) / draws, tail, 4 * std::sqrt(tail * (1 - tail) / draws)) << c;
    }
}
TEST(SquaresLine, SolvesTheTailAndPassesIntoTheFormula) {
    for (double const tail : {0.025, 0.005}) {
        for (Index m = 6; m <= 1000; ++m) {
            double const c = squares_line(m, tail), off = m < 120 ? 1e-12 : 1e-4;
            EXPECT_LT(squares_line(m + 1, tail), c) << m;
            if (m % 2 || m == 120) continue;
            EXPECT_GT(tail_of_largest_excess(m / 2 - 1, c - off), tail) << m;
            EXPECT_LT(tail_of_largest_excess(m / 2 - 1, c + off), tail) << m;
        }
    }
    EXPECT_THROW(squares_line(3, 0.025), std::invalid_argument);
    EXPECT_THROW(squares_line(100, 0.05), std::invalid_argument);
}

/// N rows of d regressors, with this theta up to row `change` and `after` from there on.
Records record(std::uint64_t seed, Index N, Index change, Vector<double> const& theta, Vector<double> const& after) {
    Index const d = theta.size();
    Signal const x = white_noise(N * d, Seed{seed}), e = white_noise(N, Seed{seed + 50000});
    Records out{.psi = Matrix<double>(d, N), .y = Vector<double>(N), .names = {}};
    for (Index k = 0; k < N; ++k) {
        for (Index i = 0; i < d; ++i) out.psi(i, k) = i == 0 ? 1 : x[size_t(k * d + i)];
        out.y[k] = out.psi.col(k).dot(k < change ? theta : after) + e[size_t(k)];
    }
    return out;
}
std::vector<Index> counted(Index N) {
    std::vector<Index> out;
    for (Index k = 0; k < N; ++k) out.push_back(k);
    return out;
}
Vector<double> const theta{{1, -0.5, 2}};

/// Each w from a batch fit of the rows before; J is that of all rows.
TEST(Constancy, ResidualsAreThoseOfFitsOfTheRowsBefore) {
    constexpr Index N = 40, d = 3;
    Records const rows = record(1, N, N, theta, theta);
    Constancy const c = constancy(rows, counted(N), 0);
    ASSERT_EQ(c.residuals.size(), size_t(N - d));
    EXPECT_EQ(c.samples.front(), d);
    double J = 0;
    for (Index k = d; k < N; ++k) {
        Records const before{.psi = rows.psi.leftCols(k), .y = rows.y.head(k), .names = {}};
        Matrix<double> const M = before.psi * before.psi.transpose();
        Vector<double> const at = M.ldlt().solve(before.psi * before.y), psi = rows.psi.col(k);
        double const f = 1 + psi.dot(M.ldlt().solve(psi)), w = (rows.y[k] - psi.dot(at)) / std::sqrt(f);
        EXPECT_NEAR(c.residuals[size_t(k - d)], w, 1e-10) << k;
        J += w * w;
    }
    EXPECT_NEAR(J, fit(rows).J, 1e-10);
    EXPECT_NEAR(c.squares.value.back(), 1, 1e-15);
    double const m = N - d;
    EXPECT_NEAR(c.cusum.upper.front(), 0.948 * std::sqrt(m) * (1 + 2 / m), 1e-12);
    EXPECT_NEAR(c.cusum.upper.back(), 3 * 0.948 * std::sqrt(m), 1e-12);
    EXPECT_NEAR(c.squares.upper[9] - 10 / m, c.c0, 1e-15);
    EXPECT_NEAR(c.squares.lower[9] - 10 / m, -c.c0, 1e-15);
}
/// A regressor that is 0 at first determines theta later; nothing counts before.
TEST(Constancy, BeginsWhereTheRowsDetermineTheta) {
    Records rows = record(1, 40, 40, theta, theta);
    for (Index k = 0; k < 10; ++k) rows.psi(2, k) = 0;
    Constancy const c = constancy(rows, counted(40), 0);
    EXPECT_EQ(c.samples.front(), 11) << "row 10 is the first with all three";
    EXPECT_TRUE(constancy(record(1, 6, 6, theta, theta), counted(6), 0).samples.empty()) << "three residuals";
    EXPECT_FALSE(constancy(record(1, 7, 7, theta, theta), counted(7), 0).samples.empty());
    EXPECT_TRUE(constancy(record(1, 40, 40, theta, theta), counted(40), 1e9).samples.empty()) << "rounding alone";
    rows.y[20] = INFINITY;
    EXPECT_TRUE(constancy(rows, counted(40), 0).samples.empty());
}
TEST(Constancy, UnitsChangeNothing) {
    Records const rows = record(1, 60, 60, theta, theta);
    Constancy const c = constancy(rows, counted(60), 0);
    for (int const e : {-400, 400}) {
        Records scaled = rows;
        scaled.y *= std::ldexp(1, e);
        Constancy const of = constancy(scaled, counted(60), 0);
        EXPECT_EQ(of.cusum.value, c.cusum.value) << e;
        EXPECT_EQ(of.squares.value, c.squares.value) << e;
    }
}
/// Without a change about 5 % of the paths leave their lines, and with one nearly all. 2000 records of 120 rows: a
/// share of 0.05 has the standard deviation 0.005, and the budget is four of these. The line of the sum is approximate;
/// the squares are looked at in each row, while their line is exact for each second one.
TEST(Constancy, LeavesItsLinesAsOftenAsTheirLevelSays) {
    constexpr Index N = 120;
    auto const of = [](std::uint64_t seed, Vector<double> const& change) {
        return constancy(record(seed, N, 60, theta, theta + change), counted(N), 0);
    };
    double sum = 0, squares = 0, sum_surely = 0, squares_surely = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Constancy const c = of(i, Vector<double>::Zero(3));
        sum += c.cusum.crosses.has_value() / 2000., squares += c.squares.crosses.has_value() / 2000.;
        sum_surely += c.cusum.surely / 2000., squares_surely += c.squares.surely / 2000.;
    }
    EXPECT_GT(sum, 0.02);
    EXPECT_LT(sum, 0.05 + 4 * 0.005);
    EXPECT_GT(squares, 0.05 - 4 * 0.005);
    EXPECT_LT(squares, 0.05 + 4 * 0.005 + 0.01) << "each row, not each second one";
    EXPECT_LT(sum_surely, 0.01 + 4 * 0.0022);
    EXPECT_LT(squares_surely, 0.01 + 4 * 0.0022 + 0.003);
    int of_mean = 0, of_slope = 0, near = 0;
    for (std::uint64_t i = 0; i < 200; ++i) {
        Constancy const slope = of(i, Vector<double>{{0, 3, 0}});
        of_mean += of(i, Vector<double>{{2, 0, 0}}).cusum.surely, of_slope += slope.squares.surely;
        near += std::abs(slope.samples[size_t(slope.squares.farthest)] - 60) <= 5;
    }
    EXPECT_GT(of_mean, 190);
    EXPECT_GT(of_slope, 190);
    EXPECT_GT(near, 160) << "the row of the change";
}

}  // namespace
}  // namespace rlslab
