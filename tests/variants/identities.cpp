// The identities of recursive least squares (docs/theory.md 12, 14, 15, 18, 21 to 23): with == in rationals, and to
// 2^-220 in Reference, also in forms that take square roots.
#include "tests/common/laws.hpp"
#include "tests/variants/gain_laws.hpp"

#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <array>

namespace rlslab {
namespace {

using gain_laws::inner, gain_laws::inverse, gain_laws::largest;

enum Identity {
    residual_is_gamma_e,
    residual_is_a_posteriori,
    information_recursion,
    cost_recursion,
    energy,
    trace,
    determinant,
    transition,
    gain_is_P_psi,
    batch,
    count
};
constexpr std::array<char const*, count> title{
    "residual = gamma e",       "residual = y - psi'theta",       "P^-1 recursion",
    "J = lambda J + gamma e^2", "V = lambda V + v^2 - gamma e^2", "trace(I - K psi') = d - 1 + gamma",
    "det(I - K psi') = gamma",  "I - K psi' = lambda P P-^-1",    "K = P psi",
    "theta minimises J"};

/// The largest violation of each identity over a run on small integers; exact zeros in exact arithmetic.
template <class F, class T = typename F::scalar>
std::array<T, count> violations(T lambda) {
    Index const d = 3;
    Prior<T> prior{.variance = T(1), .theta = Vector<T>(d), .covariance = Matrix<T>(d, d)};
    *prior.theta << T(1), T(-2), T(3);
    *prior.covariance << T(4), T(1), T(0), T(1), T(3), T(1), T(0), T(1), T(2);
    F filter(Problem<T>{.size = d, .forgetting = lambda, .prior = prior});

    Matrix<T> const I = Matrix<T>::Identity(d, d);
    Matrix<T> X = inverse(*prior.covariance), P = *prior.covariance;
    Vector<T> theta = *prior.theta, b = X.lazyProduct(theta), truth(d);
    truth << T(2), T(5), T(-1);
    T J = T(0), V = inner<T>(truth - theta, X.lazyProduct(truth - theta));
    std::array<T, count> worst;
    worst.fill(T(0));
    auto const note = [&worst](Identity which, T const& violation) {
        if (!(absolute(violation) <= worst[which])) worst[which] = absolute(violation);
    };
    // J by its definition, at theta: the weighted squares of all rows so far and of the prior.
    std::vector<std::pair<Vector<T>, T>> rows;
    auto const cost = [&](Vector<T> const& at) {
        Vector<T> const off = at - *prior.theta;
        T sum = inner<T>(off, inverse(*prior.covariance).lazyProduct(off));
        for (auto const& [psi, y] : rows) {
            T const r = y - inner(psi, at);
            sum = lambda * sum + r * r;
        }
        return sum;
    };
    Seed seed{7};
    for (int k = 0; k < 8; ++k) {
        Vector<T> psi(d);
        for (T& x : psi) x = T(int(seed.next() % 19) - 9);
        T const v = T(int(seed.next() % 7) - 3), y = inner(psi, truth) + v;
        rows.emplace_back(psi, y);
        Step<T> const step = filter.update(psi, y);
        T const e = step.innovation, gamma = step.gamma;
        Vector<T> const K = filter.gain(), now = filter.theta();
        Matrix<T> const P_now = covariance_of(filter.stored(), inverse<T>);

        note(residual_is_gamma_e, step.residual - gamma * e);
        note(residual_is_a_posteriori, step.residual - (y - inner(psi, now)));
        X = lambda * X + psi.lazyProduct(psi.transpose());
        b = lambda * b + y * psi;
        note(information_recursion, largest<T>(P_now.lazyProduct(X) - I));
        T const J_now = cost(now), V_now = inner<T>(truth - now, X.lazyProduct(truth - now));
        note(cost_recursion, J_now - (lambda * J + gamma * e * e));
        note(energy, V_now - (lambda * V + v * v - gamma * e * e));
        Matrix<T> const A = I - K.lazyProduct(psi.transpose());
        note(trace, A(0, 0) + A(1, 1) + A(2, 2) - (T(d - 1) + gamma));
        note(determinant, A(0, 0) * (A(1, 1) * A(2, 2) - A(1, 2) * A(2, 1)) -
                              A(0, 1) * (A(1, 0) * A(2, 2) - A(1, 2) * A(2, 0)) +
                              A(0, 2) * (A(1, 0) * A(2, 1) - A(1, 1) * A(2, 0)) - gamma);
        note(transition, largest<T>(A - lambda * P_now.lazyProduct(inverse(P))));
        note(gain_is_P_psi, largest<T>(K - P_now.lazyProduct(psi)));
        note(batch, largest<T>(X.lazyProduct(now) - b));
        J = J_now, V = V_now, P = P_now, theta = now;
    }
    return worst;
}

TEST(Identities, HoldInReferenceForEveryVariant) {
    Reference const tolerance = ldexp(Reference(1), -220);  // 257 bits, less those of numbers up to 2^10 in 8 steps
    for_each(Variants<Reference>{}, [&]<class F>() {
        for (Reference const& lambda : {Reference(1), Reference(9) / 10}) {
            auto const worst = violations<F>(lambda);
            for (int i = 0; i < count; ++i)
                EXPECT_LE(worst[size_t(i)], tolerance) << F::name << ": " << title[size_t(i)];
        }
    });
}

TEST(Identities, AreExactInRationals) {
    std::string violated;
    int variants = 0;
    for_each(Variants<Rational>{}, [&]<class F>() {
        ++variants;
        for (Rational const& lambda : {Rational(1), Rational(9) / 10}) {
            auto const worst = violations<F>(lambda);
            for (size_t i = 0; i < count; ++i)
                if (worst[i] != 0) violated += std::string(F::name) + ": " + title[i] + "\n";
        }
    });
    EXPECT_EQ(violated, "");
    EXPECT_GE(variants, 9);
}

/// A correct filter with one report or one state distorted.
enum class Distort { gamma, residual, theta, P, K, lambda };
template <Distort what>
class Distorted {
    Conventional<Rational> filter_;

public:
    using scalar = Rational;
    static constexpr std::string_view name = "distorted";
    static Problem<Rational> distorted(Problem<Rational> p) {
        if (what == Distort::lambda) p.forgetting *= Rational(99) / 100;
        return p;
    }
    explicit Distorted(Problem<Rational> const& p) : filter_(distorted(p)) {}
    Step<Rational> update(Regressor<Rational> psi, Rational y) {
        Step<Rational> step = filter_.update(psi, y);
        if (what == Distort::gamma) step.gamma *= Rational(99) / 100;
        if (what == Distort::residual) step.residual += Rational(1) / 1000;
        return step;
    }
    Vector<Rational> theta() const {
        Vector<Rational> theta = filter_.theta();
        if (what == Distort::theta) theta[0] += Rational(1) / 1000;
        return theta;
    }
    Vector<Rational> gain() const {
        Vector<Rational> K = filter_.gain();
        if (what == Distort::K) K[0] += Rational(1) / 1000;
        return K;
    }
    Stored<Rational> stored() const {
        Stored<Rational> P = filter_.stored();
        if (what == Distort::P) P.F(0, 0) += Rational(1) / 1000;
        return P;
    }
};

TEST(Identities, EachCanFail) {
    std::array<bool, count> failed{};
    auto const run = [&]<Distort what>() {
        auto const worst = violations<Distorted<what>>(Rational(9) / 10);
        for (size_t i = 0; i < count; ++i) failed[i] = failed[i] || worst[i] != 0;
    };
    run.template operator()<Distort::gamma>();
    run.template operator()<Distort::residual>();
    run.template operator()<Distort::theta>();
    run.template operator()<Distort::P>();
    run.template operator()<Distort::K>();
    run.template operator()<Distort::lambda>();
    for (size_t i = 0; i < count; ++i) EXPECT_TRUE(failed[i]) << title[i];
    auto const wrong_P = violations<Distorted<Distort::P>>(Rational(1));
    EXPECT_NE(wrong_P[information_recursion], 0);
    EXPECT_EQ(wrong_P[cost_recursion], 0);  // and only what depends on it
}

/// What e and gamma alone show.
TEST(Report, NamesTheBreakdown) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(step_of(1.0, 1.0).health, Health::sound);
    EXPECT_EQ(step_of(1.0, 1e-300).health, Health::sound);
    EXPECT_EQ(step_of(1.0, 1.0 + 0x1p-52).health, Health::indefinite);
    EXPECT_EQ(step_of(1.0, -0.5).health, Health::indefinite);
    EXPECT_EQ(step_of(1.0, 1.0, infinity).health, Health::nonfinite);  // s overflowed
    EXPECT_EQ(step_of(1.0, 0.0).health, Health::sound);                // gamma underflowed
    EXPECT_EQ(step_of(1.0, undefined<double>()).health, Health::nonfinite);
    EXPECT_EQ(step_of(infinity, 0.5).health, Health::nonfinite);
    EXPECT_EQ(step_of(3.0, 0.5).residual, 1.5);
}

}  // namespace
}  // namespace rlslab
