// Batch fits do not depend on the units of the data, to the bit, from 2^-1000 to 2^1000; they end, and find ranks.
#include "tests/common/same.hpp"

#include <rlslab/core/random.hpp>
#include <rlslab/model/excitation.hpp>
#include <rlslab/model/fit.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace rlslab {
namespace {

/// d columns of which `rank` are independent, small whole numbers, and an output with noise; some columns zero.
Records integers(Index d, Index rank, Index rows, Seed seed, unsigned zeros) {
    Records out{.psi = Matrix<double>::Zero(d, rows), .y = Vector<double>(rows), .names = {}};
    Matrix<double> mix(d, rank);
    for (double& m : mix.reshaped()) m = double(int(seed.next() % 7)) - 3;
    for (Index i = 0; i < rank; ++i) mix.row(i).setZero(), mix(i, i) = 1;
    for (Index k = 0; k < rows; ++k) {
        Vector<double> base(rank);
        for (double& b : base) b = double(int(seed.next() % 21)) - 10;
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < rank; ++i) out.psi(j, k) += mix(j, i) * base[i];
        out.y[k] = out.psi.col(k).sum() + seed.bell();
    }
    for (Index j = 0; j < d; ++j)
        if (zeros >> j & 1) out.psi.row(j).setZero();
    return out;
}
Records times(Records records, std::vector<int> const& psi, int y) {
    for (Index j = 0; j < records.parameters(); ++j)
        for (Index k = 0; k < records.rows(); ++k) records.psi(j, k) = std::scalbn(records.psi(j, k), psi[size_t(j)]);
    for (double& v : records.y) v = std::scalbn(v, y);
    return records;
}

/// Whether b is the fit a of data in other units.
void expect_in_units(Fit const& a, Fit const& b, std::vector<int> const& psi, int y) {
    auto const expect = [&](double from, int unit, double is, char const* what) {
        RC_LOG() << what << ": " << from << " times 2^" << unit << ", " << is << '\n';
        RC_ASSERT(same(std::scalbn(from, unit), is));
    };
    RC_ASSERT(a.rank == b.rank);
    for (Index i = 0; i < a.theta.size(); ++i) {
        int const unit = y - psi[size_t(i)];
        expect(a.theta[i], unit, b.theta[i], "theta");
        expect(a.sd[i], unit, b.sd[i], "sd");
        expect(a.lower[i], unit, b.lower[i], "low");
        expect(a.upper[i], unit, b.upper[i], "high");
        for (Index j = 0; j < a.theta.size(); ++j)
            expect(a.covariance(i, j), 2 * y - psi[size_t(i)] - psi[size_t(j)], b.covariance(i, j), "covariance");
    }
    for (Index k = 0; k < a.residuals.size(); ++k) expect(a.residuals[k], y, b.residuals[k], "residual");
    expect(a.J, 2 * y, b.J, "J");
    expect(a.sigma2, 2 * y, b.sigma2, "sigma2");
    expect(a.percent, 0, b.percent, "percent");
    for (Index i = 0; i < a.singular.size(); ++i) expect(a.singular[i], psi[0], b.singular[i], "singular value");
}

struct Case {
    Index d, rank, rows;
    Records records;
};
Case any_case() {
    Index const d = *rc::gen::inRange<Index>(1, 9), rank = *rc::gen::inRange<Index>(1, d + 1),
                rows = *rc::gen::inRange<Index>(d, 3 * d + 70);
    unsigned const zeros =
        *rc::gen::weightedElement<bool>({{3, false}, {1, true}}) ? *rc::gen::inRange(0u, 1u << d) : 0;
    return {d, rank, rows, integers(d, rank, rows, Seed{*rc::gen::arbitrary<std::uint64_t>()}, zeros)};
}

RC_GTEST_PROP(Fits, OfAllColumnsInAnotherUnitAreTheSame, ()) {
    Case const c = any_case();
    int const x = *rc::gen::inRange(-1000, 1001), y = *rc::gen::inRange(-1000, 1001);
    std::vector<int> const psi(size_t(c.d), x);
    for (FitBy by : {FitBy::svd, FitBy::qr, FitBy::normal_equations}) {
        Fit const in_units = fit(times(c.records, psi, y), by);
        RC_ASSERT(in_units.converged);
        expect_in_units(fit(c.records, by), in_units, psi, y);
    }
}
RC_GTEST_PROP(Fits, OfEachColumnInAUnitOfItsOwnAreTheSame, ()) {
    Case const c = any_case();
    std::vector<int> psi(size_t(c.d), 0);
    for (int& e : psi) e = *rc::gen::inRange(-1000, 1001);
    int const y = *rc::gen::inRange(-1000, 1001);
    for (FitBy by : {FitBy::qr, FitBy::normal_equations})
        expect_in_units(fit(c.records, by), fit(times(c.records, psi, y), by), psi, y);
    RC_ASSERT(fit(times(c.records, psi, y), FitBy::svd).converged);  // which drops what is small beside the rest
}
RC_GTEST_PROP(Fits, OfRankDeficientRowsAreTheShortestBySvd, ()) {
    Case const c = any_case();
    Fit const f = fit(c.records, FitBy::svd);
    std::vector<Index> zero;
    for (Index j = 0; j < c.d; ++j)
        if (c.records.psi.row(j).isZero(0)) zero.push_back(j);
    RC_ASSERT(f.rank <= c.rank && f.rank <= c.d - Index(zero.size()));
    for (Index const j : zero) RC_ASSERT(f.theta[j] == 0);  // a parameter that nothing shows
    if (f.rank == 0) return;
    // Phi'(Y - Phi theta) = 0; and theta, the shortest, is what an output without noise gives back. Budgets: kappa u, a
    // thousandfold.
    double const kappa = f.singular[0] / f.singular[f.rank - 1], u = 0x1p-53;
    Vector<double> const gradient = c.records.psi * f.residuals;
    RC_ASSERT(gradient.norm() <= 1e3 * kappa * u * f.singular[0] * c.records.y.norm());
    Fit const again = fit({.psi = c.records.psi, .y = c.records.psi.transpose() * f.theta, .names = {}}, FitBy::svd);
    RC_ASSERT((again.theta - f.theta).norm() <= 1e3 * kappa * u * f.theta.norm());
}
TEST(Fits, OfColumnsThatUnderflowWhenSquaredEnd) {  // they did not
    for (double const size : {1e-160, 1e-300, 0x1p-1074, 1e150, 0x1p1000}) {
        Records records = integers(3, 3, 40, Seed{7}, 0);
        records.psi *= size;
        if (size == 0x1p-1074) records.psi = records.psi.cwiseSign() * size;
        Fit const f = fit(records, FitBy::svd);
        EXPECT_TRUE(f.converged);
        EXPECT_EQ(f.rank, 3) << size;
    }
    Records mixed = integers(3, 3, 40, Seed{7}, 0);
    mixed.psi.row(1) *= 1e-160;
    EXPECT_EQ(fit(mixed, FitBy::svd).rank, 2);
    EXPECT_EQ(fit(mixed, FitBy::svd, 0.95, 0).rank, 2);  // 2^-440 is the least
    mixed.psi.row(1) *= 1e60;
    EXPECT_EQ(fit(mixed, FitBy::svd, 0.95, 0).rank, 3);
    EXPECT_TRUE(fit(mixed, FitBy::svd, 0.95, 0).converged);
}
TEST(Fits, OfLowRankEnd) {  // rounding kept one of these on the turn at any scale
    for (std::uint64_t seed = 0; seed < 4000; ++seed) {
        Index const d = 2 + Index(seed % 7), rank = 1 + Index(seed / 7 % std::uint64_t(d));
        EXPECT_TRUE(fit(integers(d, rank, 2 * d, Seed{seed}, 0), FitBy::svd).converged) << seed;
    }
}
TEST(Fits, OfWhatIsNotFiniteEnd) {
    for (double const bad : {std::nan(""), HUGE_VAL}) {
        Records records = integers(3, 3, 40, Seed{7}, 0);
        records.psi(1, 20) = bad;
        for (FitBy by : {FitBy::svd, FitBy::qr, FitBy::normal_equations}) {
            Fit const f = fit(records, by);
            for (Index i = 0; i < 3; ++i) EXPECT_FALSE(by != FitBy::svd && std::isfinite(f.theta[i])) << name_of(by);
        }
    }
}
TEST(Fits, PercentOfTinyAndHugeOutputs) {
    Vector<double> const y{{1, 2, 4}}, predicted{{1, 2, 3}};
    double const percent = fit_percent(y, predicted);
    for (int const e : {-1070, -600, 600, 1020})
        EXPECT_NEAR(fit_percent(std::scalbn(1.0, e) * y, std::scalbn(1.0, e) * predicted), percent, e == -1070 ? 1 : 0)
            << e;
    EXPECT_EQ(fit_percent(Vector<double>::Zero(3), Vector<double>::Zero(3)), 100);
    EXPECT_EQ(fit_percent(Vector<double>::Ones(3), Vector<double>::Zero(3)), -HUGE_VAL);
}
TEST(Fits, ExcitationDoesNotDependOnTheUnit) {
    Signal u, tiny, huge;
    Seed seed{3};
    for (int k = 0; k < 200; ++k)
        u.push_back(std::round(100 * seed.bell()) / 128), tiny.push_back(std::scalbn(u.back(), -530)),
            huge.push_back(std::scalbn(u.back(), 490));
    Excitation const e = excitation(u, 6);
    EXPECT_EQ(e.order, 6);
    for (Signal const& other : {tiny, huge}) {
        Excitation const o = excitation(other, 6);
        EXPECT_EQ(o.order, e.order);
        for (size_t i = 0; i < e.orders.size(); ++i)
            EXPECT_NEAR(o.orders[i].condition / e.orders[i].condition, 1, 1e-12);
    }
}

}  // namespace
}  // namespace rlslab
