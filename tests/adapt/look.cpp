// An update in two steps: looking changes no bit, and looking and committing are the update.
#include <rlslab/adapt/look.hpp>

#include "tests/adapt/adapt.hpp"
#include "tests/common/twins.hpp"

#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/window.hpp>
#include <rlslab/arithmetic/chopped.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace adapt_laws;

/// Looks at other rows, then at this, and commits it. Whether a look changed the filter, and how far its e and gamma
/// are from those of the step.
struct Looks {
    double worst_e = 0, worst_gamma = 0;
    bool changed = false;
    template <class F, class T>
    Step<T> operator()(F& f, twins::Row<T> const& row) {
        auto const before = state_of(f);
        Vector<T> const other = row.psi.reverse();
        detail::look_at(f, Regressor<T>(other), T(NAN));
        detail::look_at(f, Regressor<T>(other), row.y + T(1));
        Innovation<T> const look = detail::look_at(f, Regressor<T>(row.psi), row.y);
        changed = changed || state_of(f) != before;
        Step<T> const step = detail::commit(f, look, Regressor<T>(row.psi), row.y);
        worst_e = std::max(worst_e, std::abs(double(look.e - step.innovation)) / (1 + std::abs(double(row.y))));
        worst_gamma = std::max(worst_gamma, std::abs(double(T(0.96875) / look.s) - double(step.gamma)));
        return step;
    }
};
void expect_look(std::string_view name, Looks const& looks, double budget, double epsilon) {
    EXPECT_FALSE(looks.changed) << name;
    EXPECT_LE(looks.worst_e, budget) << name;
    EXPECT_LE(looks.worst_gamma, 100 * epsilon) << name;
}
/// One filter is only looked at between rows; the other takes the rows in one step.
template <class F>
void check_look(double budget) {
    using T = typename F::scalar;
    F const f(Problem<T>{.size = 4, .forgetting = T(0.96875), .prior = Prior<T>{.variance = RealOf<T>(100)}});
    twins::Rows const rows = twins::taken({.seed = Seed{11}, .d = 4}, 60);
    Looks looks;
    auto const act = [&looks](F& g, twins::Row<T> const& row) { return looks(g, row); };
    twins::expect_one(F::name, twins::trace(f, rows, true, act), twins::trace(f, rows, true));
    expect_look(F::name, looks, budget, double(epsilon<T>()));
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

/// Where the least numbers are coarse, `qr` does not look by itself: from its form.
TEST(Look, OfQrInCoarseNumbersIsThatOfItsForm) {
    using T = Chopped<Format{24, -20, 60}>;
    static_assert(!LooksFirst<Qr<T, 4>>);
    check_look<Qr<T, 4>>(1e-5);
}

}  // namespace
}  // namespace rlslab
