// What a guard goes back to: the filter is sound there for the rows at hand, and theta is no worse than the filter's
// alone. What it learns of the noise after rows that had none.
#include <rlslab/adapt/guard.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/arithmetic/pack.hpp>

#include <gtest/gtest.h>

#include <functional>

namespace rlslab {
namespace {

using namespace adapt_laws;

/// |theta - (1, -2, 3, ...)| after 3000 rows of `scale` times bell-shaped noise, with noise of a tenth of that.
template <class F>
double error_of(F& f, double scale, Index d) {
    using T = typename F::scalar;
    Seed seed{7};
    Vector<T> psi(d);
    for (int k = 0; k < 3000; ++k) {
        double y = 0.1 * scale * seed.bell();
        for (Index i = 0; i < d; ++i) {
            psi[i] = T(scale * seed.bell());
            y += double(psi[i]) * double(i % 2 ? -(i + 1) : i + 1);
        }
        f.update(psi, T(y));
    }
    double square = 0;
    for (Index i = 0; i < d; ++i) square += std::pow(double(f.theta()[i]) - double(i % 2 ? -(i + 1) : i + 1), 2);
    return std::sqrt(square);
}
template <class F>
void check_remedy(double scale, double forgetting, double variance, Index d = 8) {
    using T = typename F::scalar;
    Problem<T> const problem{.size = d, .forgetting = T(forgetting), .prior = Prior<T>{.variance = T(variance)}};
    Ud<T> sound(problem);
    double const best = error_of(sound, scale, d);
    auto const check = [&](auto guarded, char const* policy) {
        double const error = error_of(guarded, scale, d);
        EXPECT_LE(error, 4 * best) << F::name << ' ' << policy << " scale " << scale << " P0 " << variance;
        EXPECT_LE(guarded.counts().breakdowns, 6)
            << F::name << ' ' << policy << " scale " << scale << " P0 " << variance;
        EXPECT_EQ(guarded.counts().changes, 0) << F::name << ' ' << policy;
    };
    check(Guarded<F, resetting>(problem), "reset");
    check(Guarded<F, rebuilding>(problem), "rebuild");
}
/// A reset that brings back the P0 that broke the filter breaks it at the next row, and so on: 2994 of 3000 rows.
TEST(Remedies, AreSoundForTheRowsAtHand) {
    for (double const scale : {20, 40, 100, 1000}) check_remedy<Information<float>>(scale, 1, 16384);
    check_remedy<Information<float>>(100, 0.98, 16384);
    check_remedy<Information<double>>(1e6, 1, 16384);
    check_remedy<Information<double>>(1e8, 0.98, 16384);
    for (double const variance : {1, 100, 16384}) check_remedy<Conventional<float>>(std::sqrt(0.125), 1, variance);
    check_remedy<Conventional<float>>(0.5, 1, 16384, 4);
    check_remedy<Conventional<float>>(100, 1, 16384);
    check_remedy<Conventional<double>>(1e6, 1, 16384);
    check_remedy<Symmetric<float>>(100, 1, 16384);
    check_remedy<Symmetric<double>>(1e6, 1, 16384);
    check_remedy<Joseph<float>>(100, 1, 16384);
    check_remedy<Joseph<double>>(1e6, 1, 16384);
}
/// ud breaks down nowhere there: the guard leaves its bits.
TEST(Remedies, AreNotCalledForWhereNothingBroke) {
    for (double const scale : {0.3, 20., 100., 1000.}) {
        Ud<float> alone({.size = 8});
        Guarded<Ud<float>> guarded({.size = 8});
        error_of(alone, scale, 8), error_of(guarded, scale, 8);
        EXPECT_EQ(guarded.counts().breakdowns, 0) << scale;
        EXPECT_TRUE(identical(guarded.filter(), alone)) << scale;
    }
}

using Roots = TypeList<Qr<double>, Gentleman<double>, Information<double>>;
/// Without a prior, and 100 rows in which columns depend but for rounding: theta was 1e14 there, "sound", and the first
/// change brought it back.
struct Start {
    char const* what;
    std::function<void(Seed&, double (&)[3])> row;
};
Start const starts[] = {{"13.47 beside ones", [](Seed&, double (&x)[3]) { x[1] = 13.47; }},
                        {"13.5 beside ones", [](Seed&, double (&x)[3]) { x[1] = 13.5; }},
                        {"a multiple", [](Seed&, double (&x)[3]) { x[1] = 1.7 * x[2]; }},
                        {"a sum", [](Seed&, double (&x)[3]) { x[1] = x[0] + x[2]; }},
                        {"zeros", [](Seed&, double (&x)[3]) { x[1] = 0; }}};
template <class G>
void check_start(G guarded, Start const& start) {
    Seed seed{83};
    for (int k = 0; k < 400; ++k) {
        double x[3] = {1, 3 * seed.bell(), 3 * seed.bell()};
        if (k < 100) start.row(seed, x);
        Health const health = guarded.update(x, 1.9 + 0.508 * x[1] - 0.803 * x[2] + 0.1 * seed.bell()).health;
        EXPECT_EQ(health, k <= 100 ? Health::undetermined : Health::sound) << G::name << ' ' << start.what << ' ' << k;
    }
    double const theta[] = {1.9, 0.508, -0.803};
    for (Index i = 0; i < 3; ++i) EXPECT_NEAR(guarded.theta()[i], theta[i], 0.1) << G::name << ' ' << start.what;
    EXPECT_EQ(guarded.counts().changes + guarded.counts().breakdowns, 0) << G::name << ' ' << start.what;
}
TEST(Remedies, TakeNoThetaThatRoundingMade) {
    for_each(Roots{}, []<class F>() {
        for (Start const& start : starts)
            for (double const forgetting : {1.0, 0.99}) {
                Problem<double> const problem{.size = 3, .forgetting = forgetting, .prior = std::nullopt};
                check_start(Guarded<F, resetting>(problem), start);
                check_start(Guarded<F, rebuilding>(problem), start);
                Windowed<F> const window(problem, {.rows = 60});
                check_start(Guarded<Windowed<F>, resetting>(window, problem), start);
            }
    });
}

/// Without a prior nothing has the units of theta: other units of each column, by powers of two, change no signal and
/// scale theta exactly. A prior of 16384 held theta where it was for columns of 1e-4, and their P was windup.
double const units[][3] = {
    {0x1p-20, 0x1p-20, 0x1p-20}, {0x1p20, 0x1p20, 0x1p20}, {0x1p20, 1, 0x1p-20}, {0x1p-33, 8, 1}};
double const before[] = {4, 1, -2}, after[] = {4, -3, 5};
/// Clean rows to 500, then those of another theta.
double row_of(Seed& seed, int k, double (&psi)[3]) {
    psi[0] = 1, psi[1] = seed.bell(), psi[2] = 5 + seed.bell();
    double y = 0.1 * seed.bell();
    for (int i = 0; i < 3; ++i) y += psi[i] * (k < 500 ? before : after)[i];
    return y;
}
template <class G>
void check_units(G one, double const (&unit)[3], std::function<void(G&)> damage = nullptr) {
    G other = one;
    Seed seed{97};
    double psi[3], scaled[3];
    auto const expect_near = [&](double const(&theta)[3]) {
        for (Index i = 0; i < 3; ++i)
            EXPECT_NEAR(one.theta()[i], theta[i], 5 * 0.1 * std::sqrt(variance(one, i))) << G::name << i;
    };
    for (int k = 0; k < 1000; ++k) {
        double const y = row_of(seed, k, psi);
        for (int i = 0; i < 3; ++i) scaled[i] = unit[i] * psi[i];
        if (k == 700 && damage) damage(one), damage(other);
        one.update(psi, y), other.update(scaled, y);
        EXPECT_EQ(one.signal(), other.signal()) << G::name << k;
        for (Index i = 0; i < 3 && k > 2; ++i) {
            double const x = one.theta()[i], z = unit[i] * other.theta()[i];
            ASSERT_TRUE(x == z || (damage && std::isnan(x) && std::isnan(z))) << G::name << ' ' << unit[0] << ' ' << k;
        }
        if (k == 499) expect_near(before);
    }
    expect_near(after);
    EXPECT_EQ(one.counts().changes, 1) << G::name;
    EXPECT_EQ(one.counts().windups, 0) << G::name;
    EXPECT_EQ(one.counts().breakdowns, damage ? 1 : 0) << G::name;
}
TEST(Remedies, HaveNoUnitsWithoutAPrior) {
    auto const check = []<class F>(std::type_identity<F>, double const(&unit)[3], auto damage) {
        for (double const forgetting : {1.0, 0.99}) {
            Problem<double> const problem{.size = 3, .forgetting = forgetting, .prior = std::nullopt};
            using Reset = Guarded<F, resetting>;
            using Rebuilt = Guarded<F, rebuilding>;
            check_units(Reset(problem), unit);
            check_units(Rebuilt(problem), unit);
            check_units(Reset(problem), unit, std::function<void(Reset&)>(damage));
            check_units(Rebuilt(problem), unit, std::function<void(Rebuilt&)>(damage));
            check_units(Guarded<Windowed<F>>(Windowed<F>(problem, {.rows = 150}), problem), unit);
        }
    };
    for (auto const& unit : units) {
        check(std::type_identity<Qr<double>>{}, unit, [](auto& g) { g.form().L(1, 1) = 0; });
        check(std::type_identity<Gentleman<double>>{}, unit, [](auto& g) { g.form().D[1] = 0; });
        check(std::type_identity<Information<double>>{}, unit, [](auto& g) { g.form().X(1, 1) *= -1; });
    }
}
/// One row again and again until the other directions are forgotten, or silence: no theta of rounding is held after.
TEST(Remedies, HoldNoThetaThatWasForgotten) {
    for_each(Roots{}, []<class F>() {
        for (double const alike : {0.0, 0.7}) {
            Guarded<F> guarded({.size = 3, .forgetting = 0.98, .prior = std::nullopt});
            Seed seed{101};
            double psi[3];
            for (int k = 0; k < 40000; ++k) {
                double y = row_of(seed, k, psi);
                if (1000 <= k && k < 39700) {
                    y = alike * seed.bell();
                    for (int i = 0; i < 3; ++i) psi[i] = alike * (i + 1), y += psi[i] * after[i];
                }
                guarded.update(psi, y);
            }
            for (Index i = 0; i < 3; ++i)
                EXPECT_NEAR(guarded.theta()[i], after[i], 0.5 * std::sqrt(variance(guarded, i))) << F::name << alike;
        }
    });
}
/// In packs, too: each lane has the bits of the scalar guard on the rows of its units.
template <template <class, int> class V>
void check_units_of_lanes() {
    using P = Pack<double, 4>;
    Guarded<V<P, 3>> together({.size = 3, .prior = std::nullopt});
    std::vector<Guarded<V<double, 3>>> alone(4, Guarded<V<double, 3>>({.size = 3, .prior = std::nullopt}));
    Seed seed{97};
    for (int k = 0; k < 1000; ++k) {
        double psi[3];
        double const y = row_of(seed, k, psi);
        Vector<P> rows(3);
        P outputs;
        for (int lane = 0; lane < 4; ++lane) {
            double scaled[3];
            double const own = lane == 3 && k == 600 ? 1e3 : y;
            for (int i = 0; i < 3; ++i) rows[i].set(lane, scaled[i] = units[lane][i] * psi[i]);
            outputs.set(lane, own);
            alone[size_t(lane)].update(scaled, own);
        }
        together.update(rows, outputs);
        for (int lane = 0; lane < 4; ++lane)
            for (int i = 0; i < 3 && k > 2; ++i)
                ASSERT_EQ(together.theta()[i][lane], alone[size_t(lane)].theta()[i]) << lane << ' ' << k;
    }
    for (int lane = 0; lane < 4; ++lane) EXPECT_EQ(together.counts().of_lane(lane).changes, 1) << lane;
}
TEST(Remedies, HaveNoUnitsInLanes) {
    check_units_of_lanes<Qr>();
    check_units_of_lanes<Gentleman>();
}

/// Rows without noise, then noise: s2 stayed near 0, and each later row was an outlier.
TEST(Remedies, LearnTheNoiseAnewAfterRowsThatHadNone) {
    struct Case {
        char const* what;
        double (*output)(Index k, double (&psi)[2], Seed& seed);
        Index outliers;
    };
    auto const usual = [](double const(&psi)[2], Seed& seed) { return psi[0] - 2 * psi[1] + 0.1 * seed.bell(); };
    static auto const of = usual;
    Case const cases[] = {
        {"zeros first",
         [](Index k, double(&psi)[2], Seed& seed) {
             if (k < 60) psi[0] = psi[1] = 0;
             return k < 60 ? 0 : of(psi, seed);
         },
         20},
        {"exact rows first",
         [](Index k, double(&psi)[2], Seed& seed) { return k < 200 ? psi[0] - 2 * psi[1] : of(psi, seed); }, 20},
        {"a constant, then noise about it",
         [](Index k, double(&psi)[2], Seed& seed) {
             psi[0] = 1;
             return 20.5 + (k < 200 ? 0 : 0.1 * seed.bell());
         },
         20},
        {"in steps",
         [](Index, double(&psi)[2], Seed& seed) {
             for (double& x : psi) x = std::round(2 * x);
             return std::round(psi[0] - 2 * psi[1] + 0.2 * seed.bell());
         },
         20},
        {"noise from the start", [](Index, double(&psi)[2], Seed& seed) { return of(psi, seed); }, 0}};
    for (Case const& c : cases) {
        Guarded<Ud<double>, reporting> guarded({.size = 2});
        Ud<double> alone({.size = 2});
        Seed seed{89};
        for (Index k = 0; k < 1000; ++k) {
            double psi[2] = {seed.bell(), seed.bell()};
            double const y = c.output(k, psi, seed);
            guarded.update(psi, y), alone.update(psi, y);
        }
        EXPECT_LE(guarded.counts().outliers, c.outliers) << c.what;
        EXPECT_LE(guarded.counts().changes, c.outliers / 5) << c.what;
        EXPECT_TRUE(identical(guarded.filter(), alone)) << c.what;  // it reports, and does no more
    }
}

/// Products of sizes that wrapped made vectors that were too short: 8 * 2^61 numbers are none.
TEST(Sizes, WhoseProductWrapsAreRefused) {
    for (int const bits : {58, 60, 61, 62}) {
        Index const many = Index(1) << bits;
        EXPECT_THROW((Guarded<Ud<double>, rebuilding>({.size = 7}, {.rebuild_rows = many})), std::invalid_argument)
            << bits;
        EXPECT_THROW((Guarded<Ud<double, 7>, rebuilding>({}, {.rebuild_rows = many})), std::invalid_argument) << bits;
        EXPECT_THROW(Windowed<Ud<double>>({.size = 7}, {.rows = many}), std::invalid_argument) << bits;
        EXPECT_THROW(Ud<double>({.size = many}), std::invalid_argument) << bits;
        EXPECT_THROW(Ud<double>({.size = Index(1) << bits / 2}), std::invalid_argument) << bits;
        EXPECT_THROW(Information<float>({.size = many + 8}), std::invalid_argument) << bits;
    }
    static_assert(product_fits(0, std::size_t(-1)) && product_fits(std::size_t(1) << 40, 1000));
    static_assert(!product_fits(8, std::size_t(1) << 61) && !product_fits(std::size_t(1) << 32, std::size_t(1) << 32));
}

}  // namespace
}  // namespace rlslab
