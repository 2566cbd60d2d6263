// Extended least squares is its filter with the filter's own residuals appended, bit for bit.
#include <rlslab/arithmetic/multiprecision.hpp>

#include <rlslab/adapt/extended_least_squares.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/guard.hpp>

namespace rlslab {
namespace {

using namespace adapt_laws;

constexpr double lambda = 0.96875;

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

/// (P0^-1 + sum phi phi') theta = sum phi y in rationals, with the rows as it reports them.
TEST(ExtendedLeastSquares, SolvesTheEquationsOfItsOwnRowsExactly) {
    using Q = Rational;
    for_each(Variants<Q>{}, []<class F>() {
        ExtendedLeastSquares<F> f(problem_of<Q>(3, 4, 1), 1);
        Eigen::Matrix<Q, 3, 3> X = Eigen::Matrix<Q, 3, 3>::Identity() / Q(4);
        Eigen::Matrix<Q, 3, 1> b = Eigen::Matrix<Q, 3, 1>::Zero();
        Seed seed{17};
        for (int k = 0; k < 6; ++k) {
            auto const number = [&] { return Q(int(seed.next() % 19) - 9) / Q(4); };
            Q const y = number(), first = number();
            Step<Q> const step = f.update({first, number()}, y);
            Q left = y;
            for (Index i = 0; i < 3; ++i) {
                left -= f.phi()[i] * Vector<Q>(f.theta())[i], b[i] += f.phi()[i] * y;
                for (Index j = 0; j < 3; ++j) X(i, j) += f.phi()[i] * f.phi()[j];
            }
            Eigen::Matrix<Q, 3, 1> const theta = Vector<Q>(f.theta());
            EXPECT_TRUE((Eigen::Matrix<Q, 3, 1>(X.lazyProduct(theta)) == b)) << F::name << k;
            if constexpr (!TakesBlocks<F>) {
                EXPECT_EQ(step.residual, left) << F::name << k;
            }
        }
    });
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

TEST(State, OfExtendedLeastSquaresContinuesBitForBit) {
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
}
TEST(StateSaboteur, AListThatForgetsAMemberOfExtendedLeastSquaresIsCaught) {
    auto const rows = [](auto& f, int count, Seed seed) {
        float psi[2];
        for (int k = 0; k < count; ++k) f.update(psi, draw(seed, psi));
    };
    using E = Extended<Ud<float, 4>>;
    E const f(problem_of<float>(4), 2), g(problem_of<float>(4, 2, 0.5), 2);
    EXPECT_TRUE((is_missed<E, 0>(f, g, rows)) && (is_missed<E, 1>(f, g, rows)) && (is_missed<E, 2>(f, g, rows)));
    EXPECT_FALSE((is_missed<E, 9>(f, g, rows)));
}

}  // namespace
}  // namespace rlslab
