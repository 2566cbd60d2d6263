// A regressor may be what the filter itself reports: theta and gain are views into it, which the update overwrites.
#include "tests/common/laws.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rlslab {
namespace {

template <class F>
F after_ten_rows() {
    using T = typename F::scalar;
    F f(Problem<T>{.size = 3, .forgetting = T(0.96875)});
    Seed seed{9};
    for (int k = 0; k < 10; ++k) {
        Vector<T> const psi = Vector<T>::NullaryExpr(3, [&seed] { return T(seed.bell()); });
        f.update(psi, T(seed.bell()));
    }
    return f;
}

template <class F>
bool same(F const& a, F const& b) {
    using T = typename F::scalar;
    Vector<T> const theta[] = {a.theta(), b.theta()}, gain[] = {a.gain(), b.gain()};
    auto const equal = [](auto const& x, auto const& y) {
        bool out = x.size() == y.size();
        for (Index j = 0; j < x.cols(); ++j)
            for (Index i = 0; i < x.rows(); ++i) out = out && all(x(i, j) == y(i, j));
        return out;
    };
    return equal(theta[0], theta[1]) && equal(gain[0], gain[1]) && equal(a.stored().F, b.stored().F) &&
           equal(a.stored().D, b.stored().D);
}

template <class... F>
void a_view_is_as_good_as_a_copy(TypeList<F...> variants) {
    for_each(variants, []<class G>() {
        using T = typename G::scalar;
        G viewed = after_ten_rows<G>(), copied = viewed;
        ASSERT_TRUE(same(viewed, copied)) << G::name;
        Vector<T> const K = copied.gain();
        viewed.update(viewed.gain(), T(2));
        copied.update(K, T(2));
        EXPECT_TRUE(same(viewed, copied)) << G::name << ": gain() for psi";
        Vector<T> const theta = copied.theta();
        viewed.update(viewed.theta(), T(2));
        copied.update(theta, T(2));
        EXPECT_TRUE(same(viewed, copied)) << G::name << ": theta() for psi";
        if constexpr (Accumulates<G>) {
            Vector<T> const again = copied.gain();
            viewed.accumulate(viewed.gain(), T(2));
            copied.accumulate(again, T(2));
            EXPECT_TRUE(same(viewed, copied)) << G::name << ": gain() for psi, no report";
        }
    });
}

TEST(Views, AnUpdateReadsItsRegressorBeforeItOverwritesIt) {
    a_view_is_as_good_as_a_copy(Variants<double>{});
    a_view_is_as_good_as_a_copy(Variants<float>{});
    a_view_is_as_good_as_a_copy(Variants<Chopped<binary16>>{});
    a_view_is_as_good_as_a_copy(Variants<Pack<double, 4>>{});
    for_each(Variants<double>{}, []<class F>() {
        if constexpr (!std::is_void_v<AtSize<F, 3>>) a_view_is_as_good_as_a_copy(TypeList<AtSize<F, 3>>{});
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
