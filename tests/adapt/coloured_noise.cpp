// Extended least squares and instrumental variables: what each is made of, bit for bit or exactly, and that both find
// what least squares misses.
#include <rlslab/arithmetic/multiprecision.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/extended_least_squares.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/instrumental_variables.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace adapt_laws;
using Q = Rational;

constexpr double lambda = 0.96875;

template <class T>
Problem<T> problem_of(Index size, double variance = 64, double forgetting = lambda) {
    return {.size = size, .forgetting = T(forgetting), .prior = Prior<T>{.variance = T(variance)}};
}

// --- extended least squares ------------------------------------------------------------------------------------------

/// F, and the residuals kept by hand.
template <class F>
struct ByHand {
    F filter;
    Vector<double> past;
    bool of_before = false;  ///< the saboteur: innovations
    Vector<double> phi = {};
    Step<double> update(Vector<double> const& psi, double y) {
        phi.resize(psi.size() + past.size());
        phi << psi, past;
        Step<double> const step = filter.update(phi, y);
        for (Index i = past.size() - 1; i > 0; --i) past[i] = past[i - 1];
        if (past.size() > 0) past[0] = of_before ? step.innovation : step.residual;
        return step;
    }
};
template <class F>
bool is_the_filter_with_residuals(Index p, Index n, bool of_before = false) {
    ExtendedLeastSquares<F> f(problem_of<double>(p + n), n);
    ByHand<F> own{F(problem_of<double>(p + n)), Vector<double>::Zero(n), of_before};
    Seed seed{3};
    for (int k = 0; k < 60; ++k) {
        Vector<double> psi(p);
        for (double& x : psi) x = seed.bell();
        double const y = seed.bell();
        Step<double> const a = f.update(psi, y), b = own.update(psi, y);
        if (a.innovation != b.innovation || a.residual != b.residual || a.gamma != b.gamma ||
            !identical(f.filter(), own.filter))
            return false;
        for (Index i = 0; i < p + n; ++i)
            if (f.phi()[i] != own.phi[i]) return false;
    }
    return f.unknown() == 0;
}
TEST(ExtendedLeastSquares, IsTheFilterWithItsResidualsAppendedBitForBit) {
    for_each(Variants<double>{}, []<class F>() {
        for (Index n : {0, 1, 3})
            for (Index p : {0, 1, 4})
                if (p + n > 0) {
                    EXPECT_TRUE(is_the_filter_with_residuals<F>(p, n)) << F::name << p << n;
                    EXPECT_EQ((is_the_filter_with_residuals<F>(p, n, true)), n == 0) << F::name << p << n;
                }
    });
    EXPECT_TRUE((is_the_filter_with_residuals<Ud<double, 5>>(3, 2)));
}

template <class F>
using Extended = ExtendedLeastSquares<F>;
TEST(ExtendedLeastSquares, TakesNoResidualFromARowThatIsMissingOrBroken) {
    Extended<Ud<double, 4>> f(problem_of<double>(4), 2), broken = f;
    Seed seed{4};
    double psi[2];
    auto const next = [&] {
        double const y = draw(seed, psi);
        return f.update(psi, y);
    };
    next();
    double const first = next().residual;
    Ud<double, 4> discounted = f.filter();
    discount(discounted, lambda);
    EXPECT_TRUE(std::isnan(f.pass_time().residual));
    EXPECT_TRUE(identical(f.filter(), discounted));
    double const after = next().residual;
    EXPECT_EQ(f.phi()[2], 0);
    EXPECT_EQ(f.phi()[3], first);
    next();
    EXPECT_EQ(f.phi()[2], after);
    EXPECT_EQ(f.phi()[3], 0);
    EXPECT_EQ(f.unknown(), 0);

    EXPECT_EQ(broken.update(psi, NAN).health, Health::nonfinite);
    broken.update(psi, 1);
    EXPECT_EQ(broken.unknown(), 2) << "F itself is broken";
    EXPECT_EQ(broken.phi()[2], 0);
}
TEST(ExtendedLeastSquares, GoesOnAroundAGuardThatSetsRowsAside) {
    Extended<Guarded<Ud<double, 4>>> f(Guarded<Ud<double, 4>>(problem_of<double>(4)), 2);
    Seed seed{5};
    double psi[2];
    for (int k = 0; k < 500; ++k) {
        double y = draw(seed, psi);
        if (k == 200) y = NAN;
        if (k == 250) psi[0] = INFINITY;
        if (k == 300) y += 1e6;
        Step<double> const step = f.update(psi, y);
        if (k > 200) {
            EXPECT_EQ(step.health == Health::sound, k != 250) << k;
        }
        if (k == 201 || k == 251 || k == 301) {
            EXPECT_EQ(f.phi()[2], 0) << k;
        }
    }
    EXPECT_EQ(f.unknown(), 3);
    EXPECT_NEAR(f.theta()[0], 1, 0.2);
}
TEST(ExtendedLeastSquares, RefusesWhatMakesNoSense) {
    using F = Ud<double>;
    EXPECT_THROW(Extended<F>(problem_of<double>(3), -1), std::invalid_argument);
    EXPECT_THROW(Extended<F>(problem_of<double>(3), 4), std::invalid_argument);
    EXPECT_THROW(Extended<F>({.size = 0}, 0), std::invalid_argument);
    EXPECT_THROW(Extended<Qr<double>>({.size = 3, .prior = std::nullopt}, 1), std::invalid_argument);
    EXPECT_NO_THROW(Extended<Qr<double>>({.size = 3, .prior = std::nullopt}, 0));
    Extended<F> f(problem_of<double>(3), 1);
    for (Index size : {0, 1, 3})
        EXPECT_THROW(f.update(Vector<double>(Vector<double>::Ones(size)), 1), std::invalid_argument) << size;
    EXPECT_EQ(f.phi()[0], 0);
    Extended<F> const moved = std::move(f);
    EXPECT_THROW(f.update({1.0, 2.0}, 1), std::invalid_argument);  // NOLINT: what is tested
    EXPECT_EQ(moved.regressors(), 2);
}
/// Units are powers of two: psi, y and the residuals with 2^e, P0 with 2^-2e.
TEST(ExtendedLeastSquares, KeepsItsBitsInAnyUnit) {
    auto const theta = [](int e, bool prior_too) {
        Extended<Ud<double, 3>> f(problem_of<double>(3, std::ldexp(64, prior_too ? -2 * e : 0)), 1);
        Seed seed{6};
        for (int k = 0; k < 100; ++k) {
            double psi[2];
            double const y = draw(seed, psi);
            f.update({std::ldexp(psi[0], e), std::ldexp(psi[1], e)}, std::ldexp(y, e));
        }
        return Vector<double>(f.theta());
    };
    // the weight 2^-3 of the forgetting stays 1: only the scales of psi count
    for (int e : {-400, -7, 5, 400}) EXPECT_EQ(theta(e, true), theta(0, true)) << e;
    EXPECT_NE(theta(5, false), theta(0, false));
}

// --- instrumental variables ------------------------------------------------------------------------------------------

template <class T>
struct Row {
    Vector<T> psi{3}, zeta{4};
    T y;
};
Row<Q> exact_row(Seed& seed) {
    Row<Q> out;
    auto const number = [&] { return Q(int(seed.next() % 19) - 9) / Q(4); };
    for (Q& x : out.psi) x = number();
    for (Q& x : out.zeta) x = number();
    out.y = number();
    return out;
}
/// (P0^-1 + sum psihat psi') theta = P0^-1 theta0 + sum psihat y, with forgetting; psihat as each row had it.
template <class F, int N>
struct Exactly {
    using Iv = InstrumentalVariables<F, Ud<Q, N>, Dynamic>;
    Eigen::Matrix<Q, 3, 3> X = Eigen::Matrix<Q, 3, 3>::Identity() / Q(4);
    Eigen::Matrix<Q, 3, 1> b;
    Iv f;
    static Problem<Q> problem() {
        Problem<Q> out = problem_of<Q>(3, 4);
        out.prior->theta = Vector<Q>{{Q(1), Q(-2), Q(1) / Q(3)}};
        return out;
    }
    explicit Exactly(Index q) : f(problem(), problem_of<Q>(4, 2), q) {
        b = X.lazyProduct(Eigen::Matrix<Q, 3, 1>(*problem().prior->theta));
    }
    /// Rows of 8 for which the equation does not hold.
    int faults(bool beta_alone) {
        Seed seed{7};
        int out = f.theta() != *problem().prior->theta;
        for (int k = 0; k < 8; ++k) {
            Row<Q> const row = exact_row(seed);
            Vector<Q> const before = f.theta();
            Step<Q> const step = f.update(row.psi, row.zeta, row.y);
            X *= Q(lambda), b *= Q(lambda);
            for (Index i = 0; i < 3; ++i) {
                b[i] += f.psihat()[i] * row.y;
                for (Index j = 0; j < 3; ++j) X(i, j) += f.psihat()[i] * row.psi[j];
            }
            Eigen::Matrix<Q, 3, 1> theta = Vector<Q>(f.theta());
            if (beta_alone) theta = Vector<Q>(f.filter().theta()) + *problem().prior->theta;
            bool fault = Eigen::Matrix<Q, 3, 1>(X.lazyProduct(theta)) != b;
            Q e = row.y, left = row.y;
            for (Index i = 0; i < 3; ++i) e -= row.psi[i] * before[i], left -= row.psi[i] * Q(f.theta()[i]);
            fault = fault || step.innovation != e || step.residual != left;
            for (Index i = 0; i < 3; ++i) {
                Q fitted = 0;
                for (Index j = 0; j < 4; ++j)
                    fitted += row.zeta[j] * f.first().theta_of(std::min(i, f.correlated() - 1))[j];
                fault = fault || f.psihat()[i] != (i < f.correlated() ? fitted : row.psi[i]);
            }
            out += fault;
        }
        return out;
    }
};
TEST(InstrumentalVariables, AreThoseOfTheFittedRegressorsExactlyThroughAnyVariant) {
    int shared = 0, each = 0;
    for_each(Variants<Q>{}, [&]<class F>() {
        if constexpr (!TakesBlocks<F>) {
            (std::same_as<typename detail::OfOneRegressor<F, Dynamic>::type, detail::FilterEach<F, Dynamic>>
                 ? each
                 : shared)++;
            for (Index q : {1, 2, 3}) {
                EXPECT_EQ((Exactly<F, Dynamic>(q).faults(false)), 0) << F::name << q;
                EXPECT_GT((Exactly<F, Dynamic>(q).faults(true)), 5) << F::name << q;
            }
        }
    });
    EXPECT_GE(shared, 3);
    EXPECT_GE(each, 2);
}

/// The greatest distance of theta to that of least squares, zeta = psi, stage 1's prior `variance`.
template <class F, int Correlated>
double distance_to_least_squares(double variance) {
    InstrumentalVariables<F, F, Correlated> f(problem_of<Q>(3), problem_of<Q>(3, variance), 2);
    F plain(problem_of<Q>(3));
    Seed seed{8};
    for (int k = 0; k < 10; ++k) {
        Row<Q> const row = exact_row(seed);
        f.update(row.psi, row.psi, row.y);
        plain.update(row.psi, row.y);
    }
    Q far = 0;
    for (Index i = 0; i < 3; ++i) far = std::max<Q>(far, absolute(Q(f.theta()[i] - plain.theta()[i])));
    return double(far);
}
TEST(InstrumentalVariables, OfTheRegressorsThemselvesTendToLeastSquaresWithStageOnesPrior) {
    double const near = distance_to_least_squares<Ud<Q, 3>, 2>(0x1p40),
                 far = distance_to_least_squares<Ud<Q>, Dynamic>(0x1p20);
    EXPECT_GT(far, 0);
    EXPECT_NEAR(near / far * 0x1p20, 1, 1e-3);
}

template <class Iv>
void take(Iv& f, int rows, Seed seed, int missing = 0) {
    using T = typename Iv::scalar;
    for (int k = 0; k < rows; ++k) {
        Vector<T> psi(3), zeta(4);
        for (T& x : psi) x = T(seed.bell());
        for (T& x : zeta) x = T(seed.bell());
        T y = T(seed.bell());
        if (missing > 0 && k % missing == 0)
            (k % 3 == 0 ? y : k % 3 == 1 ? psi[2] : zeta[1]) = T(k % 2 ? NAN : INFINITY);
        f.update(psi, zeta, y);
    }
}
using Fixed = InstrumentalVariables<Ud<float, 3>, Ud<float, 4>, 2>;
template <class Iv>
Iv made() {
    using T = typename Iv::scalar;
    return Iv(problem_of<T>(3), problem_of<T>(4), 2);
}
TEST(InstrumentalVariables, LetTimePassForARowThatIsMissing) {
    auto f = made<Fixed>();
    take(f, 20, Seed{9});
    auto const theta = Vector<float>(f.theta());
    Ud<float, 3> second = f.filter();
    Ud<float, 4> first = f.first().filter();
    float const bad = NAN;
    for (int which = 0; which < 3; ++which) {
        std::array<float, 3> psi{1, 2, which == 0 ? bad : 3};
        std::array<float, 4> zeta{1, which == 1 ? bad : 2, 3, 4};
        Step<float> const step = f.update(psi, zeta, which == 2 ? bad : 1);
        EXPECT_TRUE(std::isnan(step.innovation) && std::isnan(step.residual));
        EXPECT_EQ(step.health, Health::sound);
        discount(second, float(lambda)), discount(first, float(lambda));
        EXPECT_EQ(Vector<float>(f.theta()), theta);
        EXPECT_TRUE(identical(f.filter(), second) && identical(f.first().filter(), first)) << which;
    }
    take(f, 200, Seed{10}, 7);
    EXPECT_TRUE(f.theta().allFinite());
}
TEST(InstrumentalVariables, HaveTheSameBitsAtFixedAndDynamicSizeAndThroughFiltersOfTheirOwn) {
    auto fixed = made<Fixed>();
    auto dynamic = made<InstrumentalVariables<Ud<float>>>();
    auto other = made<InstrumentalVariables<Potter<float>, Ud<float>>>();
    take(fixed, 100, Seed{11}, 9), take(dynamic, 100, Seed{11}, 9), take(other, 100, Seed{11}, 9);
    EXPECT_EQ(Vector<float>(fixed.theta()), Vector<float>(dynamic.theta()));
    EXPECT_NE(Vector<float>(fixed.theta()), Vector<float>(other.theta()));
    detail::FilterEach<Ud<float, 3>, 2> each(problem_of<float>(3), 2);
    detail::SharedFilter<Ud<float, 3>, 2> shared(problem_of<float>(3), 2);
    StateVector<float, 3> a(3), b(3);
    Seed seed{12};
    for (int k = 0; k < 50; ++k) {
        float psi[3];
        float const y = draw(seed, psi);
        EXPECT_EQ(each.update(psi, {y, psi[1]}).residual, shared.update(psi, {y, psi[1]}).residual);
        for (Index j : {0, 1}) {
            each.theta(j, a), shared.theta(j, b);
            EXPECT_EQ(a.view(), b.view());
        }
    }
}
TEST(InstrumentalVariables, RefuseWhatMakesNoSense) {
    using Iv = InstrumentalVariables<Ud<double>>;
    for (Index q : {-1, 0, 4}) EXPECT_THROW(Iv(problem_of<double>(3), problem_of<double>(5), q), std::invalid_argument);
    EXPECT_THROW(Iv(problem_of<double>(3), problem_of<double>(1), 2), std::invalid_argument);
    EXPECT_THROW(Iv({.size = 0}, problem_of<double>(1), 1), std::invalid_argument);
    auto f = made<Iv>();
    EXPECT_THROW(f.update({1.0, 2.0}, {1.0, 2.0, 3.0, 4.0}, 1), std::invalid_argument);
    EXPECT_THROW(f.update({1.0, 2.0, 3.0}, {1.0, 2.0, 3.0}, 1), std::invalid_argument);
    EXPECT_EQ(f.theta(), Vector<double>::Zero(3));
    Iv const moved = std::move(f);
    EXPECT_THROW(f.update({1.0, 2.0, 3.0}, {1.0, 2.0, 3.0, 4.0}, 1), std::invalid_argument);  // NOLINT: tested
    EXPECT_THROW(f.update(Vector<double>(), Vector<double>(), 1), std::invalid_argument);     // NOLINT
    EXPECT_EQ(moved.correlated(), 2);
    for (int e : {-1000, -500, 500, 1000}) {
        auto far = made<Iv>();
        double const x = std::ldexp(1.0, e);
        for (int k = 0; k < 9; ++k) {
            Health const health = far.update({x, k * x, -x}, {x, -x, k * k * x, x}, x).health;
            EXPECT_TRUE(health == Health::sound ? far.theta().allFinite() : e > 0) << e;
        }
    }
}
TEST(InstrumentalVariables, ServeOneParameterAndOneInstrument) {
    InstrumentalVariables<Ud<double, 1>, Ud<double, 1>, 1> f(problem_of<double>(1, 1e9, 1),
                                                             problem_of<double>(1, 1e9, 1));
    Seed seed{13};
    double above = 0, below = 0;
    for (int k = 0; k < 2000; ++k) {  // x is seen with an error, and z is another sight of it
        double const x = seed.bell(), seen = x + seed.bell(), z = x + seed.bell(), y = 2 * x + 0.1 * seed.bell();
        f.update({seen}, {z}, y);
        above += seen * y, below += seen * seen;
    }
    EXPECT_NEAR(f.theta()[0], 2, 0.3);
    EXPECT_NEAR(above / below, 1, 0.2) << "least squares";
}
/// P0^-1 + psihat psi = 1/8 - 1/8: Theta, 1 at first, is 1/4 after the row, and psi -1/2.
TEST(InstrumentalVariables, SayWhereTheirEquationsAreSingular) {
    Problem<double> instruments = problem_of<double>(1, 1, 1);
    instruments.prior->theta = Vector<double>::Ones(1);
    InstrumentalVariables<Conventional<double>> f(problem_of<double>(1, 8, 1), instruments, 1);
    EXPECT_EQ(f.update({-0.5}, {1.0}, 1).health, Health::undetermined);
    EXPECT_EQ(f.psihat()[0], 0.25);
    EXPECT_TRUE(std::isnan(f.theta()[0]));
    EXPECT_TRUE(std::isnan(f.update({1.0}, {1.0}, 1).innovation));
    EXPECT_EQ(f.update({1.0}, {1.0}, 1).health, Health::sound);
    EXPECT_TRUE(f.theta().allFinite());
}

// --- states ----------------------------------------------------------------------------------------------------------

template <class F, class Take>
void check_state(F f, F g, Take take) {
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
TEST(State, OfColouredNoiseContinuesBitForBit) {
    auto const rows = [](auto& f, int count, Seed seed) {
        float psi[2];
        for (int k = 0; k < count; ++k) {
            float const y = draw(seed, psi);
            if (k % 5 == 0) f.pass_time();
            else f.update(psi, y);
        }
    };
    using E = Extended<Ud<float, 4>>;
    check_state(E(problem_of<float>(4), 2), E(problem_of<float>(4, 2, 0.5), 2), rows);
    E three(problem_of<float>(4), 3);
    EXPECT_EQ(load(three, state_of(E(problem_of<float>(4), 2))), StateFault::options);
    auto const with_instruments = [](auto& f, int count, Seed seed) { take(f, count, seed, 5); };
    Problem<float> shifted = problem_of<float>(3, 2, 0.5);
    shifted.prior->theta = Vector<float>::Ones(3);
    check_state(made<Fixed>(), Fixed(shifted, problem_of<float>(4, 3, 0.5)), with_instruments);
    using Each = InstrumentalVariables<Qr<float, 3>, Ud<float, 4>, 2>;
    check_state(made<Each>(), Each(shifted, problem_of<float>(4, 3, 0.5)), with_instruments);
}
/// A list that leaves out the member i is seen.
template <class F, size_t i, class Take>
bool is_missed(F f, F g, Take take) {
    take(f, 40, Seed{1});
    auto to = F::state(g);
    auto const from = F::state(std::as_const(f));
    [&]<size_t... j>(std::index_sequence<j...>) {
        ((j == i ? void() : void(std::get<j>(to) = std::get<j>(from))), ...);
    }(std::make_index_sequence<std::tuple_size_v<decltype(to)>>());
    take(f, 3, Seed{2}), take(g, 3, Seed{2});
    return Vector<float>(f.theta()) != Vector<float>(g.theta()) || f.stored().F != g.stored().F;
}
TEST(StateSaboteur, AListThatForgetsAMemberOfColouredNoiseIsCaught) {
    auto const rows = [](auto& f, int count, Seed seed) {
        float psi[2];
        for (int k = 0; k < count; ++k) f.update(psi, draw(seed, psi));
    };
    using E = Extended<Ud<float, 4>>;
    E const f(problem_of<float>(4), 2), g(problem_of<float>(4, 2, 0.5), 2);
    EXPECT_TRUE((is_missed<E, 0>(f, g, rows)) && (is_missed<E, 1>(f, g, rows)) && (is_missed<E, 2>(f, g, rows)));
    EXPECT_FALSE((is_missed<E, 9>(f, g, rows)));
    auto const more = [](auto& iv, int count, Seed seed) { take(iv, count, seed); };
    Problem<float> shifted = problem_of<float>(3, 2, 0.5);
    shifted.prior->theta = Vector<float>::Ones(3);
    Fixed const a = made<Fixed>(), b(shifted, problem_of<float>(4, 3, 0.5));
    EXPECT_TRUE((is_missed<Fixed, 0>(a, b, more)) && (is_missed<Fixed, 1>(a, b, more)) &&
                (is_missed<Fixed, 2>(a, b, more)));
    EXPECT_FALSE((is_missed<Fixed, 9>(a, b, more)));
}

// --- what they are for -----------------------------------------------------------------------------------------------

/// y_k = 0.8 y_{k-1} + u_{k-1} + e_k + 0.7 e_{k-1}. The error of the first parameter; the budgets are ten standard
/// deviations and a third of the bias (docs/theory.md 92).
TEST(ColouredNoise, BiasesLeastSquaresAndNeitherOfTheOthers) {
    Ud<double, 2> plain(problem_of<double>(2, 1e6, 1));
    Extended<Ud<double, 3>> extended(problem_of<double>(3, 1e6, 1), 1);
    InstrumentalVariables<Ud<double, 2>, Ud<double, 4>, 1> instruments(problem_of<double>(2, 1e6, 1),
                                                                       problem_of<double>(4, 1e6, 1));
    Seed seed{14};
    double y = 0, u[4] = {}, e = 0;
    for (int k = 0; k < 20000; ++k) {
        double const now = seed.bell(), next = 0.8 * y + u[0] + now + 0.7 * e, psi[2] = {-y, u[0]};
        plain.update(psi, next), extended.update(psi, next), instruments.update(psi, u, next);
        y = next, e = now;
        for (int i = 3; i > 0; --i) u[i] = u[i - 1];
        u[0] = seed.bell();
    }
    EXPECT_LT(plain.theta()[0], -0.85);
    EXPECT_NEAR(extended.theta()[0], -0.8, 0.03);
    EXPECT_NEAR(extended.theta()[2], 0.7, 0.07);
    EXPECT_NEAR(instruments.theta()[0], -0.8, 0.05);
}

}  // namespace
}  // namespace rlslab
