// Weighted rows, missing outputs, several outputs of one regressor.
#include <rlslab/arithmetic/multiprecision.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/adapt/weighted.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace adapt_laws;
using Q = Rational;

constexpr double lambda = 0.96875;

template <class F>
F made(double variance = 4, double forgetting = lambda) {
    using T = typename F::scalar;
    return F(Problem<T>{.size = 3, .forgetting = T(forgetting), .prior = Prior<T>{.variance = T(variance)}});
}

// --- weights, exactly ------------------------------------------------------------------------------------------------

struct QRow {
    Vector<Q> psi{3};
    Q y, root;
};
QRow q_row(Seed& seed) {
    QRow out;
    for (Q& x : out.psi) x = Q(int(seed.next() % 19) - 9) / 3;
    out.y = int(seed.next() % 19) - 9;
    Q const roots[] = {Q(2) / 3, Q(3), Q(1) / 5, Q(1), Q(7) / 2};
    out.root = roots[seed.next() % 5];
    return out;
}
/// Takes the row, but forgets the last step of it.
template <class F>
struct ForgetsTheDiscount : Weighted<F> {
    F inner;
    explicit ForgetsTheDiscount(Problem<Q> const& p) : Weighted<F>(p), inner(p) {}
    Step<Q> update(Regressor<Q> psi, Q const& y, Q const& w) {
        return measure(inner, psi, y, Q(Q(lambda) / w), Q(lambda));
    }
    auto theta() const { return inner.theta(); }
    auto gain() const { return inner.gain(); }
    Stored<Q> stored() const { return inner.stored(); }
};
/// A row of weight r^2 is the row times r; and theta solves the weighted normal equations.
template <class W, class F>
bool a_weight_is_a_scaled_row() {
    W weighted = made<W>();
    F scaled = made<F>();
    Eigen::Matrix<Q, 3, 3> X = Eigen::Matrix<Q, 3, 3>::Identity() / Q(4);
    Eigen::Matrix<Q, 3, 1> b = Eigen::Matrix<Q, 3, 1>::Zero();
    Seed seed{5};
    for (int k = 0; k < 8; ++k) {
        QRow const row = q_row(seed);
        Q const w = row.root * row.root;
        Step<Q> const a = weighted.update(row.psi, row.y, w),
                      s = scaled.update(Vector<Q>(row.psi * row.root), Q(row.y * row.root));
        X *= Q(lambda), b *= Q(lambda);
        for (int i = 0; i < 3; ++i) {
            b[i] += w * row.psi[i] * row.y;
            for (int j = 0; j < 3; ++j) X(i, j) += w * row.psi[i] * row.psi[j];
        }
        Vector<Q> const theta = weighted.theta(), K = weighted.gain(), scaled_K = scaled.gain();
        if (a.innovation * row.root != s.innovation || a.residual * row.root != s.residual || a.gamma != s.gamma)
            return false;
        if (theta != Vector<Q>(scaled.theta()) || K != Vector<Q>(scaled_K * row.root)) return false;
        if (multiplied_out(weighted.stored()) != multiplied_out(scaled.stored())) return false;
        if (Eigen::Matrix<Q, 3, 1>(X.lazyProduct(Eigen::Matrix<Q, 3, 1>(theta))) != b) return false;
    }
    return true;
}
TEST(Weighted, IsARowTimesTheRootExactly) {
    for_each(Variants<Q>{}, []<class F>() {
        if constexpr (TimeUpdates<F>) {
            EXPECT_TRUE((a_weight_is_a_scaled_row<Weighted<F>, F>())) << F::name;
            EXPECT_FALSE((a_weight_is_a_scaled_row<ForgetsTheDiscount<F>, F>())) << F::name;
        } else {
            EXPECT_TRUE(F::name == "kalman" || F::name == "joseph") << F::name;
        }
    });
}

// --- weights, in binary64 --------------------------------------------------------------------------------------------

template <class F>
bool has_the_bits_of_the_scaled_row(double off = 1) {
    Weighted<F> weighted(Problem<double>{.size = 3, .forgetting = lambda});
    F scaled(Problem<double>{.size = 3, .forgetting = lambda});
    Seed seed{6};
    double psi[3];
    for (int k = 0; k < 50; ++k) {
        double const y = draw(seed, psi), w = k % 7 == 0 ? 1 : std::abs(seed.bell()) * (k % 3 == 0 ? 1e-200 : 1e3),
                     root = std::sqrt(w * off);
        Step<double> const a = weighted.update(psi, y, w);
        Step<double> const b = scaled.update({root * psi[0], root * psi[1], root * psi[2]}, root * y);
        if (!identical(weighted.filter(), scaled) || a.innovation != b.innovation / root || a.gamma != b.gamma)
            return false;
        for (int i = 0; i < 3; ++i)
            if (weighted.gain()[i] != root * scaled.gain()[i]) return false;
    }
    return true;
}
TEST(Weighted, HasTheBitsOfTheScaledRow) {
    for_each(Variants<double>{}, []<class F>() {
        EXPECT_TRUE(has_the_bits_of_the_scaled_row<F>()) << F::name;
        EXPECT_FALSE(has_the_bits_of_the_scaled_row<F>(1 + 1e-12)) << F::name;
    });
}
TEST(Weighted, LeavesAFilterAsItIsForAWeightThatIsNone) {
    Weighted<Ud<double, 3>> f = made<Weighted<Ud<double, 3>>>();
    f.update({1.0, 2.0, 3.0}, 4, 2);
    auto const before = f.filter();
    for (double w : {-1.0, double(NAN), double(INFINITY)})
        EXPECT_EQ(f.update({1.0, 2.0, 3.0}, 4, w).health, Health::nonfinite);
    EXPECT_TRUE(identical(f.filter(), before));
    EXPECT_THROW(f.update({1.0, 2.0}, 4, 2), std::invalid_argument);
    EXPECT_EQ(f.update({1.0, 0.0, 0.0}, 1, 1e300).health, Health::sound);
}

// --- missing outputs -------------------------------------------------------------------------------------------------

template <class F, class Pass>
bool time_alone_passes(Pass pass) {
    Weighted<F> f = made<Weighted<F>>();
    F other = made<F>();
    Seed seed{7};
    for (int k = 0; k < 12; ++k) {
        using T = typename F::scalar;
        Vector<T> psi(3);
        for (T& x : psi) x = T(int(seed.next() % 15) - 7) / T(4);
        T const y = T(int(seed.next() % 15) - 7);
        if (k % 3 == 2) pass(f), discount(other, T(lambda));
        else f.update(psi, y), other.update(psi, y);
        if constexpr (F::name == "carlson_delta" || F::name == "inverse_qr_delta") {
            // A row with psi = 0 rounds S / sqrt(lambda) otherwise than discount: some u for each.
            auto const S = f.stored().F, of_other = other.stored().F;
            Vector<T> const theta = f.theta(), theta_of_other = other.theta();
            if (!((S - of_other).norm() <= T(64 * 0x1p-53) * of_other.norm())) return false;
            if (!((theta - theta_of_other).norm() <= T(1e-12) * theta_of_other.norm())) return false;
        } else {
            if (f.stored().F != other.stored().F || f.stored().D != other.stored().D) return false;
            if (F::name != "information" && Vector<T>(f.theta()) != Vector<T>(other.theta()))
                return false;  // it solves anew
        }
    }
    return true;
}
template <class F>
void check_missing() {
    if constexpr (TimeUpdates<F>) {
        EXPECT_TRUE((time_alone_passes<F>([](auto& f) { EXPECT_EQ(f.missing().health, Health::sound); }))) << F::name;
        EXPECT_TRUE((time_alone_passes<F>([](auto& f) { f.update(Vector<typename F::scalar>::Ones(3).eval(), 9, 0); })))
            << F::name;
        EXPECT_FALSE((time_alone_passes<F>([](auto&) {}))) << F::name;  // no time passes
    }
}
TEST(Weighted, LearnsNothingFromAMissingOutput) {
    for_each(Variants<double>{}, []<class F>() { check_missing<F>(); });
    for_each(Variants<Q>{}, []<class F>() { check_missing<F>(); });
    Weighted<Ud<double, 3>> f = made<Weighted<Ud<double, 3>>>();
    Step<double> const step = f.missing();
    EXPECT_TRUE(std::isnan(step.innovation) && std::isnan(step.residual));
    EXPECT_EQ(step.gamma, 1);
}
/// Every other output is missing. What the guard learns of the noise is what the others say; a row of zeros would teach
/// it silence.
TEST(Weighted, TeachesAGuardNothingOfTheNoise) {
    using G = Guarded<Ud<double, 3>>;
    for (unsigned seed : {91, 92, 93}) {
        Weighted<G> f = made<Weighted<G>>(100, 0.98);
        G zeros = made<G>(100, 0.98);
        Seed rows{seed};
        double psi[3];
        for (int k = 0; k < 4000; ++k) {
            double const y = draw(rows, psi);
            f.update(psi, y);
            f.missing();
            zeros.update(psi, y);
            zeros.update({0.0, 0.0, 0.0}, 0);
        }
        EXPECT_NEAR(f.filter().noise_variance() / 0.015625, 1, 0.4) << seed;
        EXPECT_LT(zeros.noise_variance() / 0.015625, 0.6) << seed;
        EXPECT_EQ(f.filter().counts().outliers, 0) << seed;
    }
}
/// Rows whose noise is 100 times larger, one in five: with their weights no outliers, and a better theta.
TEST(Weighted, TellsAGuardWhichRowsAreNoisy) {
    using G = Guarded<Windowed<Ud<double, 3>>>;
    Problem<double> const problem{.size = 3, .prior = Prior<double>{.variance = 100}};
    for (unsigned seed : {91, 92, 93}) {
        Weighted<G> told(G(problem, {}), 1);
        G untold(problem);
        Seed rows{seed};
        double psi[3];
        for (int k = 0; k < 3000; ++k) {
            double const y = draw(rows, psi), more = k % 5 == 0 ? 12.5 * rows.bell() : 0;
            told.update(psi, y + more, k % 5 == 0 ? 1e-4 : 1);
            untold.update(psi, y + more);
        }
        EXPECT_EQ(told.filter().counts().outliers, 0) << seed;
        EXPECT_GT(untold.counts().outliers, 100) << seed;
        EXPECT_NEAR(told.theta()[1], -2, 0.05) << seed;
    }
}

// --- several outputs -------------------------------------------------------------------------------------------------

template <class F>
using Two = MultiOutput<F, 2>;
TEST(MultiOutput, DropsARowOrLetsOneThetaStand) {
    using F = Ud<double, 3>;
    Problem<double> const problem{.forgetting = lambda};
    Two<F> drops(problem), stands(problem, 2, MissingOutput::stands), undisturbed(problem);
    std::array<F, 2> own{F(problem), F(problem)};
    Seed seed{9};
    for (int k = 0; k < 60; ++k) {
        double psi[3], y[2] = {draw(seed, psi), seed.bell()}, given[2] = {y[0], y[1]};
        int const lost = k % 5 == 3 ? 0 : k % 7 == 4 ? 1 : -1;
        if (lost >= 0) given[lost] = k % 2 ? NAN : -INFINITY;
        Matrix<double> const before = stands.theta();
        auto const dropped = drops.update(psi, given), stood = stands.update(psi, given);
        undisturbed.update(psi, y);
        for (int j = 0; j < 2; ++j) {
            if (lost < 0) own[size_t(j)].update(psi, y[j]);
            else discount(own[size_t(j)], lambda);
            EXPECT_EQ(Vector<double>(drops.theta().col(j)), Vector<double>(own[size_t(j)].theta())) << k;
            EXPECT_EQ(std::isnan(dropped[size_t(j)].innovation), lost >= 0) << k;
            EXPECT_EQ(std::isnan(stood[size_t(j)].innovation), lost == j) << k;
            EXPECT_EQ(stood[size_t(j)].health, Health::sound) << k;
        }
        EXPECT_EQ(drops.stored().D, own[0].stored().D) << k;
        EXPECT_EQ(stands.stored().D, undisturbed.stored().D) << k;
        if (lost >= 0) {
            EXPECT_EQ(Vector<double>(stands.theta().col(lost)), Vector<double>(before.col(lost))) << k;
        }
        if (k == 3) {  // the first output was lost once: the second knows nothing of it
            EXPECT_EQ(Vector<double>(stands.theta().col(1)), Vector<double>(undisturbed.theta().col(1)));
        }
    }
}
TEST(MultiOutput, RefusesWhatMakesNoSense) {
    using F = Ud<double>;
    EXPECT_THROW((MultiOutput<F>({.size = 2}, 0)), std::invalid_argument);
    EXPECT_THROW((MultiOutput<F, 2>({.size = 2}, 3)), std::invalid_argument);
    EXPECT_THROW((MultiOutput<F, 2>({.size = 0})), std::invalid_argument);
    MultiOutput<F> f({.size = 2}, 3);
    EXPECT_THROW(f.update({1.0, 2.0}, {1.0, 2.0}), std::invalid_argument);
    EXPECT_THROW(f.update({1.0}, {1.0, 2.0, 3.0}), std::invalid_argument);
    EXPECT_EQ(f.theta(), (Matrix<double, Dynamic, Dynamic>::Zero(2, 3)));
    for (Step<double> const& step : f.update({1.0, NAN}, {1.0, 2.0, 3.0})) EXPECT_EQ(step.health, Health::nonfinite);
    for (int e : {-1000, 500}) {
        MultiOutput<F> far({.size = 2}, 3);
        double const x = std::ldexp(1.0, e);
        far.update({x, -x}, {x, 1.0, -x});
        for (Step<double> const& step : far.update({x, x}, {x, 1.0, -x}))
            EXPECT_TRUE(step.health == Health::sound ? far.theta().allFinite() : e > 0) << e;
    }
}

// --- states ----------------------------------------------------------------------------------------------------------

TEST(State, OfWeightsAndOutputsContinuesBitForBit) {
    using W = Weighted<Ud<float, 3>>;
    check_state(made<W>(64, 0.9375), made<W>(4, 0.5), [](W& f, int rows, Seed seed) {
        float psi[3];
        for (int k = 0; k < rows; ++k) {
            float const y = draw(seed, psi);
            if (k % 4 == 0) f.missing();
            else f.update(psi, y, float(1 + k % 3));
        }
    });
    using M = MultiOutput<Ud<float, 3>, 2>;
    check_state(made<M>(64, 0.9375), made<M>(4, 0.5), [](M& f, int rows, Seed seed) {
        float psi[3];
        for (int k = 0; k < rows; ++k) {
            float const y = draw(seed, psi);
            f.update(psi, {y, k % 5 == 0 ? NAN : -y});
        }
    });
}

}  // namespace
}  // namespace rlslab
