// A fleet of complex filters leaves the bits of filters of its own, output by output.
#include <rlslab/arithmetic/format.hpp>
#include <rlslab/many/complex_fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <complex>

namespace rlslab {
namespace {

template <class T>
using Of = std::vector<Complex<T>>;
template <class T>
bool same(Complex<T> const& a, Complex<T> const& b) {
    auto const one = [](T x, T y) { return detail::bits_of(double(x)) == detail::bits_of(y) || (x != x && y != y); };
    return one(a.re, b.re) && one(a.im, b.im);
}

/// Numbers of [-1, 1) in both parts.
template <class T>
struct Numbers {
    Seed seed{7};
    Complex<T> next() {
        T const re = T(2 * seed.uniform() - 1);
        return {re, T(2 * seed.uniform() - 1)};
    }
};

constexpr Index M = 11, rows = 90;

/// Rows for a fleet, and filters of their own beside it. break_at: the row whose last y is one bit off for the fleet.
template <template <class, int> class V, class T>
struct Beside {
    using Fleet = ComplexFleet<V<Complex<Pack<T, 8>>, Dynamic>>;
    using Own = V<Complex<T>, Dynamic>;
    Index d, m;
    Problem<Complex<T>> problem;
    Fleet fleet;
    std::vector<Own> own;  // filter i's output j: own[i m + j]
    Numbers<T> numbers;
    Of<T> psi, y, innovation, residual;
    std::vector<T> gamma;
    std::vector<Health> health;
    bool equal = true;

    Beside(Index size, Index outputs, bool prior = true)
        : d(size), m(outputs), problem{.size = size, .forgetting = T(0.98)}, fleet(M, without(prior), m),
          own(size_t(M * m), Own(problem)), psi(size_t(M * d)), y(size_t(M * m)), innovation(y.size()),
          residual(y.size()), gamma(size_t(M)), health(size_t(M)) {}
    Problem<Complex<T>> const& without(bool prior) {
        if (!prior) problem.prior.reset();
        return problem;
    }
    /// Of odd rows the filters 3 and 10 miss a number; all of them row 20.
    void take(Index row, unsigned threads = 1, bool broken = false) {
        for (auto& x : psi) x = numbers.next();
        for (auto& x : y) x = numbers.next();
        if (row % 2) psi[size_t(3 * d)].im = undefined<T>(), y[size_t(10 * m)].re = std::numeric_limits<T>::infinity();
        if (row == 20)
            for (Index i = 0; i < M; ++i) y[size_t(i * m)].im = undefined<T>();
        Of<T> given = y;
        if (broken) given.back().re += T(0x1p-20);
        Index const missing = fleet.update(psi.data(), given.data(),
                                           {innovation.data(), residual.data(), gamma.data(), health.data()}, threads);
        EXPECT_EQ(missing, row == 20 ? M : row % 2 ? 2 : 0);
        for (Index i = 0; i < M; ++i)
            for (Index j = 0; j < m; ++j) {
                size_t const at = size_t(i * m + j);
                if (row == 20 || (row % 2 && (i == 3 || i == 10))) {
                    equal = equal && innovation[at].re != innovation[at].re && health[size_t(i)] == Health::nonfinite;
                    continue;
                }
                auto const step = own[at].update(Regressor<Complex<T>>(psi.data() + i * d, d), y[at]);
                equal = equal && same(step.innovation, innovation[at]) && same(step.residual, residual[at]) &&
                        detail::bits_of(step.gamma) == detail::bits_of(gamma[size_t(i)]);
                for (Index k = 0; k < d; ++k)
                    equal = equal && same(Complex<T>(own[at].theta()[k]), fleet.theta(i, k, j));
            }
    }
};

template <template <class, int> class V, class T>
void expect_the_bits(Index d, Index m, bool prior = true) {
    std::string const what = std::string(Beside<V, T>::Own::name) + " of " + std::to_string(d);
    SCOPED_TRACE(what);
    Beside<V, T> both(d, m, prior);
    for (Index row = 0; row < rows / 2; ++row) both.take(row, unsigned(row % 3 + 1));
    EXPECT_TRUE(both.equal);
    auto const saved = state_of(both.fleet);  // and on, in another
    typename Beside<V, T>::Fleet next(M, both.problem, m);
    ASSERT_EQ(load(next, saved), StateFault::none);
    both.fleet = next;
    for (Index row = rows / 2; row < rows; ++row) both.take(row);
    EXPECT_TRUE(both.equal);
    for (Index i = 0; i < M; ++i) {
        EXPECT_EQ(both.fleet.health(i), Health::sound);
        auto one = both.fleet.filter(i);
        auto& other = both.own[size_t(i * m)];
        Of<T> row(static_cast<size_t>(d), Complex<T>(T(1), T(2)));
        EXPECT_TRUE(same(one.update(Regressor<Complex<T>>(row), row[0]).residual,
                         other.update(Regressor<Complex<T>>(row), row[0]).residual));
    }
}

TEST(ComplexFleet, KeepsTheBitsOfFiltersOfTheirOwn) {
    expect_the_bits<Ud, float>(3, 1), expect_the_bits<Ud, double>(11, 3);
    expect_the_bits<UdDelta, float>(4, 2), expect_the_bits<Carlson, double>(4, 2), expect_the_bits<Potter, float>(3, 2);
    expect_the_bits<Conventional, double>(5, 2), expect_the_bits<Symmetric, float>(9, 2);
    expect_the_bits<JosephRankTwo, float>(4, 3), expect_the_bits<InverseQr, double>(4, 2);
    expect_the_bits<Qr, float>(4, 1), expect_the_bits<Gentleman, double>(9, 1),
        expect_the_bits<Information, double>(3, 1);
    expect_the_bits<Qr, double>(3, 1, false), expect_the_bits<Gentleman, float>(2, 1, false);
}
TEST(ComplexFleet, ABitOfOneOutputIsFound) {
    Beside<Ud, double> both(3, 2);
    for (Index row = 0; row < 10; ++row) both.take(row, 1, row == 8);
    EXPECT_FALSE(both.equal);
}
TEST(ComplexFleet, FindsARoomsResponse) {
    using Fleet = ComplexFleet<Ud<Complex<Pack<double, 8>>>>;
    Fleet fleet(2, {.size = 2});
    Numbers<double> numbers;
    std::complex<double> const theta[2] = {{1, -2}, {0.5, 3}};
    for (int k = 0; k < 40; ++k) {
        Of<double> psi(4), y;
        for (auto& x : psi) x = numbers.next();
        for (int i = 0; i < 2; ++i) {
            std::complex<double> sum = 0;
            for (size_t j = 0; j < 2; ++j) sum += std::conj(std::complex<double>(psi[size_t(2 * i) + j])) * theta[j];
            y.push_back(sum);
        }
        fleet.update(psi.data(), y.data());
    }
    for (Index j = 0; j < 2; ++j) EXPECT_LT(std::abs(std::complex<double>(fleet.theta(1, j)) - theta[j]), 1e-3);
}
TEST(ComplexFleet, RefusesWhatItCannotBe) {
    using Solves = ComplexFleet<Qr<Complex<Pack<float, 8>>>>;
    using Stores = ComplexFleet<Ud<Complex<Pack<float, 8>>>>;
    EXPECT_THROW(Solves(3, {.size = 2}, 2), std::invalid_argument);
    EXPECT_THROW(Stores(0, {.size = 2}), std::invalid_argument);
    EXPECT_THROW(Stores(1, {.size = 2}, 0), std::invalid_argument);
    EXPECT_THROW(Stores(1, {.size = 0}), std::invalid_argument);
    Stores fleet(1, {.size = 2});
    EXPECT_THROW(fleet.theta(1, 0), std::invalid_argument);
    EXPECT_THROW(fleet.theta(0, 2), std::invalid_argument);
    EXPECT_THROW(fleet.theta(0, 0, 1), std::invalid_argument);
    EXPECT_THROW(fleet.health(-1), std::invalid_argument);
}

}  // namespace
}  // namespace rlslab
