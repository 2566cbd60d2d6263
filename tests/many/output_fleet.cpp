// A fleet of several real outputs leaves the bits of filters of its own, output by output, with weights.
#include "tests/many/output_fleet.hpp"

namespace rlslab {
namespace {

using namespace outputs;

/// Lanes and arithmetics are one text for all forms: the others with the first alone.
TEST(OutputFleet, KeepsTheBitsOfFiltersOfTheirOwn) {
    expect_the_bits<Ud, float>(3, 3), expect_the_bits<Ud, double>(7, 3, Start::full);
    expect_the_bits<UdDelta, double>(8, 2, Start::full), expect_the_bits<Carlson, float>(4, 2);
    expect_the_bits<Potter, double>(7, 2, Start::full), expect_the_bits<Conventional, float>(5, 2);
    expect_the_bits<Symmetric, double>(13, 2, Start::full), expect_the_bits<JosephRankTwo, float>(4, 3);
    expect_the_bits<InverseQr, double>(8, 2, Start::full);
}
TEST(OutputFleet, OfFormsThatSolveForThetaHasOneOutput) {
    expect_the_bits<Qr, float>(4, 1), expect_the_bits<Information, double>(3, 1);
    expect_the_bits<Qr, double>(3, 1, Start::no_prior), expect_the_bits<Gentleman, float>(2, 1, Start::no_prior);
}
TEST(OutputFleet, ABitOfOneOutputOrWeightIsFound) { expect_a_bit_to_be_found<double>(); }
TEST(OutputFleet, RefusesWhatItCannotBe) {
    using Solves = OutputFleet<Qr<Complex<Pack<float, 8>>>>;
    using Stores = OutputFleet<Ud<Pack<float, 8>>>;
    EXPECT_THROW(Solves(3, {.size = 2}, 2), std::invalid_argument);
    EXPECT_THROW(Solves(3, {.size = 1, .prior = Prior<Complex<float>>{.theta = Vector<Complex<float>>(1)}}),
                 std::invalid_argument);
    EXPECT_THROW(Stores(0, {.size = 2}), std::invalid_argument);
    EXPECT_THROW(Stores(1, {.size = 2}, 0), std::invalid_argument);
    EXPECT_THROW(Stores(1, {.size = 0}), std::invalid_argument);
    Stores fleet(1, {.size = 2});
    EXPECT_THROW(fleet.theta(1), std::invalid_argument);
    EXPECT_THROW(fleet.reset(1), std::invalid_argument);
    EXPECT_THROW(fleet.health(-1), std::invalid_argument);
    FleetSteps<float> steps(1, 2);
    float const x[2] = {};
    EXPECT_THROW(fleet.update(x, x, nullptr, &steps), std::invalid_argument);
}

}  // namespace
}  // namespace rlslab
