// Orders of excitation that a user can rely on: records as programs write them, one change of the input, a constant
// beside the input.
#include <rlslab/model/excitation.hpp>
#include <rlslab/reference/certified.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rlslab {
namespace {

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
