// Fleets whose filters come, go, begin anew, have problems of their own, miss samples, break down, and are saved and
// loaded: each has the bits of the scalar variant on its own rows. A record keeps the members that its form names, so
// that each form stands here or in fleets_without_prior.cpp.
#include "tests/many/together.hpp"

#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

TEST(Fleet, EachFilterLivesAlone) {
    together::expect_fleets_of_each<Conventional, ConventionalTwoSided, Symmetric, Joseph, JosephRankTwo, Potter,
                                    Carlson, Ud, InverseQr, ExtendedQr, Kalman>();
}

}  // namespace
}  // namespace rlslab
