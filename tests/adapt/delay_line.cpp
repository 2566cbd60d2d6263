// A delay line is a shift register whose samples are not moved.
#include <rlslab/adapt/delay_line.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/ud.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>

namespace rlslab {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;

template <class T>
std::vector<T> numbers(Regressor<T> psi) {
    return {psi.data(), psi.data() + psi.size()};
}

/// The definition: N samples, each moved on at every step.
template <class Line>
bool is_a_shift_register(Line line, Index size) {
    std::deque<double> shifted(size_t(size), 0.0);
    Seed seed{std::uint64_t(size)};
    for (int k = 0; k < 5 * size + 7; ++k) {
        double const u = seed.bell();
        shifted.push_front(u);
        shifted.pop_back();
        if (numbers(line.push(u)) != std::vector<double>(shifted.begin(), shifted.end())) return false;
        for (Index i = 0; i < size; ++i)
            if (line[i] != shifted[size_t(i)]) return false;
    }
    return true;
}

/// A ring that is written once: its last N samples are one after another at one step of N.
struct WrittenOnce {
    std::vector<double> ring;
    Index at = 0;
    explicit WrittenOnce(Index size) : ring(size_t(2 * size)) {}
    Regressor<double> push(double u) {
        Index const size = Index(ring.size()) / 2;
        at = (at == 0 ? size : at) - 1;
        ring[size_t(at)] = u;
        return {ring.data() + at, size};
    }
    double operator[](Index i) const { return ring[size_t(at + i)]; }
};

TEST(DelayLine, IsAShiftRegister) {
    for (Index size : {1, 2, 3, 8, 17, 256}) EXPECT_TRUE(is_a_shift_register(DelayLine<double>(size), size)) << size;
    EXPECT_TRUE(is_a_shift_register(DelayLine<double, 1>(), 1));
    EXPECT_TRUE(is_a_shift_register(DelayLine<double, 3>(), 3));
    EXPECT_TRUE(is_a_shift_register(DelayLine<double, 64>(), 64));
    EXPECT_FALSE(is_a_shift_register(WrittenOnce(3), 3));
}

TEST(DelayLine, FeedsAFilterWithTheBitsOfRowsThatAreCopied) {
    DelayLine<float, 5> line;
    Ud<float, 5> from_line({.size = 5}), from_rows({.size = 5});
    std::array<float, 5> row{};
    Seed seed{11};
    for (int k = 0; k < 50; ++k) {
        float const u = float(seed.bell()), y = float(seed.bell());
        std::rotate(row.rbegin(), row.rbegin() + 1, row.rend());
        row[0] = u;
        EXPECT_EQ(from_line.update(line.push(u), y).innovation, from_rows.update(row, y).innovation);
    }
    EXPECT_EQ(Vector<float>(from_line.theta()), Vector<float>(from_rows.theta()));
}

TEST(DelayLine, WhatIsNotFiniteLeavesIt) {
    DelayLine<double, 3> line;
    line.push(std::nan(""));
    for (int k = 0; k < 2; ++k) EXPECT_TRUE(std::isnan(line.push(k)[1 + k]));
    EXPECT_THAT(numbers(line.push(2)), ElementsAre(2, 1, 0));
    line.push(INFINITY);
    line.clear();
    EXPECT_THAT(numbers(line.psi()), ElementsAre(0, 0, 0));
    EXPECT_THAT(numbers(line.push(4)), ElementsAre(4, 0, 0));
}

TEST(DelayLine, TakesItsOwnSampleAgain) {
    DelayLine<double, 3> line;
    for (double u : {1.0, 2.0, 3.0}) line.push(u);
    line.push(line[2]);  // which the step overwrites
    EXPECT_THAT(numbers(line.psi()), ElementsAre(1, 3, 2));
}

TEST(DelayLine, IsCopiedWithItsSamplesAndMovedAway) {
    DelayLine<double> line(3);
    for (double u : {1.0, 2.0, 3.0, 4.0}) line.push(u);
    DelayLine<double> copy = line;
    line.push(5);
    EXPECT_THAT(numbers(copy.psi()), ElementsAre(4, 3, 2));
    EXPECT_THAT(numbers(copy.push(6)), ElementsAre(6, 4, 3));
    DelayLine<double> moved = std::move(line);
    EXPECT_THAT(numbers(moved.psi()), ElementsAre(5, 4, 3));
    EXPECT_EQ(line.size(), 0);  // NOLINT(bugprone-use-after-move)
    EXPECT_EQ(line.push(1).size(), 0);
    line = copy;
    EXPECT_THAT(numbers(line.psi()), ElementsAreArray(numbers(copy.psi())));
}

TEST(DelayLine, HoldsAnyScalar) {
    DelayLine<Pack<double, 4>, 2> line;
    line.push(Pack<double, 4>(1));
    EXPECT_EQ(line.push(Pack<double, 4>(2))[1][3], 1);
}

TEST(DelayLine, RefusesWhatIsNoSize) {
    for (Index size : {0, -1, -7}) EXPECT_THROW(DelayLine<double>{size}, std::invalid_argument) << size;
    EXPECT_THROW(DelayLine<double>{}, std::invalid_argument);
    EXPECT_THROW((DelayLine<double, 3>{4}), std::invalid_argument);
}

}  // namespace
}  // namespace rlslab
