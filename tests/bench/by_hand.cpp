// The hand-written loops that the benchmarks time have the bits of the library.
#include "bench/by_hand.hpp"

#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace {

using namespace rlslab;
namespace by_hand = rlslab::bench::by_hand;

template <class Ours, class Hand>
void expect_the_same_bits(Index size) {
    Problem<double> const problem{.size = size, .forgetting = 0.99, .prior = Prior<double>{.variance = 10}};
    Ours ours(problem);
    Hand hand(problem);
    Seed seed{3};
    Vector<double> psi(size);
    for (int k = 0; k < 500; ++k) {
        for (double& x : psi) x = seed.bell();
        double const y = seed.bell();
        ours.update(psi, y);
        hand.update(psi, y);
        ASSERT_EQ(Vector<double>(ours.theta()), Vector<double>(hand.theta())) << Ours::name << ' ' << size << ' ' << k;
    }
}
template <int N>
void compare_all() {
    expect_the_same_bits<Conventional<double, N>, by_hand::Conventional<N>>(N);
    expect_the_same_bits<Symmetric<double, N>, by_hand::Symmetric<N>>(N);
    expect_the_same_bits<Ud<double, N>, by_hand::Ud<N>>(N);
    expect_the_same_bits<Potter<double, N>, by_hand::Potter<N>>(N);
    expect_the_same_bits<Carlson<double, N>, by_hand::Carlson<N>>(N);
    expect_the_same_bits<Ud<double>, by_hand::Ud<N>>(N);
}

TEST(ByHand, LoopsHaveTheBitsOfTheLibrary) {
    compare_all<2>();
    compare_all<3>();
    compare_all<4>();
    compare_all<5>();
    compare_all<6>();
}

}  // namespace
