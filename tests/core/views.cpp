// A regressor may be what the filter itself reports: theta and gain are views into it, which the update overwrites.
#include "tests/common/twins.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rlslab {
namespace {

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
