// What compares twins (tests/common/twins.hpp) sees one bit: the saboteurs of all laws that rest on it. Then twins of
// the core: lanes and single filters, regressors that are views and copies.
#include "tests/common/twins.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rlslab {
namespace {

using twins::Left, twins::parted, twins::Rows, twins::taken, twins::trace, twins::Trace, twins::traces;

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

// Filters in lockstep: lane i of every variant over Pack is, bit for bit, the single filter on the data of lane i.

/// Rows of noise for every lane, and lanes that meet trouble on the way: a zero row, a NaN, an overflow, tiny numbers.
template <class T, int L>
std::vector<twins::Rows> rows_of_lanes(Index size) {
    using Limits = std::numeric_limits<T>;
    Seed seed{7};
    std::vector<twins::Rows> rows(L);
    for (Index k = 0; k < 40; ++k)
        for (twins::Rows& mine : rows) {
            Vector<double> const psi = Vector<double>::NullaryExpr(size, [&] { return seed.bell(); });
            mine.push_back({psi, seed.bell(), 1, k});
        }
    auto const spoil = [&](size_t lane, size_t k, T value) {
        rows[lane][k].psi.setConstant(value), rows[lane][k].y = value;
    };
    spoil(1, 0, T(0)), spoil(1, 5, T(0));
    spoil(2, 9, Limits::quiet_NaN());
    spoil(3, 7, Limits::max());
    spoil(4, 4, Limits::denorm_min());
    rows[5][6].psi[0] = 0;
    return rows;
}
template <class Many, class One, class T, int L>
void check(Index size, bool with_prior) {
    auto const rows = rows_of_lanes<T, L>(size);
    Problem<double> problem{.size = size, .forgetting = 0.96875};
    if (!with_prior) problem.prior.reset();
    std::vector<twins::Trace> alone;
    for (twins::Rows const& mine : rows) alone.push_back(twins::trace(One(twins::in<T>(problem)), mine));
    twins::expect_one(One::name, twins::traces(Many(twins::in<Pack<T, L>>(problem)), rows), alone);
}
template <class T, int L>
void check_all() {
    [&]<class... Many, class... One>(TypeList<Many...>, TypeList<One...>) {
        for (Index size : {1, 2, 3, 5, 8, 11, 17}) {
            SCOPED_TRACE(size);
            (check<Many, One, T, L>(size, true), ...);
            ((StartsWithoutPrior<One> ? check<Many, One, T, L>(size, false) : void()), ...);
        }
    }(Variants<Pack<T, L>>{}, Variants<T>{});
}
TEST(Lockstep, EightDoublesAreEightFilters) { check_all<double, 8>(); }
TEST(Lockstep, SixteenFloatsAreSixteenFilters) { check_all<float, 16>(); }

// A regressor may be what the filter itself reports: theta and gain are views into it, which the update overwrites.

/// Ten rows, and then what the filter shows for psi, as a view or as a copy.
template <bool copies>
struct ShownForPsi {
    template <class F, class T>
    auto operator()(F& f, twins::Row<T> const& row) const {
        if (row.k < 10) return f.update(row.psi, row.y);
        Vector<T> const gain = f.gain(), theta = f.theta();
        if (row.k % 2) return copies ? f.update(theta, T(2)) : f.update(f.theta(), T(2));
        if constexpr (Accumulates<F>) copies ? f.accumulate(gain, T(2)) : f.accumulate(f.gain(), T(2));
        Vector<T> const again = f.gain();
        return copies ? f.update(again, T(2)) : f.update(f.gain(), T(2));
    }
};
template <class F>
void check() {
    using T = typename F::scalar;
    F const f(Problem<T>{.size = 3, .forgetting = T(0.96875)});
    if constexpr (requires { T::lanes; }) {
        std::vector const rows(T::lanes, twins::taken({Seed{9}}, 14));
        twins::expect_one(F::name, twins::traces(f, rows, false, ShownForPsi<false>{}),
                          twins::traces(f, rows, false, ShownForPsi<true>{}));
    } else {
        twins::Rows const rows = twins::taken({Seed{9}}, 14);
        twins::expect_one(F::name, twins::trace(f, rows, false, ShownForPsi<false>{}),
                          twins::trace(f, rows, false, ShownForPsi<true>{}));
    }
}
template <class T>
void check_all() {
    for_each(Variants<T>{}, []<class F>() { check<F>(); });
}
TEST(Views, AnUpdateReadsItsRegressorBeforeItOverwritesIt) {
    check_all<double>();
    check_all<float>();
    check_all<Chopped<binary16>>();
    check_all<Pack<double, 4>>();
    for_each(Variants<double>{}, []<class F>() {
        if constexpr (!std::is_void_v<AtSize<F, 3>>) check<AtSize<F, 3>>();
    });
}

/// Where malloc puts them, whatever the registers: with -march=native and AVX-512 a vector of packs crashed.
static_assert(alignof(Pack<double, 8>) <= 16 && alignof(Pack<float, 16>) <= 16);

/// The sign of a zero is a lane's, too.
TEST(Views, APackOfMinusZerosIsMinusZeroInEveryLane) {
    Pack<double, 4> const d(-0.0);
    Pack<float, 8> const f(-0.0f);
    for (int lane = 0; lane < 4; ++lane) EXPECT_TRUE(std::signbit(d[lane])) << lane;
    for (int lane = 0; lane < 8; ++lane) EXPECT_TRUE(std::signbit(f[lane])) << lane;
    EXPECT_FALSE(std::signbit(Pack<double, 4>(0.0)[2]));
    EXPECT_TRUE(std::isnan(Pack<double, 4>(std::numeric_limits<double>::quiet_NaN())[1]));
    EXPECT_EQ((Pack<double, 4>(std::numeric_limits<double>::infinity())[3]), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace rlslab
