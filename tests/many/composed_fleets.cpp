// Fleets of guarded and weighted filters: each has the bits, counts and state of the scalar composition.
#include "tests/many/lanes.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace lanes;
using together::expect_fleets_of;

template <template <class, int> class V>
struct GuardedAs {
    template <class T>
    auto operator()(Problem<T> const& p) const {
        return Guarded<V<T, 3>>(p);
    }
};
TEST(GuardedFleet, EachFilterIsGuardedAlone) {
    expect_fleets_of<double, 8>(GuardedAs<Ud>{});
    expect_fleets_of<double, 8>(GuardedAs<Qr>{});
    expect_fleets_of<float, 8>(GuardedAs<Conventional>{});
}
TEST(RuledFleet, EachFilterIsRuledAndGuardedAlone) {
    expect_fleets_of<double, 8>([]<class T>(Problem<T> const& p) {
        auto const ruled = Ruled<Ud, Fortescue, 3>{}(p);
        return Guarded<std::remove_cvref_t<decltype(ruled)>>(ruled, p);
    });
}
TEST(WeightedFleet, TakesAWeightForEachSample) {
    expect_fleets_of<double, 8>([]<class T>(Problem<T> const& p) { return Weighted<Ud<T, 3>>(p); });
}

/// Options are the fleet's: a guard's, too.
TEST(GuardedFleet, FiltersTakeTheOptionsOfTheFleet) {
    auto const make = []<class T>(Problem<T> const& problem) {
        return Guarded<Ud<T, 3>>(problem, {.innovation = T(4), .noise_memory = 50});
    };
    Fleet<Guarded<Ud<Pack<double, 8>, 3>>> fleet(3, {}, make), without(3, {});
    EXPECT_NO_THROW(fleet.put(1, make(Problem<double>{})));
    EXPECT_NO_THROW(fleet.put(2, fleet.filter(1)));
    EXPECT_THROW(fleet.put(1, Guarded<Ud<double, 3>>(Problem<double>{})), std::invalid_argument);
    EXPECT_NE(load(without, state_of(fleet)), StateFault::none);
    without.put(1, Guarded<Ud<double, 3>>({}, {.largest_variance = 5}));
    without.remove(1);
    EXPECT_THROW(without.signal(1), std::invalid_argument);
    EXPECT_THROW(without.guard_counts(1), std::invalid_argument);
}
/// A file that says more learnt rows than there is room for.
TEST(GuardedFleet, RefusesACountBeyondItsEnd) {
    BoundedCountOf<Lanes<Index, 4>> count{2, 3};
    std::array<std::byte, Encoding<decltype(count)>::size> bytes;
    Encoding<decltype(count)>::write(count, bytes.data());
    EXPECT_TRUE(Encoding<decltype(count)>::read(bytes.data(), count));
    count.n.value[2] = 4;
    Encoding<decltype(count)>::write(count, bytes.data());
    EXPECT_FALSE(Encoding<decltype(count)>::read(bytes.data(), count));
}

}  // namespace
}  // namespace rlslab
