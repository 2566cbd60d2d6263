// What is left of a guarded filter in float after ten million rows of abuse. tests/long_run does a thousand million by
// hand.
#include "tests/long_run/abuse.hpp"

#include <rlslab/adapt/guard.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using long_run::lambda;

template <class F>
long_run::Survived survive(F& f, Index rows, unsigned seed) {
    return long_run::survive(f, rows, Seed{seed}, rows, [](Index, auto const&) {});
}
template <class F>
F made() {
    return F({.forgetting = float(lambda), .prior = Prior<float>{.variance = 100}});
}
TEST(GuardedFilter, OutlivesTenMillionRowsOfAbuseInFloat) {
    auto g = made<Guarded<Ud<float, 5>>>();
    long_run::Survived const s = survive(g, 10'000'000, 71);
    EXPECT_EQ(s.not_finite, 0);
    EXPECT_EQ(s.not_definite, 0);
    for (size_t i = 0; i < long_run::names.size(); ++i) {
        EXPECT_GT(s.compared[i], 900) << long_run::names[i];
        EXPECT_EQ(s.worse[i], 0) << long_run::names[i] << ": " << s.ratio[i];
    }
    EXPECT_GT(g.counts().changes, 900);
    EXPECT_GT(g.counts().unusable, 5000);
}
TEST(GuardedFilter, WhatItGuardsDoesNot) {
    auto bare = made<Ud<float, 5>>();
    long_run::Survived const s = survive(bare, 100'000, 71);
    EXPECT_GT(s.not_finite, 0);
    EXPECT_GT(s.not_definite, 0);
    EXPECT_GT(s.all_worse(), 0);
    auto watched = made<Guarded<Ud<float, 5>, reporting>>();
    EXPECT_GT(survive(watched, 100'000, 71).all_worse(), 0);
}

}  // namespace
}  // namespace rlslab
