// Instrumental variables solve their equations exactly, through any variant; and both ways of coloured noise find what
// least squares misses.
#include <rlslab/arithmetic/multiprecision.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/extended_least_squares.hpp>
#include <rlslab/adapt/instrumental_variables.hpp>

namespace rlslab {
namespace {

using namespace adapt_laws;
using Q = Rational;

constexpr double lambda = 0.96875;

template <class T>
struct Row {
    Vector<T> psi{3}, zeta{4};
    T y;
};
/// Every third row's instruments are small: it weighs little in its own fit.
Row<Q> exact_row(Seed& seed, int k) {
    Row<Q> out;
    auto const number = [&] { return Q(int(seed.next() % 19) - 9) / Q(4); };
    for (Q& x : out.psi) x = number();
    for (Q& x : out.zeta) x = number() / Q(k % 3 == 2 ? 16 : 1);
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
    int extrapolated = 0;
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
            Row<Q> const row = exact_row(seed, k);
            Matrix<Q> const Theta = f.first().theta();
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
            bool const extrapolates = f.first().steps()[0].gamma >= Q(3) / Q(4);
            Matrix<Q> const after = f.first().theta();
            extrapolated += extrapolates;
            for (Index i = 0; i < 3; ++i) {
                Q fitted = 0;
                for (Index j = 0; j < 4 && i < f.correlated(); ++j)
                    fitted += row.zeta[j] * (extrapolates ? Theta : after)(j, i);
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
                Exactly<F, Dynamic> exactly(q);
                EXPECT_EQ(exactly.faults(false), 0) << F::name << q;
                EXPECT_TRUE(0 < exactly.extrapolated && exactly.extrapolated < 6) << exactly.extrapolated;
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
        Row<Q> const row = exact_row(seed, k);
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
/// Units are powers of two: psi and y with 2^e, the instruments with 2^f, and their priors with 2^-2e, 2^-2f.
TEST(InstrumentalVariables, KeepTheirBitsInAnyUnit) {
    auto const theta = [](int e, int of_zeta, int of_prior) {
        InstrumentalVariables<Ud<double, 3>, Ud<double, 4>, 2> f(problem_of<double>(3, std::ldexp(64, -2 * e)),
                                                                 problem_of<double>(4, std::ldexp(64, -2 * of_prior)));
        Seed seed{15};
        for (int k = 0; k < 100; ++k) {
            double psi[3], zeta[4];
            double const y = draw(seed, psi);
            draw(seed, zeta);
            for (double& x : psi) x = std::ldexp(x, e);
            for (double& x : zeta) x = std::ldexp(x, of_zeta);
            f.update(psi, zeta, std::ldexp(y, e));
        }
        return Vector<double>(f.theta());
    };
    for (int e : {-400, -3, 7, 400})
        for (int f : {-400, 5, 400}) EXPECT_EQ(theta(e, f, f), theta(0, 0, 0)) << e << ' ' << f;
    EXPECT_NE(theta(0, 5, 0), theta(0, 0, 0));
}
TEST(InstrumentalVariables, StartWithoutAPriorWhereTheirSecondStageDoes) {
    Problem<double> none{.size = 3, .forgetting = lambda, .prior = std::nullopt};
    InstrumentalVariables<Qr<double>, Ud<double>> f(none, problem_of<double>(4), 2);
    InstrumentalVariables<Qr<double>, Ud<double>> g(problem_of<double>(3, 1e12), problem_of<double>(4), 2);
    Seed seed{16};
    for (int k = 0; k < 40; ++k) {
        double psi[3], zeta[4];
        double const y = draw(seed, psi);
        draw(seed, zeta);
        Step<double> const step = f.update(psi, zeta, y);
        g.update(psi, zeta, y);
        EXPECT_EQ(step.health, k < 3 ? Health::undetermined : Health::sound) << k;
        EXPECT_TRUE(k < 3 ? std::isnan(step.innovation) && std::isnan(step.residual)
                          : std::isfinite(step.innovation) && step.gamma > 0)
            << k;
    }
    EXPECT_LE(relative(f.theta(), g.theta()), 1e-9);  // P0^-1 of 1e-12 beside sums of 30
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

TEST(State, OfInstrumentalVariablesContinuesBitForBit) {
    auto const with_instruments = [](auto& f, int count, Seed seed) { take(f, count, seed, 5); };
    Problem<float> shifted = problem_of<float>(3, 2, 0.5);
    shifted.prior->theta = Vector<float>::Ones(3);
    check_state(made<Fixed>(), Fixed(shifted, problem_of<float>(4, 3, 0.5)), with_instruments);
    using Each = InstrumentalVariables<Qr<float, 3>, Ud<float, 4>, 2>;
    check_state(made<Each>(), Each(shifted, problem_of<float>(4, 3, 0.5)), with_instruments);
}
TEST(StateSaboteur, AListThatForgetsAMemberOfInstrumentalVariablesIsCaught) {
    auto const more = [](auto& iv, int count, Seed seed) { take(iv, count, seed); };
    Problem<float> shifted = problem_of<float>(3, 2, 0.5);
    shifted.prior->theta = Vector<float>::Ones(3);
    Fixed const a = made<Fixed>(), b(shifted, problem_of<float>(4, 3, 0.5));
    EXPECT_TRUE((is_missed<Fixed, 0>(a, b, more)) && (is_missed<Fixed, 1>(a, b, more)) &&
                (is_missed<Fixed, 2>(a, b, more)));
    EXPECT_FALSE((is_missed<Fixed, 9>(a, b, more)));
}

/// y_k = 0.8 y_{k-1} + u_{k-1} + e_k + 0.7 e_{k-1}. The error of the first parameter; the budgets are ten standard
/// deviations and a third of the bias (docs/theory.md 89).
TEST(ColouredNoise, BiasesLeastSquaresAndNeitherOfTheOthers) {
    Ud<double, 2> plain(problem_of<double>(2, 1e6, 1));
    ExtendedLeastSquares<Ud<double, 3>> extended(problem_of<double>(3, 1e6, 1), 1);
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
