// What compares twins (tests/common/twins.hpp) sees one bit: the saboteurs of all laws that rest on it.
#include "tests/common/twins.hpp"

#include <rlslab/variants/ud.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rlslab::twins {
namespace {

Left left(double x) { return Left().add("theta", 1.0).add("gain", std::vector<double>{0.5, NAN, x}); }

TEST(Twins, OneBitIsSeen) {
    EXPECT_EQ(parted(left(3), left(3)), "");
    EXPECT_EQ(parted(left(3), left(std::nextafter(3, 4))), "gain[2]: 0x1.8p+1 and 0x1.8000000000001p+1");
    EXPECT_EQ(parted(Trace{left(1), left(3)}, Trace{left(1), left(2)}), "gain[2] at row 1: 0x1.8p+1 and 0x1p+1");
    EXPECT_EQ(parted(left(3), Left().add("theta", 1.0)), "all: 4 and 1 numbers");
    EXPECT_NE(parted(left(0), left(-0.0)), "");
    EXPECT_NE(parted(left(0), left(NAN)), "");
    EXPECT_EQ(parted(left(-NAN), left(NAN)), "");
    EXPECT_NE(parted(Trace{left(1)}, Trace{}), "");
    EXPECT_EQ(left(3).of("gain").size(), 3u);
}
TEST(Twins, OneBitOfALongNumberIsSeen) {
    Reference const third = Reference(1) / 3, other = third + Reference(0x1p-200);
    EXPECT_EQ(parted(Left().add("P", third), Left().add("P", third)), "");
    EXPECT_NE(parted(Left().add("P", third), Left().add("P", other)), "");
}
/// A filter whose first row had another bit, and lanes that were exchanged.
TEST(Twins, OneBitOfOneRowIsSeen) {
    std::vector<Rows> rows;
    for (std::uint64_t lane = 0; lane < 4; ++lane) rows.push_back(taken({Seed{lane}}, 20));
    auto const one = trace(Ud<double>({.size = 3}), rows[1], true);
    auto const lanes = traces(Ud<Pack<double, 4>>({.size = 3}), rows, true);
    EXPECT_EQ(parted(one, lanes[1]), "");
    EXPECT_NE(parted(one, lanes[2]), "");
    rows[1][0].psi[2] = std::nextafter(rows[1][0].psi[2], 9);
    EXPECT_NE(parted(one, trace(Ud<double>({.size = 3}), rows[1])), "");
    EXPECT_NE(parted(Left().add("state", traces(Ud<Pack<double, 4>>({.size = 3}), rows, true)[1].back().of("state")),
                     Left().add("state", lanes[1].back().of("state"))),
              "");
}

}  // namespace
}  // namespace rlslab::twins
