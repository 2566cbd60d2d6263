// Filters in lockstep: lane i of every variant over Pack is, bit for bit, the single filter on the data of lane i.
#include "tests/common/laws.hpp"

#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <bit>

namespace rlslab {
namespace {

/// The same bits; any NaN is the same NaN.
template <class T>
bool same(T a, T b) {
    using Word = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
    return std::bit_cast<Word>(a) == std::bit_cast<Word>(b) || (a != a && b != b);
}

/// Rows of noise for every lane, and lanes that meet trouble on the way: a zero row, a NaN, an overflow, tiny numbers.
template <class T, int L>
std::vector<std::vector<T>> rows_of_lanes(Index size, int k, Seed& seed) {
    std::vector<std::vector<T>> rows(L, std::vector<T>(size_t(size) + 1));
    for (int lane = 0; lane < L; ++lane)
        for (T& x : rows[size_t(lane)]) x = T(seed.bell());
    auto const spoil = [&](int lane, int step, T value) {
        if (k == step)
            for (T& x : rows[size_t(lane % L)]) x = value;
    };
    spoil(1, 0, T(0));
    spoil(1, 5, T(0));
    spoil(2, 9, std::numeric_limits<T>::quiet_NaN());
    spoil(3, 7, std::numeric_limits<T>::max());
    spoil(4, 4, std::numeric_limits<T>::denorm_min());
    if (k == 6) rows[5 % L][0] = 0;
    return rows;
}

/// Where lockstep and single filters part: "" or variant, lane and step.
template <class Many, class One>
std::string parted(Index size, bool with_prior) {
    using P = typename Many::scalar;
    using T = typename One::scalar;
    constexpr int L = P::lanes;
    Problem<P> many{.size = size, .forgetting = P(T(0.96875))};
    Problem<T> one{.size = size, .forgetting = T(0.96875)};
    if (!with_prior) {
        many.prior.reset();
        one.prior.reset();
    }
    Many together(many);
    std::vector<One> alone(L, One(one));
    Seed seed{7};
    for (int k = 0; k < 40; ++k) {
        auto const rows = rows_of_lanes<T, L>(size, k, seed);
        Vector<P> psi(size);
        P y;
        for (int lane = 0; lane < L; ++lane) {
            for (Index i = 0; i < size; ++i) psi[i].set(lane, rows[size_t(lane)][size_t(i)]);
            y.set(lane, rows[size_t(lane)][size_t(size)]);
        }
        Step<P> const step = together.update(psi, y);
        Vector<P> const theta = together.theta(), gain = together.gain();
        auto const stored = together.stored();
        for (int lane = 0; lane < L; ++lane) {
            One& f = alone[size_t(lane)];
            Step<T> const expected = f.update({rows[size_t(lane)].data(), size}, rows[size_t(lane)][size_t(size)]);
            Vector<T> const t = f.theta(), g = f.gain();
            auto const s = f.stored();
            bool equal = same(step.innovation[lane], expected.innovation) &&
                         same(step.residual[lane], expected.residual) && same(step.gamma[lane], expected.gamma) &&
                         step.health[lane] == expected.health;
            for (Index i = 0; i < size; ++i) equal = equal && same(theta[i][lane], t[i]) && same(gain[i][lane], g[i]);
            // A filter that is lost to NaN may spread it over the half of a triangle that nothing reads.
            bool const lost = !t.allFinite();
            for (Index j = 0; j < size && !lost; ++j)
                for (Index i = 0; i < size; ++i) equal = equal && same(stored.F(i, j)[lane], s.F(i, j));
            for (Index i = 0; i < stored.D.size(); ++i) equal = equal && same(stored.D[i][lane], s.D[i]);
            if (!equal)
                return std::string(One::name) + ": lane " + std::to_string(lane) + " at step " + std::to_string(k) +
                       ", size " + std::to_string(size) + (with_prior ? "" : ", no prior") + ": " +
                       std::string(name_of(step.health[lane])) + " and " + std::string(name_of(expected.health));
        }
    }
    return "";
}

template <class T, int L>
void expect_lockstep() {
    [&]<class... Many, class... One>(TypeList<Many...>, TypeList<One...>) {
        auto const check = [&]<class M, class O>() {
            for (Index size : {1, 2, 3, 5, 8, 11, 17}) {
                EXPECT_EQ((parted<M, O>(size, true)), "");
                if constexpr (StartsWithoutPrior<O>) {
                    EXPECT_EQ((parted<M, O>(size, false)), "");
                }
            }
        };
        (check.template operator()<Many, One>(), ...);
    }(Variants<Pack<T, L>>{}, Variants<T>{});
}

TEST(Lockstep, EightDoublesAreEightFilters) { expect_lockstep<double, 8>(); }
TEST(Lockstep, SixteenFloatsAreSixteenFilters) { expect_lockstep<float, 16>(); }

/// A pack whose square root is one ulp off in one lane is noticed.
TEST(Lockstep, TheLawCanFail) {
    Pack<double, 8> a(2.0);
    a.set(3, std::nextafter(2.0, 3.0));
    EXPECT_FALSE(same(sqrt(a * a)[3], 2.0));
    EXPECT_TRUE(same(sqrt(a * a)[2], 2.0));
    EXPECT_TRUE(any(a == Pack<double, 8>(2.0)));
    EXPECT_FALSE(all(a == Pack<double, 8>(2.0)));
}

}  // namespace
}  // namespace rlslab
