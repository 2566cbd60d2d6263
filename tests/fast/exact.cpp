// Every fast form gives the prediction errors of least squares with its prior: exactly in rationals, where it has no
// root, and to 60 digits in 257 bits.
#include "tests/fast/samples.hpp"

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/fast/fast.hpp>
#include <rlslab/variants/conventional.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

/// The same problem as every variant takes it.
template <class T>
Problem<T> with_a_full_prior(FastProblem<T> const& problem) {
    Matrix<T> P0 = Matrix<T>::Zero(problem.size, problem.size);
    T p = T(1) / problem.energy;
    for (Index i = 0; i < problem.size; ++i, p *= problem.forgetting) P0(i, i) = p;
    return {.size = problem.size, .forgetting = problem.forgetting, .prior = Prior<T>{.covariance = P0}};
}

/// The largest |difference| of a form's errors, gamma and theta from those of conventional RLS.
template <class F>
typename F::scalar difference(F form, FastProblem<typename F::scalar> const& problem, Index rows, std::uint64_t seed) {
    using T = typename F::scalar;
    Conventional<T> exact(with_a_full_prior(problem));
    DelayLine<T> line(problem.size);
    T worst(0);
    auto const see = [&](T const& a, T const& b) {
        T const apart = absolute(T(a - b));
        if (!(apart <= worst)) worst = apart;
    };
    for (auto const& [u, y] : fast_tests::samples(rows, seed)) {
        Step<T> const fast = form.update(T(u), T(y)), full = exact.update(line.push(T(u)), T(y));
        see(fast.innovation, full.innovation);
        see(fast.residual, full.residual);
        see(fast.gamma, full.gamma);
        if constexpr (HasTaps<F>)
            for (Index i = 0; i < problem.size; ++i) see(form.theta()[i], exact.theta()[i]);
    }
    return worst;
}

TEST(Fast, FormsWithoutRootsAreExactInRationals) {
    for (Index const d : {1, 2, 3, 5})
        for (double const lambda : {1.0, 0.96875, 0.5}) {
            FastProblem<Rational> const problem{
                .size = d, .forgetting = Rational(lambda), .energy = Rational(1) / Rational(8)};
            for_each(FastForms<Rational>{}, [&]<class F> {
                EXPECT_EQ(difference(F(problem), problem, 11, 7 + std::uint64_t(d)), 0)
                    << F::name << ", d = " << d << ", lambda = " << lambda;
            });
        }
    static_assert(FastForms<Rational>::size == 4);
}
TEST(Fast, AllFormsHaveSixtyDigitsIn257Bits) {
    for (Index const d : {1, 2, 7, 16})
        for (double const lambda : {1.0, 0.96875}) {
            FastProblem<Reference> const problem{
                .size = d, .forgetting = Reference(lambda), .energy = Reference(1) / 16};
            for_each(FastForms<Reference>{}, [&]<class F> {
                EXPECT_LT(difference(F(problem), problem, 300, 11), Reference(1e-60)) << F::name << ", d = " << d;
            });
        }
}

/// What each of these does wrong, the law must see.
template <class F>
struct OtherPrior : F {
    explicit OtherPrior(FastProblem<typename F::scalar> problem)
        : F(FastProblem<typename F::scalar>{problem.size, problem.forgetting, problem.energy * problem.forgetting}) {}
};
template <class F>
struct OneTapTooFew : F {
    explicit OneTapTooFew(FastProblem<typename F::scalar> problem)
        : F(FastProblem<typename F::scalar>{problem.size - 1, problem.forgetting, problem.energy}) {}
    Step<typename F::scalar> update(typename F::scalar u, typename F::scalar y) { return F::update(u, y); }
};
template <FastForm F>
struct APosterioriForAPriori : F {
    using F::F;
    Step<typename F::scalar> update(typename F::scalar u, typename F::scalar y) {
        auto step = F::update(u, y);
        step.innovation = step.residual;
        return step;
    }
};
TEST(Fast, TheLawSeesSaboteurs) {
    FastProblem<Rational> const problem{.size = 3, .forgetting = Rational(0.96875), .energy = Rational(1) / 8};
    for_each(FastForms<Rational>{}, [&]<class F> {
        EXPECT_GT(difference(OtherPrior<F>(problem), problem, 9, 5), 0) << F::name;
        EXPECT_GT(difference(APosterioriForAPriori<F>(problem), problem, 9, 5), 0) << F::name;
        if constexpr (!HasTaps<F>) {
            EXPECT_GT(difference(OneTapTooFew<F>(problem), problem, 9, 5), 0) << F::name;
        }
    });
}

}  // namespace
}  // namespace rlslab
