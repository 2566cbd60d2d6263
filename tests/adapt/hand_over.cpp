// A filter hands over to a sounder one in time; a guard around that, and around a window.
#include <rlslab/adapt/hand_over.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace adapt_laws;

constexpr double lambda = 0.98, u = 0x1p-53;

// --- the share -------------------------------------------------------------------------------------------------------

template <class F>
F after_rows(double spread, unsigned seed, Vector<double> const& units = Vector<double>::Ones(4)) {
    F f({.size = 4, .forgetting = 0.96875, .prior = Prior<double>{.variance = 1e6}});
    if (units[0] != 1) {
        Matrix<double> P0 = Matrix<double>::Zero(4, 4);
        for (Index i = 0; i < 4; ++i) P0(i, i) = 1e6 / (units[i] * units[i]);
        f = F({.size = 4, .forgetting = 0.96875, .prior = Prior<double>{.covariance = P0}});
    }
    Seed rows{seed};
    for (int k = 0; k < 60; ++k) {
        double const common = rows.bell();
        double psi[4];
        for (int i = 0; i < 4; ++i) psi[i] = units[i] * (common + spread * rows.bell());
        f.update(psi, rows.bell());
    }
    return f;
}
template <class F>
double share_of(F f) {
    StateMatrix<double, detail::size_of<F>> L(4);
    StateVector<double, detail::size_of<F>> D(4);
    return least_share(f.form(), L, D);
}
template <class F>
void check_share() {
    for (unsigned seed : {1, 2, 3})
        for (double spread : {1.0, 0.1, 1e-3}) {
            F const f = after_rows<F>(spread, seed);
            Eigen::MatrixXd C = multiplied_out(f.stored());
            Vector<double> const scale = C.diagonal().cwiseSqrt().cwiseInverse();
            C = scale.asDiagonal() * C * scale.asDiagonal();
            double const least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(C).eigenvalues()[0],
                         share = share_of(f);
            double const rounding = 100 * u;  // of C, whose norm is at most 4
            EXPECT_GE(share, least - rounding) << F::name << spread;
            EXPECT_LE(share * share * share / 2.72, least + rounding) << F::name << spread;
            EXPECT_LE(share, 1) << F::name;
            if (spread < 0.01) {
                EXPECT_LT(share, 1e-3) << F::name;
            }
        }
}
TEST(LeastShare, BoundsTheLeastEigenvalue) {
    check_share<Symmetric<double, 4>>();
    check_share<JosephRankTwo<double>>();
    check_share<Information<double, 4>>();
    check_share<Ud<double, 4>>();
    check_share<Carlson<double>>();
    check_share<Qr<double, 4>>();
    check_share<Gentleman<double>>();
    static_assert(!ReportsLeastShare<Potter<double, 4>>);  // its root has no pivots
}
template <class F>
bool knows_no_units(double (*share)(F)) {
    return share(after_rows<F>(0.1, 5)) == share(after_rows<F>(0.1, 5, Vector<double>{{16.0, 0.25, 1024.0, 2.0}}));
}
TEST(LeastShare, KnowsNoUnits) {
    EXPECT_TRUE((knows_no_units<Symmetric<double, 4>>(share_of)));
    EXPECT_TRUE((knows_no_units<Ud<double, 4>>(share_of)));
    EXPECT_TRUE((knows_no_units<Information<double, 4>>(share_of)));
    EXPECT_FALSE((knows_no_units<Ud<double, 4>>([](Ud<double, 4> f) {  // the pivots alone
        auto const D = f.stored().D;
        return D.minCoeff() / D.maxCoeff();
    })));
}

// --- the relay -------------------------------------------------------------------------------------------------------

template <class F, class Sounder>
void check_same_bits() {
    using T = typename F::scalar;
    Problem<T> const problem{.size = 4, .forgetting = T(lambda), .prior = Prior<T>{.variance = 100}};
    Relay<F, Sounder> relay(problem);
    F bare(problem);
    run_rows(relay, 5000, Seed{72});
    run_rows(bare, 5000, Seed{72});
    EXPECT_FALSE(relay.handed_over()) << F::name;
    EXPECT_TRUE(identical(relay.first(), bare)) << F::name;
    EXPECT_EQ((Vector<T, 4>(relay.theta())), (Vector<T, 4>(bare.theta())));
}
TEST(Relay, HasTheFirstFiltersBitsWhereRowsAreGood) {
    check_same_bits<Symmetric<float, 4>, Ud<float, 4>>();
    check_same_bits<JosephRankTwo<double, 4>, Qr<double, 4>>();
    check_same_bits<Ud<float, 4>, Ud<double, 4>>();
    check_same_bits<Information<float, 4>, Qr<double, 4>>();
}

/// The largest |log2| of a generalised eigenvalue; infinite where P is not definite.
double distance(Matrix<double> const& P, Matrix<double> const& exact) {
    Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> const of{Eigen::MatrixXd(P), Eigen::MatrixXd(exact)};
    double out = 0;
    for (double x : of.eigenvalues()) out = std::max(out, x > 0 ? std::abs(std::log2(x)) : INFINITY);
    return out;
}
struct Course {
    bool handed = false;
    double off =
        0;  ///< the largest |log2| of a generalised eigenvalue of P beside the reference's, 10 rows after the hand-over
    double theta = 0;  ///< of theta beside it at the end, in the reference's standard deviations
    double end = 0;    ///< `off` at the end
};
/// 200 good rows, then 3000 whose coordinates differ by `spread` alone. The reference is ud in double.
template <class F>
Course near_collinear(F f, double spread, unsigned seed) {
    using T = typename F::scalar;
    Ud<double, 4> exact({.forgetting = double(T(lambda)), .prior = Prior<double>{.variance = 100}});
    Course out;
    Seed rows{seed};
    int since = 0;
    for (int k = 0; k < 3200; ++k) {
        T psi[4];
        double same[4], y = 0.1 * rows.bell();
        double const common = rows.bell();
        for (int i = 0; i < 4; ++i) {
            psi[i] = T(k < 200 ? rows.bell() : common + spread * rows.bell());
            same[i] = double(psi[i]);
            y += same[i] * (i + 1);
        }
        f.update(psi, T(y));
        exact.update(same, double(T(y)));
        if constexpr (requires { f.handed_over(); })
            if (f.handed_over() && ++since == 10) {
                out.handed = true;
                out.off = distance(covariance_of(f.second()), covariance_of(exact));
            }
    }
    Matrix<double> const P = covariance_of(exact);
    for (Index i = 0; i < 4; ++i)
        out.theta = std::max(out.theta, std::abs(double(f.theta()[i]) - exact.theta()[i]) / std::sqrt(P(i, i)));
    out.end = distance(covariance_of(f), P);
    return out;
}
template <class F>
F start() {
    using T = typename F::scalar;
    return F({.size = 4, .forgetting = T(lambda), .prior = Prior<T>{.variance = 100}});
}
TEST(Relay, HandsOverWhilePStillHasDigits) {
    for (unsigned seed : {1, 2, 3}) {
        using S = Symmetric<float, 4>;
        Course const relay = near_collinear(start<Relay<S, Ud<double, 4>>>(), 1e-4, seed),
                     bare = near_collinear(start<S>(), 1e-4, seed);
        EXPECT_TRUE(relay.handed) << seed;
        EXPECT_LT(relay.off, 1) << seed;
        EXPECT_LT(relay.theta, 0.1) << seed;
        EXPECT_LT(relay.end, 1) << seed;
        EXPECT_GT(bare.end, 1) << seed;  // what it is handed over for
        Relay<S, Ud<double, 4>> late({.size = 4, .forgetting = float(lambda), .prior = Prior<float>{.variance = 100}},
                                     {.bits = 0, .every = 1 << 30});
        Course const too_late = near_collinear(late, 1e-4, seed);
        EXPECT_FALSE(too_late.handed && too_late.off < 1) << seed;
    }
}
TEST(Relay, GoesOnAfterAStateThatNoLongerFactors) {
    auto relay = start<Relay<Conventional<double, 4>, Ud<double, 4>>>();
    run_rows(relay, 300, Seed{1});
    auto broken = relay;
    EXPECT_TRUE(relay.hand_over());
    EXPECT_FALSE(relay.hand_over());
    EXPECT_LT((relay.theta() - relay.first().theta()).norm(), 1e-300);
    restart(broken, -1.0, Regressor<double>({1.0, 2.0, 3.0, 4.0}), lambda);  // P = -I
    EXPECT_FALSE(broken.hand_over());
    EXPECT_TRUE(broken.handed_over());
    EXPECT_EQ((Vector<double>(broken.theta())), (Vector<double>{{1.0, 2.0, 3.0, 4.0}}));
    EXPECT_EQ(variance(broken, 2), 100);
    run_rows(broken, 300, Seed{2});
    EXPECT_NEAR(broken.theta()[3], -4, 0.2);
}
TEST(Relay, RefusesWhatMakesNoSense) {
    using R = Relay<Symmetric<float, 4>, Ud<double, 4>>;
    EXPECT_THROW(R({}, {.bits = -1}), std::invalid_argument);
    EXPECT_THROW(R({}, {.bits = 60}), std::invalid_argument);
    EXPECT_THROW(R({}, {.every = -1}), std::invalid_argument);
    EXPECT_THROW(R({.size = 3}), std::invalid_argument);
    R handed{Problem<float>{}};
    handed.hand_over();
    EXPECT_THROW(handed.update({1.0f, 2.0f}, 1), std::invalid_argument);
    EXPECT_EQ(handed.update({1.0f, NAN, 0.0f, 0.0f}, 1).health, Health::nonfinite);
    static_assert(RecursiveLeastSquares<R> && Guardable<R> && HandsOver<R> && !Downdates<R> && !TimeUpdates<R>);
    static_assert(!HandsOver<Ud<double, 4>>);
}

// --- a guard that hands over -----------------------------------------------------------------------------------------

TEST(Guarded, HandsOverOnceInPlaceOfManyResets) {
    Problem<double> const problem{.forgetting = lambda, .prior = Prior<double>{.variance = 100}};
    for (unsigned seed : {72, 73, 74}) {
        Guarded<Relay<Conventional<double, 4>, Ud<double, 4>>, handing_over> g(problem);
        Guarded<Conventional<double, 4>> reset_often(problem);
        run_rows(g, 20000, Seed{seed});
        run_rows(reset_often, 20000, Seed{seed});
        EXPECT_EQ(g.counts().breakdowns, 1) << seed;
        EXPECT_TRUE(g.filter().handed_over()) << seed;
        EXPECT_GT(reset_often.counts().breakdowns, 5) << seed;
        EXPECT_NEAR(g.theta()[1], -2, 0.2) << seed;
        Ud<double, 4> from_the_start(problem);
        run_rows(from_the_start, 20000, Seed{seed});
        EXPECT_LE((g.theta() - from_the_start.theta()).norm(), 1e-9) << seed;
    }
}
TEST(Guarded, HandsOverWhatIsLeftOfABrokenState) {
    Problem<double> const problem{.forgetting = lambda, .prior = Prior<double>{.variance = 100}};
    Guarded<Relay<Symmetric<double, 4>, Ud<double, 4>>, handing_over> g(problem);
    run_rows(g, 500, Seed{71});
    Vector<double> const before = g.theta();
    EXPECT_EQ(g.update({1.0, 0.0, NAN, 0.0}, 1.0).health, Health::nonfinite);
    EXPECT_FALSE(g.filter().handed_over());
    auto& held = const_cast<Relay<Symmetric<double, 4>, Ud<double, 4>>&>(g.filter());
    restart(held, double(NAN), Regressor<double>(before), lambda);
    run_rows(g, 1, Seed{5});
    EXPECT_TRUE(g.filter().handed_over());
    EXPECT_EQ(g.counts().breakdowns, 1);
    EXPECT_TRUE(g.theta().allFinite());
    run_rows(g, 300, Seed{6});
    EXPECT_NEAR(g.theta()[3], -4, 0.2);
    static_assert(!GuardPolicy{.change = Action::hand_over}.valid() &&
                  !GuardPolicy{.windup = Action::hand_over}.valid());
}

// --- a guard around a window -----------------------------------------------------------------------------------------

template <class F, GuardPolicy policy = resetting>
struct GuardedWindow : Guarded<Windowed<F>, policy> {
    using Guarded<Windowed<F>, policy>::Guarded;
};
Problem<double> const windowed{.forgetting = 0.995, .prior = Prior<double>{.variance = 100}};

template <class F>
void check_window() {
    Guarded<Windowed<F>> g(windowed);
    Windowed<F> bare(windowed);
    run_rows(g, 3000, Seed{72});
    run_rows(bare, 3000, Seed{72});
    EXPECT_TRUE(identical(g.filter().filter(), bare.filter())) << F::name;
    EXPECT_EQ(g.counts().outliers + g.counts().changes + g.counts().windups + g.counts().breakdowns, 0) << F::name;
    Windowed<F> const before = g.filter();
    g.update({1.0, double(INFINITY), 0.0, 0.0}, 1.0);
    g.update({1.0, 0.0, 0.0, 0.0}, 1e9);
    EXPECT_EQ(g.signal(), GuardSignal::outlier);
    EXPECT_TRUE(identical(g.filter(), before)) << F::name;
    EXPECT_FALSE(g.filter().spoilt());
    double psi[4];  // a change: the window starts anew at once
    Seed rows{9};
    for (int k = 0; k < 40; ++k) {
        double const y = draw(rows, psi, 0.125, -1);
        g.update(psi, y);
    }
    EXPECT_EQ(g.counts().changes, 1) << F::name;
    EXPECT_LE(g.filter().rows(), 40) << F::name;
    EXPECT_NEAR(g.theta()[1], 2, 0.3) << F::name;
}
TEST(Guarded, GoesAroundAWindow) {
    check_window<Ud<double, 4>>();
    check_window<Qr<double, 4>>();
    check_window<Symmetric<double, 4>>();
    using G = Guarded<Windowed<Ud<float, 4>>, rebuilding>;
    static_assert(RecursiveLeastSquares<G> && !TimeUpdates<G> && !TimeUpdates<Windowed<Ud<float, 4>>>);
    // A window around what skips rows, or forgets by a rule, would take back what it never took.
    static_assert(!Downdates<Guarded<Ud<double, 4>>> && !Downdates<Forgetting<Ud<double, 4>, Fortescue<double>>>);
}
TEST(Windowed, RestartedIsAWindowThatStartsThere) {
    Problem<double> const from{.forgetting = 0.96875,
                               .prior = Prior<double>{.variance = 4, .theta = Vector<double>{{1.0, 2.0, 3.0, 4.0}}}};
    Windowed<Ud<double, 4>> w({.forgetting = 0.96875, .prior = Prior<double>{.variance = 64}},
                              {.rows = 20, .refactor_every = 7});
    run_rows(w, 55, Seed{3});
    restart(w, 4.0, Regressor<double>({1.0, 2.0, 3.0, 4.0}), 0.5);
    Windowed<Ud<double, 4>> fresh(from, {.rows = 20, .refactor_every = 7});
    EXPECT_EQ(w.rows(), 0);
    for (int rows : {1, 10, 30, 50}) {
        run_rows(w, rows, Seed{unsigned(rows)});
        run_rows(fresh, rows, Seed{unsigned(rows)});
        EXPECT_TRUE(identical(w.filter(), fresh.filter())) << rows;
    }
}
/// Silence in a window that forgets: P grows as lambda^-k, and is held by rows that are none of the window.
TEST(Guarded, CapsAWindowToo) {
    Guarded<Windowed<Ud<double, 4>>> g(windowed);
    Guarded<Windowed<Ud<double, 4>>, reporting> watched(windowed);
    run_rows(g, 600, Seed{1});
    run_rows(watched, 600, Seed{1});
    Vector<double> const before = g.theta();
    double most = 0;
    for (int k = 0; k < 4000; ++k) {
        g.update({0.0, 0.0, 0.0, 0.0}, 0.1);
        watched.update({0.0, 0.0, 0.0, 0.0}, 0.1);
        if (k % 10 == 0) most = std::max(most, covariance_of(g.filter()).diagonal().maxCoeff());
    }
    EXPECT_TRUE(g.theta().allFinite());
    EXPECT_LT(most, 1e6);
    EXPECT_GT(watched.counts().windups + watched.filter().refactored(), 0);
    run_rows(g, 600, Seed{4});
    EXPECT_NEAR(g.theta()[3], -4, 0.2);
}

}  // namespace
}  // namespace rlslab
