// Guards and weights in packs.
#include "tests/many/lanes.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace lanes;

/// What the guards counted, so that a test can tell that every signal was seen.
template <template <class, int> class V, GuardPolicy policy, class T = double, int L = 8, int N = 3>
std::vector<double> in_guarded_lanes() {
    std::vector<twins::Rows> rows;
    for (std::uint64_t lane = 0; lane < L; ++lane)
        rows.push_back(twins::taken({.seed = Seed{lane + 1}, .beyond = beyond<T>, .nan = true}, 1000));
    auto const alone = expect_lanes_of<T, L>(
        []<class X>(Problem<X> const& p) { return Guarded<V<X, N>, policy>(p); },
        {.size = 3, .forgetting = 0.9375, .prior = Prior<double>{.variance = 100}}, rows,
        [](auto& f, auto const& row) { return row.k % 50 == 49 ? f.pass_time() : f.update(row.psi, row.y); });
    std::vector<double> all(6);  // of the rows before a theta was lost
    for (twins::Trace const& one : alone) {
        auto last = one.rbegin();
        while (last->of("counts").empty()) ++last;
        for (std::size_t i = 0; i < 6; ++i) all[i] += last->of("counts")[i];
    }
    EXPECT_GT(all[0], 1000) << V<T, N>::name;
    return all;
}
template <template <class, int> class V, GuardPolicy policy, class T = double, int L = 8, int N = 3>
void expect_lanes_to_be_guarded() {
    std::vector<double> const all = in_guarded_lanes<V, policy, T, L, N>();
    EXPECT_GT(all[1], 100) << "unusable";
    EXPECT_GT(all[2], 20) << "outliers";
    EXPECT_GT(all[3], 1) << "changes";
    EXPECT_GT(all[4], 5) << "windups";
}
TEST(GuardedLanes, EachHasTheBitsSignalsAndCountsOfItsOwnGuard) {
    expect_lanes_to_be_guarded<Ud, reporting>();
    expect_lanes_to_be_guarded<Ud, resetting>();
    expect_lanes_to_be_guarded<Ud, GuardPolicy{.outlier = Action::skip, .breakdown = Action::reset}>();
    expect_lanes_to_be_guarded<Ud, GuardPolicy{.change = Action::reset, .windup = Action::cap}>();
    expect_lanes_to_be_guarded<Qr, resetting>();
    expect_lanes_to_be_guarded<Carlson, resetting>();
    expect_lanes_to_be_guarded<Gentleman, resetting>();
    expect_lanes_to_be_guarded<Ud, resetting, double, 4, Dynamic>();
    EXPECT_GT((in_guarded_lanes<Conventional, resetting, float>()[5]), 0) << "breakdowns";
}

/// What no lane can do is refused when it is compiled.
template <class F, GuardPolicy policy>
concept CanBeGuarded = requires { typename Guarded<F, policy>; };
static_assert(CanBeGuarded<Ud<double, 4>, rebuilding> && CanBeGuarded<Ud<Pack<double, 8>, 4>, resetting>);
static_assert(!CanBeGuarded<Ud<Pack<double, 8>, 4>, rebuilding>);
static_assert(!CanBeGuarded<QrBlock<Pack<double, 8>, 4>, resetting>);
template <class F>
concept CanBeWeighted = requires { typename Weighted<F>; };
static_assert(CanBeWeighted<Guarded<Ud<double, 4>>> && !CanBeWeighted<Guarded<Ud<Pack<double, 8>, 4>>>);

TEST(GuardedLanes, RefuseOptionsThatAreNotAlike) {
    using P = Pack<double, 4>;
    P c(6.0), variance(10.0);
    variance.set(2, 20);
    EXPECT_NO_THROW((Guarded<Ud<P, 2>>(Problem<P>{}, {.largest_variance = variance, .innovation = c})));
    c.set(1, 7);
    EXPECT_THROW((Guarded<Ud<P, 2>>(Problem<P>{}, {.innovation = c})), std::invalid_argument);
}

/// Weights of none, below none and no number, in some lanes and now and then in all.
template <template <class, int> class V, class T = double, int L = 8, int N = 3>
void expect_lanes_to_be_weighted() {
    double const odd[] = {0, 0, -1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
    Seed seed{41};
    std::vector<twins::Rows> rows;
    for (int lane = 0; lane < L; ++lane) {
        rows.push_back(twins::taken({.seed = Seed{std::uint64_t(lane)}}, 60));
        for (auto& row : rows.back()) {
            bool const is_odd = row.k % 12 == 11 || (seed.uniform() < 0.3 && row.k % 3 != 0);
            row.w = is_odd ? odd[(row.k + lane) % (row.k % 24 == 11 ? 2 : 5)]
                           : std::ldexp(1 + seed.uniform(), int(20 * seed.bell()));
        }
    }
    expect_lanes_of<T, L>([]<class X>(Problem<X> const& p) { return Weighted<V<X, N>>(p); },
                          {.size = 3, .forgetting = 0.96875}, rows,
                          [](auto& f, auto const& row) {
                              return row.k % 5 == 4 ? f.update(row.psi, row.y) : f.update(row.psi, row.y, row.w);
                          });
}
TEST(WeightedLanes, EachHasTheBitsOfItsOwnWeights) {
    expect_lanes_to_be_weighted<Conventional>();
    expect_lanes_to_be_weighted<Potter>();
    expect_lanes_to_be_weighted<Carlson>();
    expect_lanes_to_be_weighted<Ud>();
    expect_lanes_to_be_weighted<InverseQr>();
    expect_lanes_to_be_weighted<Qr>();
    expect_lanes_to_be_weighted<Gentleman>();
    expect_lanes_to_be_weighted<Ud, double, 4, Dynamic>();
    expect_lanes_to_be_weighted<Qr, float>();
}

}  // namespace
}  // namespace rlslab
