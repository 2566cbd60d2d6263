// Excitation, signals and equations: closed forms, rationals, thresholds from both sides; and orders of excitation that
// a user can rely on.
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/model/difference.hpp>
#include <rlslab/model/excitation.hpp>
#include <rlslab/reference/certified.hpp>

#include <gtest/gtest.h>
#include <fmt/format.h>

#include <cmath>

namespace rlslab {
namespace {

// --- order, eigenvalue, condition ------------------------------------------------------------------------------------

TEST(ExcitationNumbers, OrderTwoByHand) {
    // v_k = [x_k, x_(k-1)], k = 1 ... 4, of 1, 2, -1, 3, 0: sum x_k^2 = 4 + 1 + 9 + 0 = 14, sum x_(k-1)^2 = 1 + 4 + 1 +
    // 9 = 15, sum x_k x_(k-1) = 2 - 2 - 3 + 0 = -3.
    Signal const x{1, 2, -1, 3, 0};
    double const mean = 14.5, root = std::sqrt(0.25 + 9), least = mean - root, largest = mean + root;
    Excitation const e = excitation(x, 2);
    ASSERT_EQ(e.orders.size(), 2u);
    EXPECT_NEAR(e.orders[0].least, 15.0 / 5, 1e-12) << "the mean square";
    EXPECT_NEAR(e.orders[0].condition, 1, 1e-12);
    EXPECT_NEAR(e.orders[1].least, least / 4, 1e-11);
    EXPECT_NEAR(e.orders[1].condition, std::sqrt(largest / least), 1e-11);
    EXPECT_EQ(e.order, 2);
    EXPECT_EQ(e.exact_order, 2);
    Matrix<double> const R = correlation_matrix(x, 2);
    EXPECT_EQ(R, (Matrix<double>{{14.0 / 4, -3.0 / 4}, {-3.0 / 4, 15.0 / 4}}));
    EXPECT_EQ(correlation(x, x, 2), (Signal{15.0 / 5, -3.0 / 5, (-1.0 + 6 + 0) / 5}));
    EXPECT_THROW(correlation_matrix(x, 6), std::invalid_argument);
    EXPECT_THROW(correlation(x, x, 5), std::invalid_argument);
    EXPECT_THROW(correlation(x, {1}, 0), std::invalid_argument);
}
TEST(ExcitationNumbers, OfOnePeriodOfAMaximalRegister) {
    // The n x n Gram matrix over whole periods of M = 31 has the eigenvalues M + 1 (n - 1 times) and M + 1 - n for each
    // period.
    Signal const u = prbs(5, 31 + 4);  // 31 windows of 5
    Excitation const e = excitation(u, 5);
    ExcitationOrder const& five = e.orders[4];
    EXPECT_NEAR(five.least, 27.0 / 31, 1e-11);
    EXPECT_NEAR(five.condition, std::sqrt(32.0 / 27), 1e-11);
}
TEST(ExcitationNumbers, EndAtTheFirstOrderThatIsSingular) {
    Signal const u{1, -1, 1, -1, 1, -1, 1, -1};
    Excitation const e = excitation(u, 4);
    EXPECT_EQ(e.order, 1);
    EXPECT_EQ(e.exact_order, 1);
    ASSERT_EQ(e.orders.size(), 2u);
    EXPECT_FALSE(e.orders[1].definite);
    EXPECT_EQ(e.orders[1].condition, INFINITY);
    EXPECT_EQ(e.orders[1].least, 0);
    EXPECT_EQ(excitation({1, 2, 4}, 9).orders.size(), 2u) << "3 samples are 2 windows of 2, too few for 3";
    EXPECT_EQ(excitation({1, 2, 4, 3}, 9).orders.size(), 2u);
    EXPECT_EQ(excitation({1, 2, 4, 3, 1}, 9).orders.size(), 3u);
    EXPECT_THROW(excitation({}, 1), std::invalid_argument);
    EXPECT_THROW(excitation({1, 2}, 0), std::invalid_argument);
}
TEST(ExcitationNumbers, AStandstillIsCountedFromTheStart) {
    EXPECT_EQ(excitation({1, 2, 3}, 1).constant_at_start, 0);
    EXPECT_EQ(excitation({1, 1, 3}, 1).constant_at_start, 2);
    EXPECT_EQ(excitation({1, 1, 3, 3, 3}, 1).constant_at_start, 2);
    EXPECT_EQ(excitation({1, 1, 1}, 1).constant_at_start, 3);
}

// --- resolution ------------------------------------------------------------------------------------------------------

Signal levels(size_t n, double unit, size_t repeat = 3) {
    Signal out;
    for (size_t r = 0; r < repeat; ++r)
        for (size_t k = 0; k < n; ++k) out.push_back(unit * double((11 * k) % n));
    return out;
}
double resolution(Signal const& x) { return excitation(x, 1).resolution; }

TEST(Resolution, IsTheDecimalsOfTheFile) {
    Signal x = levels(31, 1);
    EXPECT_EQ(resolution(x), 1);
    for (double& v : x) v = std::round(10 * v) / 1000;
    EXPECT_EQ(resolution(x), 0.01);
    x[3] = 0.123456;
    EXPECT_NEAR(resolution(x), 0.01, 1e-4) << "of one number in a hundred";
    for (double& v : x) v += 0.123456789012;
    EXPECT_NEAR(resolution(x), 1e-12, 1e-13);
    for (double& v : x) v = std::round(v * 100) * 1000;
    EXPECT_GE(resolution(x), 100) << "whole thousands";
}
TEST(Resolution, OfTwentyLevelsIsThatOfBinary64AndOfTwentyOneTheUnit) {
    EXPECT_EQ(resolution(levels(20, 1)), 0x1p-42 * 19);
    EXPECT_EQ(resolution(levels(21, 1)), 1);
}
TEST(Resolution, OfAConverterIsItsStep) {
    // Steps of 1/3 are no decimals: the smallest distance, where 99 % are multiples of it.
    Signal x = levels(50, 1.0 / 3, 4);
    EXPECT_NEAR(resolution(x), 1.0 / 3, 1e-12);
    // Distances of x + 1/6 from a multiple: 2 of 200 may be off, 3 may not.
    Signal two = x, three = x;
    for (size_t k : {5u, 6u, 7u}) {
        double const off = 1.0 / 6;
        if (k < 7) two[k] = 100 + double(k) + off;
        three[k] = 100 + double(k) + off;
    }
    EXPECT_NEAR(resolution(two), 1.0 / 3, 1e-9);
    EXPECT_LT(resolution(three), 1e-9);
    EXPECT_EQ(resolution(levels(50, std::sqrt(2.0), 4)) > 1, true);
    EXPECT_EQ(
        resolution(white_noise(400, Seed{1})), 0x1p-42 *
                                                   [] {
                                                       double most = 0;
                                                       for (double const v : white_noise(400, Seed{1}))
                                                           most = std::max(most, std::abs(v));
                                                       return most;
                                                   }())
        << "numbers of a program: a thousand of binary64's roundings";
}
TEST(Resolution, LeastEigenvaluesBelowFourTimesItsNoiseSayNothing) {
    // Whole numbers q = 1: rounding adds 1/12, what counts is above 4/12. A sine of 100 and white noise of variance v:
    // the least eigenvalue of order 3 is about v + 1/12.
    for (double const variance : {0.16, 0.36}) {
        Signal x = white_noise(4000, Seed{6});
        for (size_t k = 0; k < x.size(); ++k)
            x[k] = std::round(100 * std::sin(0.5 * double(k)) + std::sqrt(variance) * x[k]);
        ExcitationOrder const three = excitation(x, 3).orders[2];
        ASSERT_NEAR(three.least, variance + 1.0 / 12, 0.03);
        EXPECT_EQ(three.resolved, three.least > 4.0 / 12);
        EXPECT_EQ(three.resolved, variance > 0.25);
        EXPECT_TRUE(variance > 0.25 ? three.least < 5.0 / 12 + 0.07 : three.least > 2.5 / 12)
            << "near the threshold, or nothing is shown";
        EXPECT_EQ(excitation(x, 3).order, variance > 0.25 ? 3 : 2);
        EXPECT_EQ(excitation(x, 3).exact_order, 3);
    }
}
/// The threshold itself: order 1's eigenvalue is the mean square, set to a little below and above 4 q^2/12.
TEST(Resolution, TheThresholdIsAThird) {
    for (double const target : {0.33, 0.337}) {
        // Levels -12 ... 12 make the file's unit 1; zeros bring the mean square down.
        Signal x;
        double sum = 0;
        for (int level = -12; level <= 12; ++level) x.push_back(level), sum += level * level;
        x.resize(size_t(std::round(sum / target)), 0.0);
        Excitation const e = excitation(x, 1);
        EXPECT_EQ(e.resolution, 1);
        EXPECT_NEAR(e.orders[0].least, target, 1e-3);
        EXPECT_EQ(e.orders[0].resolved, target > 1.0 / 3);
        EXPECT_EQ(e.order, target > 1.0 / 3 ? 1 : 0);
    }
}

// --- signals ---------------------------------------------------------------------------------------------------------

TEST(SignalNumbers, ColouredNoiseIsItsRecursion) {
    Signal const w = white_noise(9, Seed{4}), x = coloured_noise(5, {-0.5, 0.25}, Seed{4}, 4);
    Signal full(9, 0.0);
    for (size_t k = 0; k < 9; ++k) full[k] = w[k] + (k > 0 ? 0.5 * full[k - 1] : 0) - (k > 1 ? 0.25 * full[k - 2] : 0);
    for (size_t k = 0; k < 5; ++k) EXPECT_DOUBLE_EQ(x[k], full[k + 4]);
    EXPECT_EQ(coloured_noise(3, {0.5}, Seed{4}), coloured_noise(3, {0.5}, Seed{4}, 1000)) << "1000 samples to settle";
    EXPECT_THROW(coloured_noise(-1, {}, Seed{4}), std::invalid_argument);
    EXPECT_THROW(coloured_noise(1, {}, Seed{4}, -1), std::invalid_argument);
    EXPECT_THROW(white_noise(-1, Seed{4}), std::invalid_argument);
}
TEST(SignalNumbers, WhiteNoiseIsASumOfTwelveUniforms) {
    Seed seed{77}, copy{77};
    for (int i = 0; i < 100; ++i) {
        double sum = -6;
        for (int j = 0; j < 12; ++j) sum += double(copy.next() >> 16) * 0x1p-48;
        EXPECT_NEAR(seed.bell(), sum, 1e-14);
    }
    double mean = 0, square = 0, fourth = 0;
    Signal const x = white_noise(200000, Seed{5});
    for (double const v : x) mean += v / 2e5, square += v * v / 2e5, fourth += v * v * v * v / 2e5;
    EXPECT_NEAR(mean, 0, 5 / std::sqrt(2e5));
    EXPECT_NEAR(square, 1, 5 * std::sqrt(1.9 / 2e5));
    EXPECT_NEAR(fourth, 3 - 0.1, 0.1) << "twelve uniforms: excess -6/5/12";
}
TEST(SignalNumbers, AMultisineIsItsSum) {
    Index const n = 50;
    int const H = 7;
    Signal const u = multisine(n, H);
    for (Index k : {0, 1, 13, 49}) {
        long double sum = 0;
        long double const pi = std::acos(-1.0L);
        for (int h = 1; h <= H; ++h)
            sum += std::cos(2 * pi * (long double)(h * k) / n - pi * (long double)(h * (h - 1)) / H);
        EXPECT_NEAR(u[size_t(k)], double(sum * std::sqrt(2.0L / H)), 1e-15);
    }
    EXPECT_NO_THROW(multisine(50, 24));
    EXPECT_THROW(multisine(50, 25), std::invalid_argument);
    EXPECT_THROW(multisine(50, 0), std::invalid_argument);
}
TEST(SignalNumbers, ARegisterHoldsItsLevels) {
    Signal const u = prbs(4, 60), held = prbs(4, 60, 3);
    for (size_t k = 0; k < 60; ++k) EXPECT_EQ(held[k], u[k / 3]);
    EXPECT_EQ(u[0], 1) << "all cells are 1 at first";
    EXPECT_THROW(prbs(4, -1), std::invalid_argument);
    EXPECT_THROW(prbs(4, 5, 0), std::invalid_argument);
}
TEST(SignalNumbers, StepsLastAsLongAsTheyMay) {
    Signal const x = random_steps(6000, 3, 6, Seed{2});
    std::vector<int> lengths(10, 0);
    size_t run = 1;
    double least = 1, most = -1, mean = 0;
    for (size_t k = 1; k < x.size(); ++k) {
        least = std::min(least, x[k]), most = std::max(most, x[k]), mean += x[k] / 6000;
        if (x[k] == x[k - 1]) {
            ++run;
            continue;
        }
        ASSERT_LT(run, 10u);
        ++lengths[run];
        run = 1;
    }
    for (size_t n = 0; n < 10; ++n) EXPECT_EQ(lengths[n] > 0, 3 <= n && n <= 6) << n;
    EXPECT_LT(least, -0.98);
    EXPECT_GT(most, 0.98);
    EXPECT_NEAR(mean, 0, 0.1);
    EXPECT_THROW(random_steps(5, 0, 3, Seed{2}), std::invalid_argument);
    EXPECT_THROW(random_steps(5, 4, 3, Seed{2}), std::invalid_argument);
}

// --- the difference equation -----------------------------------------------------------------------------------------

TEST(DifferenceNumbers, SimulatesItsEquation) {
    // y[k] = 0.5 y[k-1] - 0.25 y[k-2] + 2 u[k-1] + u[k-2] - v[k-1] + 0.125 + xi[k]: by hand.
    DifferenceEquation const m{.a = {-0.5, 0.25}, .b = {{2, 1}, {-1}}, .delay = 1, .c = 0.125};
    Signal const u{1, 2, 0, -1}, v{4, 0, 8, 0}, xi{1, 0, 0, 2};
    EXPECT_EQ(simulate(m, {u, v}, xi), (Signal{1.125, 0.5625 + 2 - 4 + 0.125, 0.5 * -1.3125 - 0.28125 + 4 + 1 + 0.125,
                                               0.5 * 4.1875 + 0.25 * 1.3125 + 2 - 8 + 0.125 + 2}));
    Signal const y{7, 8, 0, 0};
    Signal const from = simulate_from(m, {u, v}, y, 2);
    EXPECT_EQ(from[0], 7);
    EXPECT_EQ(from[1], 8);
    EXPECT_EQ(from[2], 0.5 * 8 - 0.25 * 7 + 4 + 1 + 0.125);
    EXPECT_EQ(from[3], 0.5 * from[2] - 0.25 * 8 + 2 - 8 + 0.125);
    EXPECT_THROW(simulate(m, {u}, xi), std::invalid_argument);
    EXPECT_THROW(simulate(m, {u, {1}}, xi), std::invalid_argument);
    EXPECT_THROW(simulate_from(m, {u}, y, 2), std::invalid_argument);
    DifferenceEquation const of =
        DifferenceEquation::of({.na = 1, .nb = 1, .delay = 3, .intercept = true}, Vector<double>{{1, 2, 3, 4}});
    EXPECT_EQ(of.a, (std::vector<double>{1}));
    EXPECT_EQ(of.b, (std::vector<std::vector<double>>{{2, 3}}));
    EXPECT_EQ(of.delay, 3);
    EXPECT_EQ(of.c, 4);
    // Two inputs, and the same model by its terms in another order.
    Arx const two{.na = 1, .nb = 1, .delay = 2, .intercept = true, .inputs = 2};
    DifferenceEquation const by_arx = DifferenceEquation::of(two, Vector<double>{{1, 2, 3, 4, 5, 6}});
    EXPECT_EQ(by_arx.b, (std::vector<std::vector<double>>{{2, 3}, {4, 5}}));
    EXPECT_EQ(by_arx.c, 6);
    std::vector<EquationTerm> const terms{{1, 3}, {EquationTerm::constant}, {0, 2}, {EquationTerm::output, 3}, {1, 2}};
    DifferenceEquation const by_terms = DifferenceEquation::of(terms, Vector<double>{{5, 6, 2, 7, 4}}, 2);
    EXPECT_EQ(by_terms.a, (std::vector<double>{0, 0, 7}));
    EXPECT_EQ(by_terms.b, (std::vector<std::vector<double>>{{2}, {4, 5}}));
    EXPECT_EQ(by_terms.delay, 2);
    EXPECT_EQ(by_terms.c, 6);
    std::vector<EquationTerm> const present{{EquationTerm::output, 0}}, third{{2, 0}};
    EXPECT_THROW(DifferenceEquation::of(present, Vector<double>{{1}}, 1), std::invalid_argument);
    EXPECT_THROW(DifferenceEquation::of(third, Vector<double>{{1}}, 2), std::invalid_argument);
    EXPECT_THROW(DifferenceEquation::of(two, Vector<double>{{1, 2}}), std::invalid_argument);
    EXPECT_EQ(
        DifferenceEquation::of(std::vector<EquationTerm>{{EquationTerm::output, 1}}, Vector<double>{{1}}, 0).delay, 0);
}
TEST(DifferenceNumbers, RootsAreThoseOfTheirPolynomial) {
    // (z - 3)(z - 1/2)(z^2 - z + 1/2) = z^4 - 4.5 z^3 + 5.5 z^2 - 3.25 z + 0.75
    auto const r = roots({-4.5, 5.5, -3.25, 0.75});
    ASSERT_EQ(r.size(), 4u);
    std::vector<std::complex<double>> const should{3, {0.5, 0.5}, {0.5, -0.5}, 0.5};
    for (size_t i = 0; i < 4; ++i)
        EXPECT_LT(std::abs(r[i] - should[i]), 1e-15) << i << ": largest first, upper half first";
    auto const refined = roots({-2.0, 1 - 0x1p-40});  // 1 +- 2^-20: the companion matrix alone leaves 2^-33 or so
    EXPECT_NEAR(refined[0].real() - 1, 0x1p-20, 1e-15);
    EXPECT_NEAR(refined[1].real() - 1, -0x1p-20, 1e-15);
    EXPECT_EQ(roots({-2, 1}).size(), 2u);
    EXPECT_TRUE(zeros({.a = {}, .b = {{0, 0}}, .delay = 0, .c = 0}).empty());
    auto const z = zeros({.a = {}, .b = {{1}, {0, 2, -3, 1}}, .delay = 0, .c = 0}, 1);
    ASSERT_EQ(z.size(), 2u);
    EXPECT_NEAR(z[0].real(), 1, 1e-15);
    EXPECT_NEAR(z[1].real(), 0.5, 1e-15);
}

// --- records as programs write them, one change of the input, a constant beside the input ----------------------------

/// The numbers as a file has them that was written with this format.
Signal written(Signal const& x, std::string const& format) {
    Signal out;
    for (double const v : x) out.push_back(std::stod(fmt::format(fmt::runtime(format), v)));
    return out;
}
Signal step(size_t samples, size_t at) {
    Signal u(samples, 0.05);
    for (size_t k = at; k < samples; ++k) u[k] = 0.06;
    return u;
}
Signal sines(size_t samples, std::vector<double> const& frequencies, double offset = 0) {
    Signal u(samples, offset);
    for (size_t k = 0; k < samples; ++k)
        for (double const f : frequencies) u[k] += std::sin(f * double(k));
    return u;
}

// --- resolution ------------------------------------------------------------------------------------------------------

TEST(Written, WithSignificantDigitsAsWithDecimals) {
    // Two sines around 3, from 0.2 to 5.8: exciting of order 5. Five digits are four decimals, and five below 1.
    Signal u = sines(1024, {0.3, 0.9}, 3);
    for (double& v : u) v = 3 + 1.8 * (v - 3);
    Excitation const decimals = excitation(written(u, "{:.4f}"), 12), digits = excitation(written(u, "{:.5g}"), 12);
    EXPECT_EQ(decimals.order, 5);
    EXPECT_EQ(digits.order, 5);
    EXPECT_EQ(digits.exact_order, 12);
    EXPECT_NEAR(decimals.resolution, 1e-4, 1e-12);
    EXPECT_GT(digits.resolution, 0.8e-4);
    EXPECT_LT(digits.resolution, 1e-4);
    // From 0.02 to 0.58, from 2 to 58 and from 2000 to 58000: by their own units.
    for (double const scale : {0.1, 10.0, 1e4}) {
        Signal scaled = u;
        for (double& v : scaled) v *= scale;
        EXPECT_EQ(excitation(written(scaled, "{:.5g}"), 12).order, 5) << scale;
    }
}
TEST(Written, OneNumberOfMoreDigitsChangesNothing) {
    Signal u = written(sines(1024, {0.3, 0.9}, 3), "{:.4f}");
    u[100] += 0.000012345;
    EXPECT_EQ(excitation(u, 12).order, 5);
    for (size_t k = 0; k < u.size(); ++k) u[k] += 0.000012345 * double(k % 7 == 0);  // one in seven do
    EXPECT_EQ(excitation(u, 12).order, 5);
}

// --- what one change carries -----------------------------------------------------------------------------------------

TEST(Persistent, AStepIsOfOrderOne) {
    Excitation const e = excitation(step(2000, 700), 20);
    EXPECT_EQ(e.order, 20) << "for exact numbers";
    EXPECT_EQ(e.persistent, 1);
    EXPECT_EQ(e.changes, 1);
    EXPECT_GT(e.orders[0].carried, 1900);
    EXPECT_NEAR(e.orders[1].carried, 1, 0.01) << "the row at the change";
    for (size_t i = 1; i < 20; ++i) EXPECT_LT(e.orders[i].carried, double(i) + 0.01) << "order " << i + 1;
    Signal pulse = step(2000, 700);
    for (size_t k = 900; k < pulse.size(); ++k) pulse[k] = 0.05;
    EXPECT_EQ(excitation(pulse, 20).persistent, 1);
    EXPECT_EQ(excitation(pulse, 20).changes, 2);
}
TEST(Persistent, NoiseSinesAndRegistersAreWhatTheyAre) {
    auto const expect_order = [](Signal const& u, Index most, Index order) {
        EXPECT_EQ(excitation(u, most).order, order);
        EXPECT_EQ(excitation(u, most).persistent, order);
    };
    expect_order(white_noise(400, Seed{1}), 20, 20);
    expect_order(prbs(5, 300), 31, 31);  // of order M, as its mean is not zero
    expect_order(sines(400, {0.3}), 6, 2);
    expect_order(Signal(300, 2.5), 6, 1);
    expect_order(Signal(300, 0.0), 6, 0);
    EXPECT_NEAR(excitation(white_noise(60000, Seed{1}), 1).orders[0].carried, 60000 / 2.9, 500)
        << "twelve uniforms: kurtosis 3 - 6/5/12";
    EXPECT_NEAR(excitation(sines(4000, {0.3}), 2).orders[1].carried, 4000 * 2.0 / 3, 5) << "a sine has kurtosis 3/2";
    EXPECT_EQ(excitation(Signal(300, 0.0), 6).changes, 0);
}

// --- with a constant in the model ------------------------------------------------------------------------------------

TEST(WithAConstant, TheMeanExcitesNothing) {
    auto const order = [](Signal const& u, bool constant) { return excitation(u, 8, {.constant = constant}).order; };
    Signal const offset = sines(400, {0.3}, 2);
    EXPECT_EQ(order(offset, false), 3);
    EXPECT_EQ(order(offset, true), 2);
    EXPECT_EQ(order(sines(400, {0.3}), true), 2);
    EXPECT_EQ(order(Signal(300, 2.5), false), 1);
    EXPECT_EQ(order(Signal(300, 2.5), true), 0);
    EXPECT_EQ(order(white_noise(400, Seed{1}), true), 8);
    Excitation const of_step = excitation(step(2000, 700), 8, {.constant = true});
    EXPECT_EQ(of_step.persistent, 1);
    EXPECT_NEAR(of_step.orders[0].least, 0.35 * 0.65 * 1e-4, 1e-10) << "its variance";
}
TEST(WithAConstant, DefiniteIsTheRankOfTheWindowsAndTheConstant) {
    // [v_k; 1] of 1 2 4 8 16 ... has rank 2 at every order; of the first N samples alone it may have too few rows.
    Signal const u{1, 2, 4, 8, 16, 32, 64, 128};
    Excitation const e = excitation(u, 8, {.constant = true});
    ASSERT_EQ(e.orders.size(), 2u);
    EXPECT_TRUE(e.orders[0].definite);
    EXPECT_FALSE(e.orders[1].definite);
    EXPECT_EQ(excitation({1, 2, 4, 3}, 9, {.constant = true}).orders.size(), 2u) << "3 windows of 2";
    EXPECT_EQ(excitation({1, 2, 4}, 9, {.constant = true}).orders.size(), 1u);
}

// --- against the definition ------------------------------------------------------------------------------------------

TEST(Windows, HaveTheConditionOfTheirRows) {
    Signal const u = coloured_noise(300, {-1.6, 0.7}, Seed{3});
    Excitation const e = excitation(u, 7), centred = excitation(u, 7, {.constant = true});
    for (Index n = 1; n <= 7; ++n) {
        Index const rows = Index(u.size()) - n + 1;
        Records v{.psi = Matrix<double>(n, rows), .y = Vector<double>::Zero(rows), .names = {}};
        for (Index k = 0; k < rows; ++k)
            for (Index i = 0; i < n; ++i) v.psi(i, k) = u[size_t(k + n - 1 - i)];
        EXPECT_NEAR(e.orders[size_t(n - 1)].condition / condition(v, 1), 1, 1e-12) << n;
        Vector<double> const mean = v.psi.rowwise().mean();
        for (Index k = 0; k < rows; ++k) v.psi.col(k) -= mean;
        EXPECT_NEAR(centred.orders[size_t(n - 1)].condition / condition(v, 1), 1, 1e-11) << n;
    }
}
TEST(Windows, OfAnySizeAreDecidedExactly) {
    Signal u = sines(60, {0.3, 1.1});
    for (size_t k = 0; k < u.size(); k += 7) u[k] *= 0x1p-300;  // squares are 2^-600 of the others
    EXPECT_EQ(excitation(u, 20).exact_order, 20);
    // A geometric series satisfies a recursion of order 1, whatever its range; one sample that is off by 2^-900 breaks
    // it.
    Signal series(41);
    for (size_t k = 0; k < series.size(); ++k) series[k] = std::ldexp(1.0, 20 * int(k) - 400);
    EXPECT_EQ(excitation(series, 5).exact_order, 1);
    EXPECT_EQ(excitation(series, 5).orders.size(), 2u);
    series[3] += std::ldexp(1.0, -380 + 40);
    EXPECT_GE(excitation(series, 5).exact_order, 2);
}

}  // namespace
}  // namespace rlslab
