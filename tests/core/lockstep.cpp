// Filters in lockstep: lane i of every variant over Pack is, bit for bit, the single filter on the data of lane i.
#include "tests/common/twins.hpp"

#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

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

}  // namespace
}  // namespace rlslab
