// Every number that identify prints, computed in another way: rationals, finite differences, closed forms, separate
// loops.
#include "tests/common/exact_fit.hpp"
#include "tests/identify/said.hpp"

#include <rlslab/reference/certified.hpp>
#include <rlslab/reference/scatter.hpp>

namespace rlslab {
using namespace identify;
using namespace report;
namespace {

/// A record of two inputs and a constant, its numbers in units of 1 / unit.
struct Trial {
    Signal u, v, y;
    explicit Trial(Index n, double noise = 0.25, double unit = 64) : u(white_noise(n, Seed{5})), v(prbs(6, n)) {
        DifferenceEquation const model{
            .a = {-1.1, 0.5}, .b = {{0, 1, 0.4, 0}, {0.3, 0, -0.6, 0}}, .delay = 0, .c = 0.4};
        y = simulate(model, {u, v}, times(white_noise(n, Seed{6}), noise));
        for (Signal* x : {&u, &y})
            for (double& w : *x) w = std::round(unit * w) / unit;
    }
    std::string text() const { return Data{{"u", "v", "y"}, {u, v, y}}.csv(); }
};

/// na = 2, u at lags 1 and 2, v at lags 0, 1, 2, and a constant: on the fitted rows, means off as given.
struct Rows {
    Records all, fitted;
    Rows(Trial const& t, Identified const& m) {
        Index const first = 2, n = Index(t.y.size());
        all = {.psi = Matrix<double>(8, n - first), .y = Vector<double>(n - first), .names = {}};
        auto const at = [&](Signal const& x, Index k, size_t column) { return x[size_t(k)] - m.means[column]; };
        for (Index k = first; k < n; ++k) {
            all.psi.col(k - first) << -at(t.y, k - 1, 2), -at(t.y, k - 2, 2), at(t.u, k - 1, 0), at(t.u, k - 2, 0),
                at(t.v, k, 1), at(t.v, k - 1, 1), at(t.v, k - 2, 1), 1;
            all.y[k - first] = at(t.y, k, 2);
        }
        Index const held = m.held_out;
        fitted = {.psi = all.psi.leftCols(all.rows() - held), .y = all.y.head(all.rows() - held), .names = {}};
    }
};

IdentifyOptions options() {
    IdentifyOptions o{.inputs = {"u", "v"}, .output = "y", .na = 2, .nb = {1, 2}, .delay = {1, 0}};
    o.variant = "qr", o.p0 = 0x1p100, o.confidence = 0.9;  // a prior that does not show
    return o;
}

class IdentifyNumbers : public testing::Test {
protected:
    files::Folder const folder;
    Trial const trial{90};
    Identified const m = identify::identify(folder.file(trial.text()), options());
    Rows const rows{trial, m};
    exact_fit::Fit const exact = exact_fit::of(rows.fitted);
    static constexpr Index N = 58, d = 8, held = 30;
    static double number(Rational const& x) { return static_cast<double>(x); }
    Vector<double> theta() const {
        return exact.theta.unaryExpr([](Rational const& x) { return number(x); }).cast<double>();
    }
    Matrix<double> covariance() const {
        Matrix<double> out(d, d);
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i) out(i, j) = number(exact.J / (N - d) * exact.inverse(i, j));
        return out;
    }
};

TEST_F(IdentifyNumbers, Sizes) {
    EXPECT_EQ(m.samples, 90);
    EXPECT_EQ(m.held_out, held);
    EXPECT_EQ(m.fitted, N);
    EXPECT_EQ(m.order, 2);
    std::vector<std::string> names;
    for (Parameter const& p : m.parameters) names.push_back(p.name + " " + p.regressor);
    EXPECT_EQ(names, (std::vector<std::string>{"a1 y[k-1]", "a2 y[k-2]", "b0[u] u[k-1]", "b1[u] u[k-2]", "b0[v] v[k]",
                                               "b1[v] v[k-1]", "b2[v] v[k-2]", "c 1"}));
    for (size_t j : {0u, 1u, 2u}) {
        Rational sum = 0;
        for (size_t k = 0; k < 60; ++k) sum += Rational((j == 0 ? trial.u : j == 1 ? trial.v : trial.y)[k]);
        EXPECT_NEAR(m.means[j], number(sum / 60), 1e-15);
    }
}
TEST_F(IdentifyNumbers, ParametersAndTheirIntervals) {
    EXPECT_NEAR(m.freedom, N - d, 1e-12);
    EXPECT_NEAR(m.sigma2 / number(exact.J / (N - d)), 1, 1e-12);
    EXPECT_NEAR(exact_fit::student_inside(N - d, m.quantile), 0.9, 1e-12);
    for (Index i = 0; i < d; ++i) {
        Parameter const& p = m.parameters[size_t(i)];
        double const sd = exact.sd(i, N - d);
        EXPECT_NEAR(p.value, number(exact.theta[i]), 1e-12);
        EXPECT_NEAR(p.sd / sd, 1, 1e-12);
        EXPECT_NEAR(exact_fit::student_inside(N - d, (p.upper - p.value) / sd), 0.9, 1e-9);
        EXPECT_NEAR(exact_fit::student_inside(N - d, (p.value - p.lower) / sd), 0.9, 1e-9);
        EXPECT_NEAR(1 - exact_fit::student_inside(N - d, std::abs(p.value) / sd), p.p, 1e-12);
        EXPECT_EQ(p.p<0.1, p.value * p.lower> 0 && p.value * p.upper > 0);
    }
}
TEST_F(IdentifyNumbers, CriteriaDigitsAndCondition) {
    double const J = number(exact.J);
    EXPECT_NEAR(m.aic, N * std::log(J / N) + 2 * d, 1e-9);
    EXPECT_NEAR(m.bic, N * std::log(J / N) + d * std::log(double(N)), 1e-9);
    EXPECT_NEAR(m.fpe / (J / N * (N + d) / (N - d)), 1, 1e-11);
    Vector<double> const singular = fit(rows.fitted, FitBy::svd).singular;
    EXPECT_NEAR(m.condition / (singular[0] / singular[d - 1]), 1, 1e-10);
    // Digits: of the error in theta. The prior of 2^100 moves it by 1e-30.
    Rational error = 0, size = 0;
    double worst = INFINITY;
    for (Index i = 0; i < d; ++i) {
        Rational const e = Rational(m.parameters[size_t(i)].value) - exact.theta[i];
        error += e * e, size += exact.theta[i] * exact.theta[i];
        worst = std::min(worst, -std::log10(std::abs(number(e / exact.theta[i]))));
    }
    EXPECT_NEAR(m.digits, std::min(15.95, -0.5 * std::log10(number(error / size))), 1e-6);
    EXPECT_NEAR(m.digits_worst, std::min(15.95, worst), 1e-6);
}
TEST_F(IdentifyNumbers, ResidualsAndTheirCorrelations) {
    Index const lags = 25;
    EXPECT_EQ(m.ljung_box.lags, lags);
    EXPECT_EQ(m.ljung_box.freedom, lags - 2) << "two past outputs";
    Rational Q = 0, power = exact.J, of_v = 0;
    for (Index lag = 1; lag <= lags; ++lag) {
        Rational r = 0;
        for (Index k = lag; k < N; ++k) r += exact.residuals[k] * exact.residuals[k - lag];
        Q += r * r / (power * power) / (N - lag);
        EXPECT_NEAR(m.auto_correlation[size_t(lag)], number(r / power), 1e-12);
    }
    EXPECT_DOUBLE_EQ(m.auto_correlation[0], 1);
    EXPECT_NEAR(m.ljung_box.Q / (N * (N + 2) * number(Q)), 1, 1e-10);
    EXPECT_NEAR(m.ljung_box.p / exact_fit::chi_squared_tail(lags - 2, N * (N + 2) * number(Q)), 1, 1e-9);
    auto const v = [&](Index k) { return Rational(trial.v[size_t(2 + k)] - m.means[1]); };
    for (Index k = 0; k < N; ++k) of_v += v(k) * v(k);
    for (Index lag : {0, 3, 25}) {
        Rational r = 0;
        for (Index k = lag; k < N; ++k) r += exact.residuals[k] * v(k - lag);
        EXPECT_NEAR(m.cross_correlation[1][size_t(lag)], number(r) / std::sqrt(number(power) * number(of_v)), 1e-12)
            << lag;
    }
    EXPECT_EQ(m.cross_correlation[1].size(), 26u);
    // The bound: two tails of the normal distribution are 1 %.
    EXPECT_NEAR(std::erfc(m.bound * std::sqrt(double(N)) / std::sqrt(2.0)), 0.01, 1e-14);
}
TEST_F(IdentifyNumbers, FitsOfWhatIsPredictedAndSimulated) {
    auto const percent = [&](Vector<double> const& predicted, Index from, Index count) {
        return fit_percent(rows.all.y.segment(from, count), predicted.segment(from, count));
    };
    Vector<double> const one = rows.all.psi.transpose() * theta();
    EXPECT_NEAR(m.fit_one_step, percent(one, 0, N), 1e-9);
    EXPECT_NEAR(m.held_out_one_step, percent(one, N, held), 1e-9);
    // Simulated: the model's own outputs in place of measured ones, from the two measured before row `from`.
    auto const simulated = [&](Index from) {
        Vector<double> out(N + held);
        for (Index k = 0; k < N + held; ++k) {
            Vector<double> psi = rows.all.psi.col(k);
            for (Index lag : {1, 2})
                if (k - lag >= from) psi[lag - 1] = -out[k - lag];
            out[k] = psi.dot(theta());
        }
        return out;
    };
    EXPECT_NEAR(m.held_out_simulated, percent(simulated(N), N, held), 1e-8);
    ASSERT_EQ(m.measured.size(), size_t(N + held));
    EXPECT_DOUBLE_EQ(m.measured[0], trial.y[2]);
    EXPECT_NEAR(m.one_step[7], one[7] + m.means[2], 1e-12);
    Vector<double> const free = simulated(0);
    for (Index k = 0; k < N + held; ++k) EXPECT_NEAR(m.simulated[size_t(k)], free[k] + m.means[2], 1e-9) << k;
}
TEST_F(IdentifyNumbers, PolesZerosAndGains) {
    Vector<double> const t = theta();
    ASSERT_EQ(m.poles.size(), 2u);
    EXPECT_NEAR(std::abs(m.poles[0] + m.poles[1] + t[0]), 0, 1e-12);
    EXPECT_NEAR(std::abs(m.poles[0] * m.poles[1] - t[1]), 0, 1e-12);
    ASSERT_EQ(m.zeros[0].size(), 1u);
    EXPECT_NEAR(m.zeros[0][0].real(), -t[3] / t[2], 1e-12);
    ASSERT_EQ(m.zeros[1].size(), 2u);
    EXPECT_NEAR(std::abs(m.zeros[1][0] + m.zeros[1][1] + t[5] / t[4]), 0, 1e-10);
    EXPECT_NEAR(std::abs(m.zeros[1][0] * m.zeros[1][1] - t[6] / t[4]), 0, 1e-10);
    auto const gain = [](Vector<double> const& x, int input) {
        return (input == 0 ? x[2] + x[3] : x[4] + x[5] + x[6]) / (1 + x[0] + x[1]);
    };
    for (int input : {0, 1}) {
        EXPECT_NEAR(m.gain[size_t(input)], gain(t, input), 1e-11);
        Vector<double> slope(d);
        for (Index i = 0; i < d; ++i) {
            Vector<double> up = t, down = t;
            up[i] += 1e-6, down[i] -= 1e-6;
            slope[i] = (gain(up, input) - gain(down, input)) / 2e-6;
        }
        EXPECT_NEAR(m.gain_sd[size_t(input)] / std::sqrt(slope.dot(covariance() * slope)), 1, 1e-7) << input;
    }
}
TEST_F(IdentifyNumbers, TheTrajectory) {
    EXPECT_EQ(m.trajectory.size(), size_t(N)) << "a checkpoint for each row, where rows are few";
    EXPECT_EQ(m.trajectory.back().row, N);
    for (Index i = 0; i < d; ++i) EXPECT_EQ(m.trajectory.back().sd[i], m.parameters[size_t(i)].sd);
    TrajectoryPoint const& point = m.trajectory[30];  // with the sigma of all rows
    exact_fit::Fit const then =
        exact_fit::of({.psi = rows.fitted.psi.leftCols(point.row), .y = rows.fitted.y.head(point.row), .names = {}});
    for (Index i = 0; i < d; ++i) {
        EXPECT_NEAR(point.theta[i], number(then.theta[i]), 1e-11);
        EXPECT_NEAR(point.sd[i] / std::sqrt(number(exact.J / (N - d) * then.inverse(i, i))), 1, 1e-11);
    }
    Trial const longer(400);
    Identified const many = identify::identify(folder.file(longer.text(), "longer.csv"), options());
    EXPECT_EQ(many.trajectory.size(), 100u);
    EXPECT_EQ(many.trajectory[0].row, many.fitted / 100);
    EXPECT_EQ(many.trajectory.back().row, many.fitted);
}

/// With forgetting: theta in rationals; the scatter is that of tests/model/fit.cpp.
TEST_F(IdentifyNumbers, WithForgetting) {
    IdentifyOptions o = options();
    o.forgetting = 0.9375, o.variant = "ud", o.p0 = 0x1p60;
    Identified const f = identify::identify(folder.file(trial.text()), o);
    exact_fit::Fit const weighted = exact_fit::of(rows.fitted, Rational(0.9375));
    Scatter const s =
        scattered({.size = d, .forgetting = 0.9375, .prior = std::nullopt}, rows.fitted, {N}).front().scatter;
    EXPECT_NEAR(f.freedom, s.freedom, 1e-6);
    EXPECT_NEAR(f.sigma2 / number(weighted.J) * s.freedom, 1, 1e-6);
    for (Index i = 0; i < d; ++i) {
        EXPECT_NEAR(f.parameters[size_t(i)].value, number(weighted.theta[i]), 1e-9);
        EXPECT_NEAR(f.parameters[size_t(i)].sd / (std::sqrt(f.sigma2) * s.sd[i]), 1, 1e-6);
    }
    EXPECT_TRUE(std::isnan(f.aic)) << "the criteria are those of equal weights";
}

/// The default prior: the shared one, made weaker by powers of two until it moves no parameter by more than a tenth of
/// its standard deviation.
TEST_F(IdentifyNumbers, TheDefaultPriorIsTheLeastThatDoesNotShow) {
    IdentifyOptions o = options();
    o.p0.reset();
    for (double const noise : {1.0, 0x1p-6}) {
        Trial const t = noise < 1 ? Trial(90, 0, 0x1p24) : Trial(90);  // without noise but for rounding
        Identified const f = identify::identify(folder.file(t.text()), o);
        Rows const r(t, f);
        exact_fit::Fit const e = exact_fit::of(r.fitted);
        double const shared = default_prior(r.fitted, 1).c;
        auto const moved = [&](double c) {
            Problem<double> problem{
                .size = d,
                .prior = DefaultPrior{Eigen::Map<Vector<double> const>(f.scales.data(), d), c, 0, 0, true}.prior()};
            Vector<Reference> const with = certified(problem, r.fitted, {r.fitted.rows()}).front().theta();
            double most = 0;
            for (Index i = 0; i < d; ++i)
                most = std::max(most, std::abs(static_cast<double>(with[i]) - number(e.theta[i])) / e.sd(i, N - d));
            return most;
        };
        EXPECT_LE(moved(f.c), 0.1);
        EXPECT_NEAR(f.prior_effect / moved(f.c), 1, 1e-2) << "in units of the standard deviations with the prior";
        EXPECT_GE(f.c, shared);
        if (f.c > shared) {
            EXPECT_GT(moved(f.c / 2), 0.1);
        }
        if (noise < 1) {
            EXPECT_GT(f.c, 32) << "the trial shows nothing";
            EXPECT_GT(moved(32), 0.1);
        }
        for (Index i = 0; i < d; ++i) EXPECT_EQ(f.scales[size_t(i)], regressor_scales(r.fitted)[i]);
    }
}

}  // namespace
}  // namespace rlslab
