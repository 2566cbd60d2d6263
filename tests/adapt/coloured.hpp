// What the tests of extended least squares and instrumental variables share.
#pragma once

#include "tests/adapt/adapt.hpp"

#include <rlslab/state/state.hpp>

#include <gtest/gtest.h>

namespace rlslab::adapt_laws {

inline constexpr double lambda = 0.96875;

template <class T>
Problem<T> problem_of(Index size, double variance = 64, double forgetting = lambda) {
    return {.size = size, .forgetting = T(forgetting), .prior = Prior<T>{.variance = T(variance)}};
}

// --- states, in float ------------------------------------------------------------------------------------------------

template <class F, class Take>
void check_state(F const& saved, F const& other, Take take) {
    F f = saved, g = other;
    take(f, 40, Seed{1});
    auto const bytes = state_of(f);
    EXPECT_NE(state_of(g), bytes);
    ASSERT_EQ(load(g, std::span<std::byte const>(bytes)), StateFault::none);
    take(f, 60, Seed{2}), take(g, 60, Seed{2});
    EXPECT_EQ(state_of(f), state_of(g));
    EXPECT_TRUE(Vector<float>(f.theta()) == Vector<float>(g.theta()));
    for (size_t i = 0; i < 8 * bytes.size(); ++i) {
        auto wrong = bytes;
        wrong[i / 8] ^= std::byte(1 << i % 8);
        EXPECT_NE(load(g, std::span<std::byte const>(wrong)), StateFault::none) << i;
    }
    EXPECT_EQ(state_of(f), state_of(g));
}
/// A list that leaves out the member i is seen.
template <class F, size_t i, class Take>
bool is_missed(F const& saved, F const& other, Take take) {
    F f = saved, g = other;
    take(f, 40, Seed{1});
    auto to = F::state(g);
    auto const from = F::state(std::as_const(f));
    [&]<size_t... j>(std::index_sequence<j...>) {
        ((j == i ? void() : void(std::get<j>(to) = std::get<j>(from))), ...);
    }(std::make_index_sequence<std::tuple_size_v<decltype(to)>>());
    take(f, 3, Seed{2}), take(g, 3, Seed{2});
    return Vector<float>(f.theta()) != Vector<float>(g.theta()) || f.stored().F != g.stored().F;
}
}  // namespace rlslab::adapt_laws
