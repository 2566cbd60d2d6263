// Regressions over the last rows: each window beside the certified solution of its rows alone; what has left a window
// leaves no trace.
#include "tests/common/laws.hpp"

#include <rlslab/adapt/window.hpp>
#include <rlslab/many/rolling.hpp>
#include <rlslab/reference/certified.hpp>
#include <rlslab/variants/qr.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

struct Answers {
    std::vector<double> theta, t, error, residual, innovation, sigma, r2, rows;

    Answers(Records const& data, RollingOptions const& options, std::vector<std::int64_t> const& group = {})
        : Answers(data.psi, data.y, options, group) {}
    template <class X>
    Answers(Matrix<X> const& psi, Vector<X> const& y, RollingOptions const& options,
            std::vector<std::int64_t> const& group = {}) {
        size_t const n = size_t(psi.cols());
        for (auto* const of_each : {&theta, &t, &error}) of_each->resize(n * size_t(psi.rows()));
        for (auto* const one : {&residual, &innovation, &sigma, &r2, &rows}) one->resize(n);
        rolling(RollingRows<X>{psi.data(), y.data(), psi.cols(), psi.rows(), psi.rows(),
                               group.empty() ? nullptr : group.data()},
                options,
                {theta.data(), t.data(), error.data(), residual.data(), innovation.data(), sigma.data(), r2.data(),
                 rows.data()});
    }
    /// Of one row, as bits: one NaN is another.
    std::vector<std::uint64_t> bits(Index k) const {
        std::vector<std::uint64_t> out;
        for (auto const* const all : {&theta, &t, &error, &residual, &sigma, &r2, &rows}) {
            size_t const d = all->size() / rows.size();
            for (size_t j = 0; j < d; ++j) out.push_back(std::bit_cast<std::uint64_t>((*all)[size_t(k) * d + j]));
        }
        return out;
    }
};

Records window_of(Records const& data, Index last, Index rows) {
    return {.psi = data.psi.middleCols(last + 1 - rows, rows), .y = data.y.segment(last + 1 - rows, rows), .names = {}};
}
/// The largest relative error of theta's components and of sigma over some windows, in units of u. Of 13 rows of 5
/// parameters the least determined window costs two digits.
double worst_error(Records const& data, Answers const& found, RollingOptions const& options) {
    double worst = 0;
    Index const d = data.parameters(), W = options.window;
    for (Index k = W - 1; k < data.rows(); k += 41) {
        Records const window = window_of(data, k, W);
        Problem<double> const problem{.size = d, .forgetting = options.forgetting, .prior = std::nullopt};
        CertifiedSolution const exact = certified(problem, window, {W})[0];
        Vector<Reference> const theta = exact.theta();
        Reference rss = 0, weights = 0, squares = 0, w = 1, length = 0;
        for (Index i = W - 1; i >= 0; --i) {
            Reference e = Reference(window.y[i]);
            for (Index j = 0; j < d; ++j) e -= theta[j] * Reference(window.psi(j, i));
            rss += w * e * e;
            length += w * Reference(window.y[i]) * Reference(window.y[i]);
            weights += w;
            squares += w * w;
            w *= Reference(options.forgetting);
        }
        Reference const sigma = square_root(Reference(rss / (weights - d * squares / weights)));
        auto const error = [](double a, Reference const& b) {
            return std::abs(static_cast<double>(Reference((Reference(a) - b) / b)));
        };
        worst = std::max(worst, error(found.sigma[size_t(k)], sigma));
        for (Index j = 0; j < d; ++j) worst = std::max(worst, error(found.theta[size_t(k * d + j)], theta[j]));
    }
    return worst / std::ldexp(1.0, -53);
}

/// Regressors of units from 1e-8 to 1e8, a constant among them.
Records records(Index d, Index rows) {
    Records data = laws::noise_records(d, rows, Seed{49});
    for (Index j = 0; j < d; ++j) data.psi.row(j) *= std::pow(10.0, double(16 * j) / double(d) - 8);
    if (d > 1) data.psi.row(1).setConstant(2.5);
    Vector<double> const size = data.psi.cwiseAbs().rowwise().maxCoeff();
    for (Index k = 0; k < rows; ++k)
        for (Index j = 0; j < d; ++j) data.y[k] += 3 * data.psi(j, k) / size[j];
    return data;
}

TEST(Rolling, EachWindowIsItsRowsAlone) {
    for (Index const d : {1, 2, 5, 8, 9})
        for (double const forgetting : {1.0, 0.97})
            for (Index const W : {Index(2 * d + 3), Index(60)}) {
                Records const data = records(d, 400);
                RollingOptions const options{.window = W, .forgetting = forgetting};
                EXPECT_LE(worst_error(data, Answers(data, options), options), 1000) << d << ' ' << W;
            }
}

TEST(Rolling, WhatHasLeftTheWindowLeavesNoTrace) {
    for (Index const d : {2, 5, 9}) {
        Index const W = 30;
        Records const clean = records(d, 300);
        Records dirty = clean;
        for (Index const k : {100, 101, 150})
            for (Index j = 2; j < d; ++j) dirty.psi(j, k) *= 1e12;
        dirty.y[100] = 1e12;
        dirty.y[101] = -1e12;
        dirty.psi(0, 150) = 1e30;
        dirty.y[151] = std::numeric_limits<double>::infinity();
        for (double const forgetting : {1.0, 0.95}) {
            RollingOptions const options{.window = W, .forgetting = forgetting};
            Answers const expected(clean, options), found(dirty, options);
            int differ = 0;
            for (Index k = W - 1; k < 300; ++k) {
                bool const within = (k >= 100 && k < 101 + W) || (k >= 150 && k < 151 + W);
                if (!within) {
                    EXPECT_EQ(found.bits(k), expected.bits(k)) << k;
                    EXPECT_TRUE(std::isfinite(found.sigma[size_t(k)])) << k;
                }
                differ += found.bits(k) != expected.bits(k);
            }
            EXPECT_EQ(differ, 2 * (W + 1));
        }
    }
}
/// The law is not for nothing: a row taken back, with the window's alarms or without, leaves other bits.
TEST(Rolling, TakingRowsBackLeavesATrace) {
    Records const clean = laws::noise_records(3, 120, Seed{4});
    Records dirty = clean;
    dirty.psi.col(40) *= 1e6;
    auto const theta = [](Records const& data) {
        Windowed<Qr<double>> filter({.size = 3, .prior = std::nullopt}, {.rows = 30, .worse = 1e30});
        for (Index k = 0; k < data.rows(); ++k) filter.update(data.sample(k), data.y[k]);
        return Vector<double>(filter.theta());
    };
    EXPECT_NE(theta(dirty), theta(clean));
    RollingOptions const options{.window = 30};
    EXPECT_EQ(Answers(dirty, options).bits(119), Answers(clean, options).bits(119));
}

TEST(Rolling, GroupsAndThreadsChangeNoBit) {
    Index const n = 40000;
    Records const data = records(3, n);
    std::vector<std::int64_t> group(n);
    Seed numbers{6};
    for (Index k = 0; k < n; ++k) group[size_t(k)] = k < 25000 ? 3 : std::int64_t(numbers.next() % 6) - 1;
    for (RollingOptions options : {RollingOptions{.window = 50}, {.forgetting = 0.98}, {.window = 9000}}) {
        Answers const one(data, options, group);
        options.threads = 3;
        Answers const three(data, options, group);
        for (int g = -1; g < 5; ++g) {
            std::vector<Index> rows;
            for (Index k = 0; k < n; ++k)
                if (group[size_t(k)] == g) rows.push_back(k);
            Records const own{.psi = data.psi(Eigen::all, rows), .y = data.y(rows), .names = {}};
            Answers const alone(own, options);
            for (size_t i = 0; i < rows.size(); i += 97) {
                size_t const k = size_t(rows[i]);
                EXPECT_EQ(one.bits(rows[i]), three.bits(rows[i]));
                if (g >= 0) {
                    EXPECT_EQ(one.bits(rows[i]), alone.bits(Index(i)));
                    EXPECT_TRUE(one.innovation[k] == alone.innovation[i] ||
                                (std::isnan(one.innovation[k]) && std::isnan(alone.innovation[i])));
                } else {
                    EXPECT_TRUE(std::isnan(one.theta[k * 3]) && std::isnan(one.rows[k]));
                }
            }
        }
    }
}

TEST(Rolling, RowsOfFloatAreTakenAsTheyAre) {
    Records const data = laws::noise_records(4, 200, Seed{8});
    Matrix<float> const psi = data.psi.cast<float>();
    Vector<float> const y = data.y.cast<float>();
    Answers const narrow(psi, y, {.window = 20});
    Answers const wide(Matrix<double>(psi.cast<double>()), Vector<double>(y.cast<double>()), {.window = 20});
    for (Index k = 0; k < 200; ++k) EXPECT_EQ(narrow.bits(k), wide.bits(k));
}

TEST(Rolling, RefusesOptionsThatAreNone) {
    Records const data = laws::noise_records(2, 10, Seed{1});
    double theta[20] = {7};
    auto const run = [&](RollingOptions const& options, Index size = 2, Index stride = 2,
                         std::int64_t const* group = nullptr) {
        rolling(RollingRows<double>{data.psi.data(), data.y.data(), 10, size, stride, group}, options,
                {.theta = theta});
    };
    for (RollingOptions const& wrong : {RollingOptions{.window = -1},
                                        {.forgetting = 0},
                                        {.forgetting = 1.5},
                                        {.forgetting = std::nan("")},
                                        {.min_periods = -2},
                                        {.window = 3, .min_periods = 4},
                                        {.threads = 0},
                                        {.threads = 2000}})
        EXPECT_THROW(run(wrong), std::invalid_argument);
    EXPECT_THROW(run({}, 0), std::invalid_argument);
    EXPECT_THROW(run({}, 2, 1), std::invalid_argument);
    std::int64_t const group[10] = {0, 1, 10};
    EXPECT_THROW(run({}, 2, 2, group), std::invalid_argument);
    EXPECT_EQ(theta[0], 7);
    run({});
    EXPECT_TRUE(std::isnan(theta[0]));
    rolling(RollingRows<double>{nullptr, nullptr, 0, 3, 3}, {.window = 5}, {});
}

}  // namespace
}  // namespace rlslab
