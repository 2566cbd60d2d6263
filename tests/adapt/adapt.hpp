// What the tests of adapt/ share: rows, P of a filter, comparisons, and the law that states go on.
#pragma once

#include "tests/common/same.hpp"
#include "tests/common/states.hpp"

#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <gtest/gtest.h>

namespace rlslab::adapt_laws {

/// One row of bell-shaped noise in psi and y = psi'(1, -2, 3, ...) + noise.
template <class Psi, class T = std::remove_cvref_t<decltype(std::declval<Psi&>()[0])>>
T draw(Seed& seed, Psi& psi, double noise = 0.125, double sign = 1) {
    double y = noise * seed.bell();
    for (int i = 0; i < int(std::size(psi)); ++i) {
        psi[i] = T(seed.bell());
        y += double(psi[i]) * sign * (i % 2 ? -(i + 1) : i + 1);
    }
    return T(y);
}
/// f takes so many of them; what is left of the seed.
template <class F>
Seed run_rows(F& f, int rows, Seed seed, double noise = 0.125, double sign = 1) {
    Vector<typename F::scalar> psi(f.theta().size());
    for (int k = 0; k < rows; ++k) {
        auto const y = draw(seed, psi, noise, sign);
        f.update(psi, y);
    }
    return seed;
}

template <class T>
Problem<T> problem_of(Index size, double variance = 64, double forgetting = 0.96875) {
    return {.size = size, .forgetting = T(forgetting), .prior = Prior<T>{.variance = T(variance)}};
}

/// P in double, from whatever is stored.
template <class F>
Matrix<double> covariance_of(F const& f) {
    auto const stored = f.stored().template mapped<double>([](auto const& x) { return double(x); });
    return covariance_of(stored, [](Matrix<double> const& X) { return Matrix<double>(X.inverse()); });
}
inline double relative(Matrix<double> const& a, Matrix<double> const& b) {
    return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

/// The same stored bits and the same theta.
template <class F>
bool identical(F const& a, F const& b) {
    auto const x = a.stored(), y = b.stored();
    return x.F == y.F && x.D == y.D && a.theta() == b.theta();
}

/// What no theta shows: intervals and their share, certificates.
template <class F>
void expect_the_same_reports(F const& f, F const& g) {
    if constexpr (requires { f.share(); }) {
        EXPECT_EQ(f.interval(Index(1)).high, g.interval(Index(1)).high);
        EXPECT_EQ(f.share(), g.share());
    }
    if constexpr (requires { f.certificate(); }) {
        auto const a = f.certificate(), b = g.certificate();
        EXPECT_TRUE(same(a.estimate, b.estimate) && same(a.bound, b.bound) && same(a.theta, b.theta));
    }
}
/// Two filters through take(f, rows, seed): one loaded from the other goes on with its bits; damaged bytes are refused.
template <class F, class Take>
void check_state(F const& saved, F const& other, Take take) {
    F f = saved, g = other;
    take(f, 40, Seed{1});
    auto const bytes = states::bytes_of(f);
    EXPECT_NE(states::bytes_of(g), bytes);
    ASSERT_EQ(load(g, bytes), StateFault::none);
    take(f, 60, Seed{2}), take(g, 60, Seed{2});
    EXPECT_EQ(state_of(f), state_of(g));
    EXPECT_TRUE(f.theta() == g.theta());
    expect_the_same_reports(f, g);
    int accepted = 0;
    states::each_damaged(bytes, [&](states::Bytes const& wrong) { accepted += load(g, wrong) == StateFault::none; });
    EXPECT_EQ(accepted, 0);
    EXPECT_EQ(state_of(f), state_of(g));
}
/// A list that leaves out the member i is seen.
template <class F, size_t i, class Take>
bool is_missed(F const& saved, F const& other, Take take) {
    F f = saved, g = other;
    take(f, 40, Seed{1});
    states::take_all_but<i>(g, f);
    take(f, 3, Seed{2}), take(g, 3, Seed{2});
    return f.theta() != g.theta() || f.stored().F != g.stored().F;
}

}  // namespace rlslab::adapt_laws
