// Fleets of forms that start without a prior, and fleets of other shapes: what the number of lanes, the arithmetic and
// a size that is not known do is the same text for all forms, and is tried with one form each.
#include "tests/many/together.hpp"

#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using together::expect_fleets_of;

TEST(Fleet, EachFilterLivesAloneAlsoWithoutPrior) { together::expect_fleets_of_each<Information, Qr, Gentleman>(); }
TEST(Fleet, EachFilterLivesAloneInOtherShapes) {
    expect_fleets_of<Ud, float, 16>();
    expect_fleets_of<Gentleman, double, 4, Dynamic>();
}
/// The saboteur: the filter that is alone forgets by one bit more.
TEST(Fleet, OneBitOfLambdaIsSeen) {
    auto const careless = []<class T>(Problem<T> p) {
        if constexpr (std::same_as<T, double>) p.forgetting = std::nextafter(p.forgetting, 0);
        return Gentleman<T, 3>(p);
    };
    EXPECT_NE(together::parted(together::pair_of<double, 8>(careless), 88, 8, 1), "");
}

}  // namespace
}  // namespace rlslab
