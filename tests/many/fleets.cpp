// Fleets whose filters come, go, begin anew, have problems of their own, miss samples, break down, and are saved and
// loaded: each has the bits of the scalar variant on its own rows. A record keeps the members that its form names, so
// that each form stands here or in fleets_without_prior.cpp.
#include "tests/many/together.hpp"

#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using together::expect_fleets_of;

TEST(Fleet, EachFilterLivesAlone) {
    expect_fleets_of<Conventional>();
    expect_fleets_of<ConventionalTwoSided>();
    expect_fleets_of<Symmetric>();
    expect_fleets_of<Joseph>();
    expect_fleets_of<JosephRankTwo>();
    expect_fleets_of<Potter>();
    expect_fleets_of<Carlson>();
    expect_fleets_of<Ud>();
    expect_fleets_of<InverseQr>();
    expect_fleets_of<ExtendedQr>();
    expect_fleets_of<Kalman>();
}

}  // namespace
}  // namespace rlslab
