// Whether theta is determined: a pivot that rounding left is none, one that is only small is one, whatever the units.
#include <rlslab/adapt/window.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <functional>

namespace rlslab {
namespace {

/// Row k of three regressors.
using RowOf = std::function<void(Index k, Seed& seed, double (&psi)[3])>;
struct Dependent {
    char const* what;
    RowOf row;
};
Dependent const dependent[] = {
    {"a constant beside ones", [](Index, Seed& s, double (&x)[3]) { x[0] = 1, x[1] = 13.47, x[2] = s.bell(); }},
    {"a constant beside ones, last", [](Index, Seed& s, double (&x)[3]) { x[0] = 1, x[1] = s.bell(), x[2] = 0.7; }},
    {"a constant of 1e8 behind one of 1e-8",
     [](Index, Seed& s, double (&x)[3]) { x[0] = 1.3e-8, x[1] = s.bell(), x[2] = 0.7e8; }},
    {"a multiple", [](Index, Seed& s, double (&x)[3]) { x[0] = s.bell(), x[1] = s.bell(), x[2] = 1.7 * x[0]; }},
    {"rows that stand still", [](Index, Seed&, double (&x)[3]) { x[0] = 0.1, x[1] = -1.3, x[2] = 2.7; }},
    {"two rows in turns",
     [](Index k, Seed&, double (&x)[3]) { x[0] = 1, x[1] = k % 2 ? 0.3 : -0.1, x[2] = 0.7 * x[1]; }},
};
void independent(Seed& s, double (&x)[3]) {
    for (double& number : x) number = s.bell();
}
double output(double const (&x)[3], Seed& s) { return 2 * x[0] - x[1] + 0.5 * x[2] + 0.01 * s.bell(); }
template <class F>
Step<typename F::scalar> take(F& f, double const (&x)[3], double y) {
    using T = typename F::scalar;
    T const psi[3] = {T(x[0]), T(x[1]), T(x[2])};
    return f.update(psi, T(y));
}

template <class F>
void check_dependent(Index rows) {
    for (Dependent const& record : dependent)
        for (double const lambda : {1.0, 0.984375}) {
            Seed seed{41};
            F f({.size = 3, .forgetting = typename F::scalar(lambda), .prior = std::nullopt});
            double x[3];
            Index undetermined = 0;
            for (Index k = 0; k < rows; ++k) {
                record.row(k, seed, x);
                auto const step = take(f, x, output(x, seed));
                undetermined +=
                    step.health == Health::undetermined && step.gamma == 0 && step.innovation != step.innovation;
            }
            EXPECT_EQ(undetermined, rows) << F::name << ' ' << record.what << ' ' << rows << " rows, lambda " << lambda;
            for (int k = 0; k < 3; ++k) independent(seed, x), take(f, x, output(x, seed));
            for (int k = 0; k < 40; ++k) {
                independent(seed, x);
                EXPECT_EQ(take(f, x, output(x, seed)).health, Health::sound)
                    << F::name << ' ' << record.what << ' ' << k;
            }
        }
}
TEST(Pivots, OfRoundingDetermineNothing) {
    for (Index const rows : {3, 15, 100, 500}) {
        check_dependent<Qr<double>>(rows);
        check_dependent<Qr<float, 3>>(rows);
        check_dependent<Gentleman<double>>(rows);
        check_dependent<Gentleman<float>>(rows);
        check_dependent<QrBlock<double>>(rows);
    }
    check_dependent<Qr<double>>(20000);
    check_dependent<Gentleman<double>>(10000);
    for (Index const rows : {3, 15, 100}) check_dependent<Information<double>>(rows);
}
/// A block reports after its rows.
TEST(Pivots, OfABlockToo) {
    for (Dependent const& record : dependent) {
        Seed seed{43};
        QrBlock<double> f({.size = 3, .prior = std::nullopt});
        Matrix<double> psi(3, 200);
        Vector<double> y(200);
        double x[3];
        for (Index k = 0; k < 200; ++k) {
            record.row(k, seed, x);
            y[k] = output(x, seed);
            for (int i = 0; i < 3; ++i) psi(i, k) = x[i];
        }
        EXPECT_EQ(f.update_block(psi, y), Health::undetermined) << record.what;
        for (Index k = 0; k < 3; ++k) independent(seed, x), y[k] = output(x, seed), psi.col(k) << x[0], x[1], x[2];
        EXPECT_EQ(f.update_block(psi.leftCols(3), y.head(3)), Health::sound) << record.what;
    }
}

/// theta_j is determined to a digit or more: its row d is undetermined, and none after it.
template <class F>
void check_determined(Matrix<double> const& rows, char const* what) {
    using T = typename F::scalar;
    Index const d = rows.cols();
    F f({.size = d, .prior = std::nullopt});
    for (Index k = 0; k < 3 * d; ++k) {
        Vector<T> const psi = rows.row(k % rows.rows()).transpose().template cast<T>();
        Health const health = f.update(psi, psi.sum()).health;
        EXPECT_EQ(health, k < d ? Health::undetermined : Health::sound) << F::name << ' ' << what << ' ' << k;
    }
}
Matrix<double> hilbert(Index d) {
    return Matrix<double>::NullaryExpr(d, d, [](Index i, Index j) { return 1.0 / double(i + j + 1); });
}
TEST(Pivots, ThatAreSmallAreThere) {
    check_determined<Qr<double>>(hilbert(10), "Hilbert 10");  // kappa 1.6e13
    check_determined<Gentleman<double>>(hilbert(10), "Hilbert 10");
    check_determined<QrBlock<double>>(hilbert(10), "Hilbert 10");
    check_determined<Qr<float>>(hilbert(5), "Hilbert 5");  // 4.8e5
    check_determined<Gentleman<float>>(hilbert(5), "Hilbert 5");
    check_determined<Information<double>>(hilbert(5), "Hilbert 5");
    Seed seed{47};
    Matrix<double> noise(6, 6), years(40, 3);
    for (Index j = 0; j < 6; ++j)
        for (Index i = 0; i < 6; ++i) noise(i, j) = seed.bell();
    for (Index k = 0; k < 40; ++k) years.row(k) << 1, double(1980 + k), double(1980 + k) * double(1980 + k);
    check_determined<Qr<double>>(years, "years and their squares");
    check_determined<Gentleman<double>>(years, "years and their squares");
    for (int const unit : {0, 1, 2}) {  // columns, rows, all
        Matrix<double> scaled = noise, tiny = noise * 0x1p-600, huge = noise * 0x1p400;
        for (Index i = 0; i < 6; ++i)
            for (Index j = 0; j < 6; ++j)
                scaled(i, j) *= std::pow(10, unit == 0 ? 16.0 * double(j) / 5 - 8 : 8 - 16.0 * double(j) / 5);
        check_determined<Qr<double>>(scaled, "units from 1e-8 to 1e8");
        check_determined<Qr<float>>(scaled, "units from 1e-8 to 1e8");
        check_determined<Gentleman<double>>(scaled, "units from 1e-8 to 1e8");
        check_determined<Gentleman<float>>(scaled, "units from 1e-8 to 1e8");
        check_determined<QrBlock<double>>(scaled, "units from 1e-8 to 1e8");
        check_determined<Qr<double>>(tiny, "2^-600, whose squares vanish");
        check_determined<Qr<double>>(huge, "2^400");
    }
}

TEST(Pivots, OfAPriorDetermineAlways) {
    for (float const variance : {1.0f, 1e10f, 1e30f}) {
        Problem<float> const problem{.size = 3, .prior = Prior<float>{.variance = variance}};
        Qr<float> qr(problem), after(Problem<float>{.size = 3, .prior = std::nullopt});
        Gentleman<float> gentleman(problem);
        QrBlock<float> block(problem);
        reset(after, variance, Regressor<float>{0, 0, 0});
        double x[3];
        for (Dependent const& record : dependent) {
            Seed seed{51};
            for (Index k = 0; k < 50; ++k) {
                record.row(k, seed, x);
                if (std::string_view(record.what).starts_with("a constant of 1e8")) continue;  // overflows beside 1e30
                EXPECT_NE(take(qr, x, 1).health, Health::undetermined) << variance << record.what;
                EXPECT_NE(take(after, x, 1).health, Health::undetermined) << variance << record.what;
                EXPECT_NE(take(gentleman, x, 1).health, Health::undetermined) << variance << record.what;
                EXPECT_NE(take(block, x, 1).health, Health::undetermined) << variance << record.what;
            }
        }
    }
}
/// Forgetting wears a pivot down to its rounding, and a row brings it back; a saved state says the same.
TEST(Pivots, MayBeForgotten) {
    for_each(TypeList<Qr<double>, Gentleman<double>>{}, []<class F>() {
        Problem<double> const problem{.size = 3, .forgetting = 0.5, .prior = std::nullopt};
        F f(problem), g(problem);
        Seed seed{53};
        double x[3];
        for (int k = 0; k < 10; ++k) independent(seed, x), take(f, x, output(x, seed));
        EXPECT_EQ(take(f, x, 1).health, Health::sound) << F::name;
        for (int k = 0; k < 300; ++k) dependent[0].row(k, seed, x), take(f, x, output(x, seed));
        EXPECT_EQ(take(f, x, 1).health, Health::undetermined) << F::name;
        EXPECT_EQ(load(g, state_of(f)), StateFault::none);
        EXPECT_EQ(take(g, x, 1).health, Health::undetermined) << F::name;
        independent(seed, x), take(f, x, output(x, seed));
        EXPECT_EQ(take(f, x, 1).health, Health::sound) << F::name;
    });
}
/// A window in which a regressor stands still, from row 30 to 59: 15 rows of it determine nothing.
TEST(Pivots, OfAWindowThatStandsStill) {
    for_each(TypeList<Qr<double>, Gentleman<double>>{}, []<class F>() {
        Windowed<F> f(Problem<double>{.size = 3, .prior = std::nullopt}, {.rows = 15});
        Seed seed{57};
        double x[3];
        for (int k = 0; k < 90; ++k) {
            independent(seed, x);
            x[0] = 1;
            if (30 <= k && k < 60) x[1] = 0.7;
            Health const health = take(f, x, output(x, seed)).health;
            bool const none = k < 3 || (44 <= k && k <= 60);  // row 60 is the one that determines theta
            EXPECT_EQ(health, none ? Health::undetermined : Health::sound) << F::name << ' ' << k;
            if (k >= 61) {
                EXPECT_NEAR(f.theta()[1], -1, 0.2) << F::name << ' ' << k;
            }
        }
    });
}
/// Each lane of a pack has the health of its own filter.
TEST(Pivots, OfLanesAreThoseOfEach) {
    using P = Pack<double, 4>;
    auto const check = []<class Lanes, class Alone>(Lanes lanes, std::type_identity<Alone>) {
        std::vector<Alone> alone(4, Alone({.size = 3, .prior = std::nullopt}));
        Seed seed{59};
        for (int k = 0; k < 120; ++k) {
            P psi[3], y;
            Health expected[4];
            for (int lane = 0; lane < 4; ++lane) {
                double x[3];
                if (lane < 3 && k % 40 < 10 * lane + 20) dependent[lane].row(k, seed, x);
                else independent(seed, x);
                double const out = output(x, seed);
                expected[lane] = take(alone[size_t(lane)], x, out).health;
                for (int i = 0; i < 3; ++i) psi[i].set(lane, x[i]);
                y.set(lane, out);
            }
            auto const step = lanes.update(psi, y);
            for (int lane = 0; lane < 4; ++lane) {
                EXPECT_EQ(step.health[lane], expected[lane]) << Lanes::name << ' ' << k << ' ' << lane;
                EXPECT_TRUE(lanes.theta()[2][lane] == alone[size_t(lane)].theta()[2] || k < 60) << k << ' ' << lane;
            }
        }
    };
    Problem<P> const packed{.size = 3, .prior = std::nullopt};
    check(Qr<P>(packed), std::type_identity<Qr<double>>{});
    check(Gentleman<P>(packed), std::type_identity<Gentleman<double>>{});
    check(Information<P>(packed), std::type_identity<Information<double>>{});
}

}  // namespace
}  // namespace rlslab
