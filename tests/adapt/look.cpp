// An update in two steps: looking changes no bit, and looking and committing are the update.
#include <rlslab/adapt/look.hpp>
#include <rlslab/adapt/window.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/carlson_delta.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/conventional_two_sided.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/information.hpp>
#include <rlslab/variants/inverse_qr.hpp>
#include <rlslab/variants/inverse_qr_delta.hpp>
#include <rlslab/variants/joseph.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/potter.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace adapt_laws;

/// One filter is only looked at between rows, with these rows and with others; the other takes the rows in one step.
template <class F>
void check_look(double budget) {
    using T = typename F::scalar;
    Problem<T> const problem{.size = 4, .forgetting = T(0.96875), .prior = Prior<T>{.variance = RealOf<T>(100)}};
    F looked(problem), whole(problem);
    Seed seed{11}, others{12};
    T psi[4], other[4];
    for (int k = 0; k < 60; ++k) {
        T const y = draw(seed, psi), y2 = draw(others, other);
        auto const before = state_of(looked);
        detail::look_at(looked, Regressor<T>(other, 4), T(NAN));
        detail::look_at(looked, Regressor<T>(other, 4), y2);
        EXPECT_EQ(state_of(looked), before) << F::name << ' ' << k;
        Innovation<T> const row = detail::look_at(looked, Regressor<T>(psi, 4), y);
        EXPECT_EQ(state_of(looked), before) << F::name << ' ' << k;
        Step<T> const step = detail::commit(looked, row, Regressor<T>(psi, 4), y), same = whole.update(psi, y);
        EXPECT_EQ(state_of(looked), state_of(whole)) << F::name << ' ' << k;
        EXPECT_TRUE(step.innovation == same.innovation && step.gamma == same.gamma && step.health == same.health);
        EXPECT_TRUE(budget > 0 || row.e == same.innovation) << F::name << ' ' << k;
        EXPECT_NEAR(double(row.e - same.innovation), 0, budget * (1 + std::abs(double(y)))) << F::name << ' ' << k;
        EXPECT_NEAR(double(T(0.96875) / row.s), double(same.gamma), 100 * double(epsilon<T>())) << F::name << ' ' << k;
    }
}
template <class... F>
void check_all() {
    (check_look<F>(LooksFirst<F> ? 0 : 1e-12), ...);
}
TEST(Look, ChangesNothingAndCommitsTheUpdate) {
    check_all<Conventional<double, 4>, ConventionalTwoSided<double, 4>, Symmetric<double>, Joseph<double, 4>,
              JosephRankTwo<double, 4>, Potter<double, 4>, Carlson<double, 4>, CarlsonDelta<double, 4>, Ud<double>,
              UdDelta<double>, InverseQr<double, 4>, InverseQrDelta<double, 4>, Information<double, 4>, Qr<double, 4>,
              Gentleman<double, 4>>();
    check_look<Ud<float, 4>>(0);
    check_look<Symmetric<Half, 4>>(0);
}
TEST(Look, ThroughAWindowIsThatOfTheFilterInIt) {
    check_look<Windowed<Ud<double, 4>>>(0);
    check_look<Windowed<Gentleman<double, 4>>>(1e-12);
}
/// A rule works before or after the row: what is known of the row is known of the filter inside.
TEST(Look, ThroughARuleIsThatOfTheFilterInside) {
    Forgetting<Ud<double, 4>, RandomWalk<double>> f({.forgetting = 1}, {.variance = 0.001});
    run_rows(f, 50, Seed{1});
    Ud<double, 4> inside = f.filter();
    double const psi[] = {1, 2, -1, 0.5};
    auto const before = state_of(f);
    Innovation<double> const row = detail::look_at(f, Regressor<double>(psi, 4), 3.0), same = inside.look(psi, 3.0);
    EXPECT_TRUE(row.e == same.e && row.s == same.s);
    EXPECT_EQ(state_of(f), before);
}
TEST(Look, RefusesAnotherNumberOfParameters) {
    Ud<double> ud({.size = 4});
    Qr<double> qr({.size = 4});
    double const psi[] = {1, 2, 3};
    EXPECT_THROW(detail::look_at(ud, Regressor<double>(psi, 3), 1.0), std::invalid_argument);
    EXPECT_THROW(detail::look_at(qr, Regressor<double>(psi, 3), 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace rlslab
