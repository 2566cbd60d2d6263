// A fleet: each of its filters has the bits of the scalar variant on its own rows, whatever the others miss.
#include "tests/common/laws.hpp"

#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

template <class T>
struct Sample {
    Matrix<T> psi;
    Vector<T> y;
};

/// Rows of `filters` filters; a third of the samples of every fifth filter, and everything in some steps, is missing in
/// one of three ways.
template <class T>
std::vector<Sample<T>> samples(Index filters, Index size, int steps, std::uint64_t from) {
    Seed seed{from};
    std::vector<Sample<T>> out;
    T const bad[] = {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity(),
                     -std::numeric_limits<T>::infinity()};
    for (int k = 0; k < steps; ++k) {
        Sample<T> s{Matrix<T>(filters, size), Vector<T>(filters)};
        for (Index i = 0; i < filters; ++i) {
            for (Index j = 0; j < size; ++j) s.psi(i, j) = T(seed.bell());
            s.y[i] = T(seed.bell());
            double const chance = k % 11 == 10 ? 0 : i % 5 == 0 ? seed.uniform() : 1;
            if (chance < 0.2) s.y[i] = bad[k % 3];
            else if (chance < 0.33) s.psi(i, size - 1) = bad[k % 3];
        }
        out.push_back(s);
    }
    return out;
}

template <class V, class One>
void expect_the_bits_of_each_alone(Index filters, std::uint64_t seed, unsigned threads) {
    using T = typename One::scalar;
    Problem<T> const p{.size = 3, .forgetting = T(0.99), .prior = Prior<T>{.variance = T(100)}};
    Fleet<V> fleet(filters, p);
    auto alone = std::vector<One>(size_t(filters), One(p));
    Index missing = 0, counted = 0;
    for (auto const& s : samples<T>(filters, 3, 40, seed)) {
        counted += fleet.update(s.psi, s.y, threads);
        for (Index i = 0; i < filters; ++i) {
            Vector<T> const psi = s.psi.row(i);
            if (psi.allFinite() && std::isfinite(s.y[i])) alone[size_t(i)].update(psi, s.y[i]);
            else ++missing;
        }
    }
    EXPECT_EQ(counted, missing);
    EXPECT_GT(missing, filters);
    for (Index i = 0; i < filters; ++i) {
        EXPECT_EQ(fleet.theta(i), Vector<T>(alone[size_t(i)].theta())) << One::name << " " << i << " of " << filters;
        EXPECT_EQ(fleet.health(i), Health::sound);
    }
}

TEST(Fleet, EachFilterHasItsBitsWhateverTheOthersMiss) {
    for (std::uint64_t const seed : {81, 82, 83})
        for (Index const filters : {1, 7, 8, 9, 50}) {
            expect_the_bits_of_each_alone<Ud<Pack<double, 8>, 3>, Ud<double, 3>>(filters, seed, 1);
            expect_the_bits_of_each_alone<Ud<Pack<float, 16>, 3>, Ud<float, 3>>(filters, seed, 3);
            expect_the_bits_of_each_alone<Conventional<Pack<double, 8>>, Conventional<double>>(filters, seed, 2);
            expect_the_bits_of_each_alone<Potter<Pack<float, 8>, 3>, Potter<float, 3>>(filters, seed, 100);
            expect_the_bits_of_each_alone<Qr<Pack<double, 8>, 3>, Qr<double, 3>>(filters, seed, 1);
        }
}

/// A record keeps the members that its form names; a number that it left out would be another filter's. (At a size that
/// is not known the members are the same.)
template <template <class, int> class V>
void expect_records_to_hold_all() {
    expect_the_bits_of_each_alone<V<Pack<double, 8>, 3>, V<double, 3>>(20, 84, 1);
}
TEST(Fleet, KeepsOfEachVariantWhatItNeeds) {
    expect_records_to_hold_all<Conventional>();
    expect_records_to_hold_all<ConventionalTwoSided>();
    expect_records_to_hold_all<Symmetric>();
    expect_records_to_hold_all<Joseph>();
    expect_records_to_hold_all<JosephRankTwo>();
    expect_records_to_hold_all<Potter>();
    expect_records_to_hold_all<Carlson>();
    expect_records_to_hold_all<Ud>();
    expect_records_to_hold_all<InverseQr>();
    expect_records_to_hold_all<Information>();
    expect_records_to_hold_all<Qr>();
    expect_records_to_hold_all<Gentleman>();
    expect_records_to_hold_all<ExtendedQr>();
    expect_records_to_hold_all<Kalman>();
}
/// Filter 3 overflows at its first row. The others, which are computed in the same memory, do not notice.
template <template <class, int> class V, int N = 3>
void expect_a_breakdown_to_stay_alone() {
    Index const filters = 19, d = 3;
    Problem<double> const p{.size = d, .forgetting = 0.99};
    Fleet<V<Pack<double, 4>, N>> fleet(filters, p);
    auto alone = std::vector<V<double, N>>(size_t(filters), V<double, N>(p));
    Seed seed{87};
    for (int k = 0; k < 6; ++k) {
        Matrix<double> psi(filters, d);
        Vector<double> y(filters);
        for (Index i = 0; i < filters; ++i) {
            for (Index j = 0; j < d; ++j) psi(i, j) = k == 1 && i == 3 ? (j == 1 ? -1e300 : 1e300) : seed.bell();
            y[i] = seed.bell();
        }
        fleet.update(psi, y);
        for (Index i = 0; i < filters; ++i) alone[size_t(i)].update(Vector<double>(psi.row(i)), y[i]);
    }
    using One = V<double, N>;
    for (Index i = 0; i < filters; ++i) {
        if (i == 3) continue;
        EXPECT_EQ(fleet.theta(i), Vector<double>(alone[size_t(i)].theta())) << One::name << " " << i;
        EXPECT_EQ(fleet.health(i), Health::sound) << One::name << " " << i;
    }
}
TEST(Fleet, ABreakdownStaysAlone) {
    expect_a_breakdown_to_stay_alone<Conventional>();
    expect_a_breakdown_to_stay_alone<Symmetric>();
    expect_a_breakdown_to_stay_alone<Potter>();
    expect_a_breakdown_to_stay_alone<Carlson>();
    expect_a_breakdown_to_stay_alone<Ud>();
    expect_a_breakdown_to_stay_alone<InverseQr>();
    expect_a_breakdown_to_stay_alone<Qr>();
    expect_a_breakdown_to_stay_alone<Gentleman>();
    expect_a_breakdown_to_stay_alone<Information>();
    expect_a_breakdown_to_stay_alone<Ud, Dynamic>();
}
TEST(Fleet, HoldsWhatPersistsAlone) {  // theta, D and what is above U's diagonal; theta and P
    Problem<double> const p{.size = 4};
    EXPECT_EQ((Fleet<Ud<Pack<double, 8>, 4>>(9, p).bytes_per_filter()), (4 + 4 + 6) * 8);
    EXPECT_EQ((Fleet<Conventional<Pack<double, 8>, 4>>(9, p).bytes_per_filter()), (4 + 16) * 8);
}

/// Filters that start without prior, each of which misses rows of its own and begins anew when it likes: theta and
/// health of each alone.
template <class V, class One>
void expect_the_same_without_prior(Index filters, std::uint64_t from) {
    using T = typename One::scalar;
    Problem<T> const p{.size = 3, .forgetting = T(0.99), .prior = std::nullopt};
    Fleet<V> fleet(filters, p);
    auto alone = std::vector<One>(size_t(filters), One(p));
    auto health = std::vector<Health>(size_t(filters), Health::undetermined);
    Seed seed{from};
    for (auto const& s : samples<T>(filters, 3, 40, from)) {
        if (seed.uniform() < 0.3) {
            Index const i = Index(seed.uniform() * double(filters));
            fleet.reset(i);
            alone[size_t(i)] = One(p);
            health[size_t(i)] = Health::undetermined;
        }
        fleet.update(s.psi, s.y);
        for (Index i = 0; i < filters; ++i) {
            Vector<T> const psi = s.psi.row(i);
            Health& mine = health[size_t(i)];
            if (psi.allFinite() && std::isfinite(s.y[i])) {
                Health const step = alone[size_t(i)].update(psi, s.y[i]).health;
                mine = mine == Health::undetermined ? step : worse(mine, step);
            }
            Vector<T> const theta = alone[size_t(i)].theta(), found = fleet.theta(i);
            EXPECT_EQ(fleet.health(i), mine) << One::name << " " << i << " of " << filters;
            if (mine == Health::undetermined) EXPECT_EQ(found.allFinite(), theta.allFinite()) << One::name << " " << i;
            else EXPECT_EQ(found, theta) << One::name << " " << i << " of " << filters;
        }
    }
}
TEST(Fleet, WithoutPriorEachFilterHasItsBitsAndItsHealth) {
    for (std::uint64_t seed = 91; seed < 101; ++seed)
        for (Index const filters : {1, 8, 9, 20}) {
            expect_the_same_without_prior<Information<Pack<double, 8>, 3>, Information<double, 3>>(filters, seed);
            expect_the_same_without_prior<Information<Pack<float, 8>>, Information<float>>(filters, seed);
            expect_the_same_without_prior<Qr<Pack<double, 8>, 3>, Qr<double, 3>>(filters, seed);
            expect_the_same_without_prior<Gentleman<Pack<double, 8>, 3>, Gentleman<double, 3>>(filters, seed);
        }
}
template <class F>
concept MakesAFleet = requires { typename Fleet<F>; };
TEST(Fleet, TakesNoFilterThatCountsTheRowsOfAllLanesAtOnce) {
    static_assert(MakesAFleet<Information<Pack<double, 8>>> && MakesAFleet<Kalman<Pack<double, 8>>>);
    static_assert(!MakesAFleet<QrBlock<Pack<double, 8>>>);
}

/// A filter over packs that is given zeros for what is missing, as a fleet without memory would: it forgets.
TEST(Fleet, WithoutPuttingBackTheBitsWouldDiffer) {
    using P = Pack<double, 8>;
    Ud<P, 3> careless({.size = 3, .forgetting = P(0.99)});
    Ud<double, 3> one({.size = 3, .forgetting = 0.99});
    Eigen::Vector3d const psi(1, 2, 3);
    Vector<P> const row = psi.unaryExpr([](double x) { return P(x); });
    careless.update(row, P(1.0));
    careless.update(Vector<P>(Vector<P>::Constant(3, P(0.0))), P(0.0));
    careless.update(row, P(2.0));
    one.update(psi, 1.0);
    one.update(psi, 2.0);
    EXPECT_NE(careless.theta()[0][0], one.theta()[0]);
}

TEST(Fleet, AFilterIsResetAloneAndBreakdownIsItsOwn) {
    Problem<float> const p{.size = 2, .forgetting = 1, .prior = Prior<float>{.variance = 1e30f}};
    Fleet<Conventional<Pack<float, 8>, 2>> fleet(11, p);
    Matrix<float> psi = Matrix<float>::Constant(11, 2, 1);
    Vector<float> y = Vector<float>::Constant(11, 1);
    psi(9, 0) = 1e30f;  // its P psi overflows
    EXPECT_EQ(fleet.update(psi, y), 0);
    Vector<float> const before = fleet.theta(10);
    for (Index i = 0; i < 11; ++i) EXPECT_EQ(fleet.health(i) == Health::sound, i != 9) << i;
    fleet.reset(9);
    EXPECT_EQ(fleet.health(9), Health::sound);
    EXPECT_EQ(fleet.theta(9), Vector<float>(Vector<float>::Zero(2)));
    EXPECT_EQ(fleet.theta(10), before);
    psi(9, 0) = 1;
    fleet.update(psi, y);
    Conventional<float, 2> anew(p);
    anew.update(Eigen::Vector2f(1, 1), 1.0f);
    EXPECT_EQ(fleet.theta(9), Vector<float>(anew.theta()));
}

TEST(Fleet, MisuseThrowsBeforeAnythingChanges) {
    using F = Fleet<Ud<Pack<double, 8>, 3>>;
    EXPECT_THROW(F(0, {.size = 3}), std::invalid_argument);
    EXPECT_THROW(F(-1, {.size = 3}), std::invalid_argument);
    EXPECT_THROW(F(5, {.size = 4}), std::invalid_argument);
    EXPECT_THROW(F(5, {.size = 3, .forgetting = 2}), std::invalid_argument);
    F fleet(5, {.size = 3});
    EXPECT_THROW(fleet.update(Matrix<double>::Zero(4, 3), Vector<double>::Zero(5)), std::invalid_argument);
    EXPECT_THROW(fleet.update(Matrix<double>::Zero(5, 2), Vector<double>::Zero(5)), std::invalid_argument);
    EXPECT_THROW(fleet.update(Matrix<double>::Zero(5, 3), Vector<double>::Zero(6)), std::invalid_argument);
    EXPECT_EQ(fleet.update(Matrix<double>::Zero(5, 3), Vector<double>::Zero(5), 0), 0);
}

}  // namespace
}  // namespace rlslab
