// Step and frequency responses and their derivatives: closed forms, finite differences, phases without jumps. Roots are
// those of exactly the coefficients given, to the last bit.
#include "tests/common/random_stable.hpp"

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/model/difference.hpp>
#include <rlslab/model/response.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace rlslab {
namespace {

using Point = std::complex<double>;
constexpr double pi = 3.141592653589793;
constexpr int output = EquationTerm::output, constant = EquationTerm::constant;

/// y[k] + a y[k-1] = b u[k-lag] with a = -1/2, b = 3: every number is a binary fraction, so that nothing is rounded.
TEST(StepResponse, OfFirstOrderIsTheClosedForm) {
    constexpr int lag = 2, count = 24;
    std::vector<EquationTerm> const terms{{output, 1}, {0, lag}, {constant}};
    Vector<double> const theta{{-0.5, 3, 7}};
    Response<double> const g = step_response(terms, theta, 0, count);
    for (int k = 0; k < count; ++k) {
        int const n = std::max(0, k - lag + 1);  // terms of the geometric series 1 + p + ... + p^(n-1), p = 1/2
        double const power = std::ldexp(1, -n), series = 2 * (1 - power),
                     slope = 4 * (1 - power) - 4 * n * power;  // d series / dp
        EXPECT_EQ(g.value[size_t(k)], 3 * series) << k;
        EXPECT_EQ(g.gradient(0, k), -3 * slope) << k << ": p = -a";
        EXPECT_EQ(g.gradient(1, k), series) << k;
        EXPECT_EQ(g.gradient(2, k), 0) << "a constant is not the input's";
    }
}
/// G = b z^-lag / (1 + a z^-1), at z = 1, i, -1.
TEST(FrequencyResponse, OfFirstOrderIsTheClosedForm) {
    std::vector<EquationTerm> const terms{{output, 1}, {0, 1}};
    Vector<double> const theta{{-0.5, 3}};
    Response<Point> const G = frequency_response(terms, theta, 0, {0, 0.25, 0.5});
    std::vector<Point> const z{1, {0, 1}, -1};
    for (size_t k = 0; k < z.size(); ++k) {
        Point const A = 1.0 - 0.5 / z[k], expected = 3.0 / z[k] / A;
        double const near = 1e-15 * std::abs(expected);
        EXPECT_NEAR(std::abs(G.value[k] - expected), 0, 4 * near) << k;
        EXPECT_NEAR(std::abs(G.gradient(1, Index(k)) - 1.0 / z[k] / A), 0, 4 * near) << k;
        EXPECT_NEAR(std::abs(G.gradient(0, Index(k)) + expected / z[k] / A), 0, 16 * near) << k;
    }
}

/// A random stable system of two inputs, as terms with gaps.
struct System {
    std::vector<EquationTerm> terms{{output, 1}, {output, 2}, {output, 4}, {0, 3}, {0, 5}, {1, 0}, {1, 1}, {constant}};
    Vector<double> theta = Vector<double>(8);
    explicit System(std::uint64_t seed) {
        Seed s{seed};
        for (double& x : theta) x = 0.4 * (2 * s.uniform() - 1);
    }
    DifferenceEquation equation() const { return DifferenceEquation::of(terms, theta, 2); }
};
TEST(StepResponse, IsTheSimulationOfAStep) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        System const s(seed);
        DifferenceEquation model = s.equation();
        model.c = 0;
        for (int input : {0, 1}) {
            std::vector<Signal> u{Signal(60, input == 0), Signal(60, input == 1)};
            Signal const y = simulate(model, u, Signal(60, 0.0));
            Response<double> const g = step_response(s.terms, s.theta, input, 60);
            for (size_t k = 0; k < 60; ++k) EXPECT_NEAR(g.value[k], y[k], 1e-14) << seed << ' ' << k;
        }
    }
}
/// Central differences of step h have an error of h^2 times the third derivative, and of u/h by rounding: 1e-8 here.
TEST(Responses, HaveTheDerivativesOfFiniteDifferences) {
    constexpr double h = 1e-5, most = 1e-8;
    std::vector<double> const f{0.001, 0.05, 0.21, 0.5};
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        System const s(seed);
        for (int input : {0, 1}) {
            Response<double> const g = step_response(s.terms, s.theta, input, 40);
            Response<Point> const G = frequency_response(s.terms, s.theta, input, f);
            for (Index i = 0; i < s.theta.size(); ++i) {
                Vector<double> up = s.theta, down = s.theta;
                up[i] += h, down[i] -= h;
                Response<double> const g1 = step_response(s.terms, up, input, 40),
                                       g0 = step_response(s.terms, down, input, 40);
                for (Index k = 0; k < 40; ++k)
                    EXPECT_NEAR(g.gradient(i, k), (g1.value[size_t(k)] - g0.value[size_t(k)]) / (2 * h),
                                most * (1 + std::abs(g.gradient(i, k))));
                Response<Point> const G1 = frequency_response(s.terms, up, input, f),
                                      G0 = frequency_response(s.terms, down, input, f);
                for (size_t k = 0; k < f.size(); ++k)
                    EXPECT_NEAR(std::abs(G.gradient(i, Index(k)) - (G1.value[k] - G0.value[k]) / (2 * h)), 0,
                                most * (1 + std::abs(G.gradient(i, Index(k)))));
            }
        }
    }
}
/// At f = 0 the frequency response is the step response's limit.
TEST(Responses, AgreeInTheSteadyState) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        System const s(seed);
        if (std::abs(poles(s.equation())[0]) > 0.9) continue;
        Response<double> const g = step_response(s.terms, s.theta, 1, 1000);
        Response<Point> const G = frequency_response(s.terms, s.theta, 1, {0});
        EXPECT_NEAR(g.value.back(), G.value[0].real(), 1e-12);
        for (Index i = 0; i < s.theta.size(); ++i)
            EXPECT_NEAR(g.gradient(i, 999), G.gradient(i, 0).real(), 1e-11 * (1 + std::abs(g.gradient(i, 999))));
    }
}

/// The phase at a few frequencies is that of very many, from one to the next without a jump. Zeros outside the unit
/// circle, a negative gain, and a delay of 40 samples whose phase turns 20 times.
TEST(ContinuousPhase, NeedsNoCloseFrequencies) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        DifferenceEquation model = random_stable(int(1 + seed % 5), Seed{seed});
        model.delay = seed % 3 == 0 ? 40 : 0;
        if (seed % 2) std::ranges::transform(model.b[0], model.b[0].begin(), std::negate());
        std::vector<EquationTerm> terms;
        Vector<double> theta(Index(model.a.size() + model.b[0].size()));
        for (size_t i = 0; i < model.a.size(); ++i)
            theta[Index(terms.size())] = model.a[i], terms.push_back({output, int(i) + 1});
        for (size_t i = 0; i < model.b[0].size(); ++i)
            theta[Index(terms.size())] = model.b[0][i], terms.push_back({0, model.delay + int(i)});
        std::vector<double> close, few{0.0625, 0.25, 0.5 - 0x1p-13};
        for (int i = 1; i < 0x1000; ++i) close.push_back(i * 0x1p-13);  // up to nearly 1/2
        auto const G = [&](std::vector<double> const& f) { return frequency_response(terms, theta, 0, f).value; };
        Signal const at_few = continuous_phase(model, 0, few, G(few));
        std::vector<Point> const values = G(close);
        double turns = 0, phase = 0, before = 0;
        for (size_t k = 0; k < close.size(); ++k) {
            double const principal = std::arg(values[k]);
            if (k == 0 && std::abs(principal) > 3 && G({0})[0].real() < 0)  // starts at pi, and leaves it either way
                turns = principal < 0 ? 1 : 0;
            else if (k > 0) turns -= std::round((principal - before) / (2 * pi));
            before = principal, phase = principal + 2 * pi * turns;
            for (size_t i = 0; i < few.size(); ++i)
                if (close[k] == few[i]) {
                    EXPECT_NEAR(at_few[i], phase, 1e-9) << seed << " f " << few[i];
                }
        }
        EXPECT_GT(std::abs(phase), model.delay ? 40 * pi - 20 : -1) << "the delay alone";
    }
}
TEST(ContinuousPhase, StartsBetweenMinusPiAndPi) {
    std::vector<EquationTerm> const terms{{0, 0}, {0, 1}, {0, 2}};
    for (auto const& [b, start] : std::vector<std::pair<Vector<double>, double>>{{Vector<double>{{1, -2.5, 3}}, 0},
                                                                                 {Vector<double>{{-1, 2.5, -3}}, pi},
                                                                                 {Vector<double>{{1, -3, 0}}, pi}}) {
        DifferenceEquation const model = DifferenceEquation::of(terms, b, 1);
        std::vector<double> const f{1e-9};
        EXPECT_NEAR(continuous_phase(model, 0, f, frequency_response(terms, b, 0, f).value)[0], start, 1e-6);
    }
    DifferenceEquation const nothing{.a = {0.5}, .b = {{0, 0}}, .delay = 0, .c = 0};
    EXPECT_TRUE(std::isnan(continuous_phase(nothing, 0, {0.1}, {0})[0]));
}

TEST(Responses, RefuseTermsThatAreNone) {
    std::vector<EquationTerm> const terms{{output, 0}, {0, 1}};
    Vector<double> const theta{{1, 2}};
    EXPECT_THROW(step_response(terms, theta, 0, 5), std::invalid_argument) << "y[k] with itself";
    EXPECT_THROW(frequency_response(terms, theta, 0, {0.1}), std::invalid_argument);
    std::vector<EquationTerm> const good{{output, 1}, {0, 1}};
    EXPECT_THROW(step_response(good, Vector<double>{{1}}, 0, 5), std::invalid_argument);
    EXPECT_THROW(step_response(good, theta, -1, 5), std::invalid_argument);
    EXPECT_TRUE(step_response(good, theta, 0, 0).value.empty());
    EXPECT_TRUE(std::isinf(step_response(good, Vector<double>{{-1e200, 1e200}}, 0, 4).value[3]));
}

// --- roots: simple, multiple, complex, at zero, far apart ------------------------------------------------------------

Reference value(std::vector<double> const& p, Reference const& at) {
    Reference out = 1;
    for (double const c : p) out = out * at + c;
    return out;
}
/// The double nearest to a simple real root: the sign changes between the middles to its neighbours.
bool is_nearest(std::vector<double> const& p, double root) {
    auto const middle = [&](double to) { return (Reference(root) + std::nextafter(root, to)) / 2; };
    return value(p, root) == 0 || value(p, middle(-INFINITY)) * value(p, middle(INFINITY)) < 0;
}

TEST(Roots, RealOnesAreTheNearestDoubles) {
    Seed seed{4};
    for (int trial = 0; trial < 40; ++trial) {
        std::vector<double> p{1};
        int const n = 1 + trial % 8;
        for (int i = 0; i < n; ++i) {  // about (z - 1)(z + 2)(z - 3) ..., with rounded coefficients
            double const root = (i % 2 ? -1 : 1) * (i + 0.5 + 0.4 * seed.uniform());
            std::vector<double> product(p.size() + 1, 0.0);
            for (size_t k = 0; k < p.size(); ++k) product[k] += p[k], product[k + 1] -= root * p[k];
            p = product;
        }
        p.erase(p.begin());
        auto const found = roots(p);
        ASSERT_EQ(found.size(), size_t(n));
        for (Point const z : found) {
            EXPECT_EQ(z.imag(), 0);
            EXPECT_TRUE(is_nearest(p, z.real())) << z.real();
        }
        EXPECT_TRUE(n < 2 || std::abs(found[0]) > std::abs(found[1]));
    }
    EXPECT_FALSE(is_nearest({-2, 0.75}, std::nextafter(1.5, 2)));
}
TEST(Roots, MultipleOnesAreEqual) {
    EXPECT_EQ(roots({-1, 0.25}), (std::vector<Point>{0.5, 0.5}));
    EXPECT_EQ(roots({-1.5, 0.75, -0.125}), (std::vector<Point>{0.5, 0.5, 0.5}));
    EXPECT_EQ(roots({0, 2, 0, 1}), (std::vector<Point>{{0, 1}, {0, 1}, {0, -1}, {0, -1}}));
}
TEST(Roots, AtZeroAndFarApart) {
    EXPECT_EQ(roots({}), std::vector<Point>{});
    EXPECT_EQ(roots({0, 0}), (std::vector<Point>{0, 0}));
    EXPECT_EQ(roots({-3, 2, 0}), (std::vector<Point>{2, 1, 0}));
    auto const far = roots({-0x1p500, 1});  // z = 2^500 and nearly 2^-500
    EXPECT_EQ(far[0], Point(0x1p500));
    EXPECT_EQ(far[1], Point(0x1p-500));
    EXPECT_EQ(roots({0, -0x1p-1000}), (std::vector<Point>{0x1p-500, -0x1p-500}));
}
TEST(Roots, OfCoefficientsOfAnySize) {
    Seed seed{5};
    for (int n = 3; n <= 30; n += 9) {
        std::vector<double> p;
        for (int i = 0; i < n; ++i) p.push_back(std::ldexp(2 * seed.uniform() - 1, int(2000 * seed.uniform()) - 1000));
        auto const found = roots(p);
        ASSERT_EQ(found.size(), size_t(n));
        for (Point const z : found) {
            EXPECT_TRUE(z.imag() != 0 || !std::isnormal(z.real()) || is_nearest(p, z.real())) << n << " " << z;
        }
    }
}
TEST(Roots, ComplexPairs) {
    auto const r = roots({-1.5, 0.7});
    EXPECT_EQ(r[0], std::conj(r[1]));
    EXPECT_EQ(r[0].real(), 0.75);
    EXPECT_EQ(r[0].imag(), static_cast<double>(sqrt(Reference(0.7) - Reference(0.5625))));
}
TEST(Roots, OfWhatIsNotFinite) {
    for (double const bad : {double(INFINITY), double(NAN)})
        for (Point const z : roots({1, bad})) EXPECT_TRUE(std::isnan(z.real()) && std::isnan(z.imag()));
}

}  // namespace
}  // namespace rlslab
