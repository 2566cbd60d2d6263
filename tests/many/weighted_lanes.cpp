// Weights in packs: each lane has the bits of Weighted around the scalar variant.
#include "tests/many/lanes.hpp"

#include <rlslab/adapt/weighted.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace lanes;

template <template <class, int> class V, class T, int L, int N>
void expect_each_lane_to_be_weighted_alone(std::uint64_t from) {
    using P = Pack<T, L>;
    Weighted<V<P, N>> together(Problem<P>{.size = d, .forgetting = P(T(0.96875))});
    std::vector<Weighted<V<T, N>>> alone(size_t{L}, Weighted<V<T, N>>({.size = d, .forgetting = T(0.96875)}));
    Seed seed{from};
    Twins twins;
    for (int k = 0; k < 60; ++k) {
        Vector<P> psi(d);
        P y, w;
        for (int lane = 0; lane < L; ++lane) {
            for (Index j = 0; j < d; ++j) psi[j].set(lane, T(seed.bell()));
            y.set(lane, T(seed.bell()));
            T const odd[] = {T(0), T(0), T(-1), std::numeric_limits<T>::quiet_NaN(),
                             std::numeric_limits<T>::infinity()};
            double const chance = k % 12 == 11 ? 0.1 : seed.uniform();  // all lanes odd, now and then
            w.set(lane, chance < 0.3 && k % 3 != 0 ? odd[(k + lane) % (k % 24 == 11 ? 2 : 5)]
                                                   : T(std::ldexp(1 + seed.uniform(), int(20 * seed.bell()))));
        }
        bool const weighs = k % 5 != 4;
        auto const step = weighs ? together.update(psi, y, w) : together.update(psi, y);
        for (int lane = 0; lane < L; ++lane) {
            auto& one = alone[size_t(lane)];
            Vector<T> const row = psi.unaryExpr([&](P const& x) { return x[lane]; });
            auto const mine = weighs ? one.update(row, y[lane], w[lane]) : one.update(row, y[lane]);
            add_steps(twins, step, lane, mine);
            add_lanes(twins, together.theta(), lane, one.theta());
            add_lanes(twins, together.gain(), lane, one.gain());
            if (!twins.agree(V<T, N>::name, k, lane)) return;
        }
    }
}
TEST(WeightedLanes, EachHasTheBitsOfItsOwnWeights) {
    expect_each_lane_to_be_weighted_alone<Conventional, double, 8, 3>(41);
    expect_each_lane_to_be_weighted_alone<Potter, double, 8, 3>(41);
    expect_each_lane_to_be_weighted_alone<Carlson, double, 8, 3>(41);
    expect_each_lane_to_be_weighted_alone<Ud, double, 8, 3>(41);
    expect_each_lane_to_be_weighted_alone<InverseQr, double, 8, 3>(41);
    expect_each_lane_to_be_weighted_alone<Qr, double, 8, 3>(41);
    expect_each_lane_to_be_weighted_alone<Gentleman, double, 8, 3>(41);
    expect_each_lane_to_be_weighted_alone<Ud, double, 4, Dynamic>(42);
    expect_each_lane_to_be_weighted_alone<Qr, float, 8, 3>(43);
}
TEST(WeightedLanes, AFleetOfThemTakesAWeightForEachSample) {
    Index const filters = 11;
    Fleet<Weighted<Ud<Pack<double, 8>, 2>>> fleet(filters, {.forgetting = 0.96875});
    std::vector<Weighted<Ud<double, 2>>> alone(size_t(filters), Weighted<Ud<double, 2>>({.forgetting = 0.96875}));
    FleetSteps<double> steps(filters);
    Seed seed{44};
    for (int k = 0; k < 30; ++k) {
        Matrix<double> psi(filters, 2);
        Vector<double> y(filters), w(filters);
        for (Index i = 0; i < filters; ++i) {
            psi.row(i) << seed.bell(), seed.bell();
            y[i] = seed.bell();
            double const chance = seed.uniform();
            w[i] = chance < 0.1 ? 0 : chance < 0.2 ? NAN : chance < 0.3 ? -1 : chance;
        }
        Index const missing = fleet.update_weighted(psi, y, w, steps, 2);
        EXPECT_EQ(missing, filters - (w.array() >= 0).count());
        for (Index i = 0; i < filters; ++i) {
            EXPECT_EQ(steps.taken[size_t(i)], w[i] >= 0);
            auto& one = alone[size_t(i)];
            if (!(w[i] >= 0)) continue;
            auto const step = one.update(Vector<double>(psi.row(i)), y[i], w[i]);
            EXPECT_EQ(std::isnan(step.innovation), w[i] == 0) << k << " " << i;
            if (w[i] > 0) {
                EXPECT_EQ(steps.innovation[i], step.innovation) << k << " " << i;
            }
            EXPECT_EQ(steps.health[size_t(i)], step.health);
            EXPECT_EQ(fleet.theta(i), Vector<double>(one.theta()));
        }
    }
    auto one = fleet.filter(9);
    one.update({1.0, 2.0}, 3.0, 0.5);
    alone[9].update({1.0, 2.0}, 3.0, 0.5);
    EXPECT_EQ(one.theta(), alone[9].theta());
}

}  // namespace
}  // namespace rlslab
