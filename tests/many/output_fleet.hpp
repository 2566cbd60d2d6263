// A fleet of several outputs beside filters of their own, output by output, with weights.
#pragma once

#include "tests/common/same.hpp"

#include <rlslab/adapt/weighted.hpp>
#include <rlslab/many/output_fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab::outputs {

using rlslab::same;
template <class T>
bool same(Complex<T> const& a, Complex<T> const& b) {
    return same(a.re, b.re) && same(a.im, b.im);
}
template <class N>
bool finite(std::span<N const> x) {
    return std::ranges::all_of(x, [](N const& one) { return is_finite(one); });
}

/// Numbers of [-1, 1), in both parts.
template <class N>
struct Numbers {
    Seed seed{7};
    N next() {
        using T = RealOf<N>;
        T const re = T(2 * seed.uniform() - 1);
        if constexpr (ComplexScalar<N>) return {re, T(2 * seed.uniform() - 1)};
        else return re;
    }
};
/// A row of weight w by itself: Weighted for real numbers, its formula for complex ones.
template <class F, class N = typename F::scalar>
Step<N> weighted(F& f, std::span<N const> psi, N const& y, RealOf<N> w) {
    StateVector<N> row(Index(psi.size()));
    if constexpr (!ComplexScalar<N>) {
        N by(1);
        return detail::weighted_row(f, row, by, Regressor<N>(psi), y, w);
    } else {
        auto const root = square_root(w);
        for (Index i = 0; i < row.size(); ++i) row[i] = w == 0 ? N(0) : N(root * psi[size_t(i)]);
        Step<N> step = f.update(Regressor<N>(row.view()), w == 0 ? N(0) : N(root * y));
        step.innovation = step.innovation / root, step.residual = step.residual / root;
        return step;
    }
}

inline constexpr Index M = 11, rows = 90;
enum class Start { no_prior, variance, full };
enum class Broken { nothing, output, weight };

template <class N, int L>
struct InLanes {
    using type = Pack<N, L>;
};
template <class T, int L>
struct InLanes<Complex<T>, L> {
    using type = Complex<Pack<T, L>>;
};

/// Rows for a fleet, and filters of their own beside it.
template <template <class, int> class V, class N>
struct Beside {
    using T = RealOf<N>;
    using Fleet = OutputFleet<V<typename InLanes<N, 8>::type, Dynamic>>;
    using Own = V<N, Dynamic>;
    Index d, m;
    Problem<N> problem;
    Fleet fleet;
    std::vector<Own> own;  // filter i's output j: own[i m + j]
    Numbers<N> numbers;
    std::vector<N> psi, y;
    std::vector<T> w;
    FleetSteps<N> steps;
    bool equal = true;
    int missing = 0, passed = 0;

    Beside(Index size, Index outputs, Start start)
        : d(size), m(outputs), problem(started(size, start)), fleet(M, problem, m), own(size_t(M * m), Own(problem)),
          psi(size_t(M * d)), y(size_t(M * m)), w(size_t(M)), steps(M, m) {}
    static Problem<N> started(Index size, Start start) {
        Problem<N> out{.size = size, .forgetting = T(0.98)};
        if (start == Start::no_prior) out.prior.reset();
        if (start == Start::full) {
            out.prior->theta = Vector<N>::Constant(size, N(2));
            out.prior->covariance = Matrix<N>::Constant(size, size, N(1));
            out.prior->covariance->diagonal().setConstant(N(3));
        }
        return out;
    }
    /// Of odd rows the filters 3 and 10 miss a number, unless their weight is 0; all of them row 20. Weights of two of
    /// three rows: also 0, and some that are none.
    void take(Index row, unsigned threads = 1, Broken broken = Broken::nothing) {
        for (auto& x : psi) x = numbers.next();
        for (auto& x : y) x = numbers.next();
        T const none[] = {T(-1), undefined<T>(), std::numeric_limits<T>::infinity()};
        for (Index i = 0; i < M; ++i) w[size_t(i)] = T((row + 3 * i) % 7) / T(2);
        w[5] = none[row / 3 % 3];
        if (row % 2) psi[size_t(3 * d)] = undefined<N>(), y[size_t(10 * m)] = N(std::numeric_limits<T>::infinity());
        if (row == 20)
            for (Index i = 0; i < M; ++i) y[size_t(i * m)] = undefined<N>();
        std::vector<N> given = y;
        std::vector<T> weights = w;
        if (broken == Broken::output) given.back() = given.back() + N(T(0x1p-20));
        if (broken == Broken::weight) weights.back() += T(0x1p-20);
        bool const weighs = row % 3 != 0;
        Index const found = fleet.update(psi.data(), given.data(), weighs ? weights.data() : nullptr, &steps, threads);
        Index expected = 0;
        for (Index i = 0; i < M; ++i) {
            T const weight = weighs ? w[size_t(i)] : T(1);
            std::span<N const> const mine(psi.data() + i * d, size_t(d)), out(y.data() + i * m, size_t(m));
            bool const there = weight >= 0 && is_finite(weight) && (weight == 0 || (finite(mine) && finite(out)));
            expected += !there;
            passed += weight == 0;
            equal = equal && steps.taken[size_t(i)] == there;
            for (Index j = 0; j < m; ++j) {
                size_t const at = size_t(i * m + j);
                Step<N> step{undefined<N>(), undefined<N>(), undefined<T>(), Health::nonfinite};
                if (there && weighs) step = weighted(own[at], mine, y[at], weight);
                else if (there) step = own[at].update(Regressor<N>(mine), y[at]);
                equal = equal && same(step.innovation, steps.innovation[Index(at)]) &&
                        same(step.residual, steps.residual[Index(at)]) && same(step.gamma, steps.gamma[i]) &&
                        step.health == steps.health[at];
                for (Index k = 0; k < d; ++k) equal = equal && same(N(own[at].theta()[k]), fleet.theta(i)(k, j));
            }
        }
        EXPECT_EQ(found, expected) << row;
        missing += int(found);
    }
};

template <template <class, int> class V, class N>
void expect_the_bits(Index d, Index m, Start start = Start::variance) {
    SCOPED_TRACE(std::string(Beside<V, N>::Own::name) + " of " + std::to_string(d));
    Beside<V, N> both(d, m, start);
    auto const fresh = both.fleet;
    for (Index row = 0; row < rows / 2; ++row) both.take(row, unsigned(row % 3 + 1));
    EXPECT_TRUE(both.equal);
    auto const saved = state_of(both.fleet);  // and on, in another
    typename Beside<V, N>::Fleet next(M, both.problem, m);
    ASSERT_EQ(load(next, saved), StateFault::none);
    both.fleet = next;
    for (Index row = rows / 2; row < rows; ++row) both.take(row);
    EXPECT_TRUE(both.equal);
    EXPECT_GT(both.missing, 60);
    EXPECT_GT(both.passed, 60);
    std::vector<N> const row(static_cast<size_t>(d), N(1));
    for (Index i = 0; i < M; ++i) {
        EXPECT_EQ(both.fleet.health(i), Health::sound);
        auto one = both.fleet.filter(i);
        EXPECT_TRUE(same(one.update(Regressor<N>(row), row[0]).residual,
                         both.own[size_t(i * m)].update(Regressor<N>(row), row[0]).residual));
    }
    auto const before = both.fleet;
    both.fleet.reset(4);
    for (Index i = 0; i < M; ++i) {
        auto const& expected = i == 4 ? fresh : before;
        EXPECT_EQ(state_of(both.fleet.filter(i)), state_of(expected.filter(i))) << i;
        EXPECT_TRUE(same(both.fleet.theta(i)(d - 1, m - 1), expected.theta(i)(d - 1, m - 1))) << i;
    }
    for (Index i = 0; i < M; ++i) both.fleet.reset(i);
    EXPECT_EQ(state_of(both.fleet), state_of(fresh));
}
/// A saboteur of one output or weight.
template <class N>
void expect_a_bit_to_be_found() {
    for (Broken const broken : {Broken::nothing, Broken::output, Broken::weight}) {
        Beside<Ud, N> both(3, 2, Start::variance);
        for (Index row = 0; row < 10; ++row) both.take(row, 1, row == 8 ? broken : Broken::nothing);
        EXPECT_EQ(both.equal, broken == Broken::nothing);
    }
}

}  // namespace rlslab::outputs
