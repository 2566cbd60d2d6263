// The probes show E = Phat P^-1 - I, whatever has been done to the filter; and what rounding did not do.
#include <rlslab/adapt/certified.hpp>

#include "tests/adapt/adapt.hpp"
#include "tests/common/same.hpp"

#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/adapt/window.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/arithmetic/pair.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace adapt_laws;
using R = Reference;

using Dense =
    TypeList<Conventional<float>, ConventionalTwoSided<float>, Symmetric<float>, Joseph<float>, JosephRankTwo<float>,
             Potter<float>, Carlson<float>, CarlsonDelta<float>, Ud<float>, UdDelta<float>, InverseQr<float>,
             InverseQrDelta<float>, Information<float>, Qr<float>, Gentleman<float>>;

// --- E, by itself ----------------------------------------------------------------------------------------------------

/// X and z of the same rows in 257 bits.
struct Exact {
    Matrix<R> X;
    Vector<R> z;
    explicit Exact(Index d, double variance) : X(Matrix<R>::Identity(d, d) / R(variance)), z(Vector<R>::Zero(d)) {}
    void row(Regressor<float> psi, float y, double w, double lambda) {
        X *= R(lambda), z *= R(lambda);
        for (Index j = 0; j < psi.size(); ++j) {
            for (Index i = 0; i < psi.size(); ++i) X(i, j) += R(w) * R(psi[i]) * R(psi[j]);
            z[j] += R(w) * R(psi[j]) * R(y);
        }
    }
};
/// P in 257 bits, as the filter stores it; of `information` as factored.
template <class F>
Matrix<R> covariance_in_reference(F f) {
    auto stored = f.stored();
    if constexpr (std::same_as<F, Information<float>>) {
        auto const form = f.form();
        stored.form = Stored<float>::Form::factor;
        stored.D = form.D.view();
        for (Index j = 0; j < stored.F.cols(); ++j)
            for (Index i = 0; i < stored.F.rows(); ++i) stored.F(i, j) = i < j ? 0 : form.L(i, j);
    }
    return rlslab::covariance_of(stored.template mapped<R>([](float x) { return R(x); }),
                                 [](Matrix<R> const& X) { return Matrix<R>(X.inverse()); });
}
double norm(Matrix<R> const& E) { return static_cast<double>(R(sqrt(R(E.squaredNorm())))); }

/// A filter through rows, discounts, a reset and removed rows: the certificate is that of E, computed here, and of the
/// same x. `Check` sees both after each stage.
template <class F>
void follow() {
    constexpr Index d = 4;
    Problem<float> const p{.size = d, .forgetting = 0.96875F, .prior = Prior<float>{.variance = 64}};
    Certified<F, 5> f(p, Seed{11});
    F alone(p);
    Exact exact(d, 64);
    Seed rows{5}, seed{11};
    Matrix<R> x(d, 5);
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < 5; ++i) x(j, i) = R(8 * seed.bell());  // 8: the root of 64
    auto const check = [&](char const* what) {
        Certificate<double> const found = f.certificate();
        Matrix<R> const P = covariance_in_reference(f.filter()), r = P * (exact.X * x) - x;
        double const estimate = norm(r) / 8 / std::sqrt(5.0);
        R largest = 0;
        for (Index i = 0; i < 5; ++i) largest = std::max(largest, R(r.col(i).squaredNorm()));
        double const unit = 1e-15 * norm(P) * norm(exact.X);  // the word of the probes: kappa u
        EXPECT_NEAR(found.estimate, estimate, 1e-6 * estimate + unit) << F::name << what;
        EXPECT_NEAR(found.bound, 10 * std::sqrt(static_cast<double>(largest)) / 8, 1e-6 * found.bound + 10 * unit)
            << F::name << what;
        Vector<R> const theta = exact.X.lu().solve(exact.z), off = f.theta().template cast<R>() - theta;
        if (norm(exact.z) > 0) {
            EXPECT_LE(norm(off), found.theta * norm(f.theta().template cast<R>())) << F::name << what;
        }
        EXPECT_TRUE(identical(f.filter(), alone)) << F::name << what << ": the filter's bits are as without probes";
    };
    check(", prior");
    float psi[d];
    auto const take = [&](int n) {
        for (int k = 0; k < n; ++k) {
            float const y = draw(rows, psi);
            f.update(psi, y), alone.update(psi, y);
            exact.row(psi, y, 1, 0.96875);
        }
    };
    take(2), check(", two rows"), take(60), check(", rows");
    float const removed = draw(rows, psi);
    f.update(psi, removed), alone.update(psi, removed), exact.row(psi, removed, 1, 0.96875);
    if constexpr (Downdates<F>) {
        remove(f, Regressor<float>(psi), removed, 1.0F), remove(alone, Regressor<float>(psi), removed, 1.0F);
        exact.row(psi, removed, -1, 1);
        check(", a removed row");
    }
    discount(f, 0.5F), discount(alone, 0.5F);
    exact.X *= R(0.5), exact.z *= R(0.5);
    check(", a discount");
    set_forgetting(f, 0.5F), set_forgetting(alone, 0.5F);
    float const y = draw(rows, psi);
    f.update(psi, y), alone.update(psi, y), exact.row(psi, y, 1, 0.5);
    check(", another lambda");
    Vector<float> const theta0{{1, 2, 3, 4}};
    reset(f, 16.0F, Regressor<float>(theta0)), reset(alone, 16.0F, Regressor<float>(theta0));
    exact = Exact(d, 16), exact.z = theta0.cast<R>() / R(16);
    set_forgetting(f, 0.96875F), set_forgetting(alone, 0.96875F);
    check(", a reset"), take(30), check(", rows after it");
}
static_assert(Certifiable<Ud<float>> && !Certifiable<Guarded<Ud<float>>> && !Certifiable<Windowed<Ud<float>>>);

TEST(Certificate, IsThatOfTheErrorWhateverWasDone) {
    for_each(Dense{}, []<class F>() { follow<F>(); });
}
TEST(Certificate, WithoutAPriorIsKnownOnceThetaIs) {
    for_each(Dense{}, []<class F>() {
        if constexpr (StartsWithoutPrior<F> && NamesItsForm<F>) {
            Certified<F> f({.size = 3, .prior = std::nullopt});
            Seed rows{6};
            float psi[3];
            for (int k = 0; k < 20; ++k) {
                float const y = draw(rows, psi);
                f.update(psi, y);
                if (k < 2) {
                    EXPECT_FALSE(f.certificate().definite) << F::name;
                }
            }
            EXPECT_LT(f.certificate().bound, 1e-4) << F::name;
            EXPECT_LT(f.certificate().theta, 1e-4) << F::name;
        }
    });
}

/// A double P of condition 1e12: probes in double see their own rounding, pairs the filter's.
TEST(Certificate, OfPairsHasNoFloor) {
    Problem<double> const p{.size = 4, .prior = Prior<double>{.variance = 0x1p40}};
    Certified<Ud<double>, 3, Pair> pairs(p);
    Certified<Ud<double>, 3, R> reference(p);
    Certified<Ud<double>> doubles(p);
    Seed rows{5};
    for (int k = 0; k < 100; ++k) {
        double const common = rows.bell();
        double psi[4];
        for (double& x : psi) x = common + 1e-6 * rows.bell();
        double const y = common + rows.bell();
        pairs.update(psi, y), reference.update(psi, y), doubles.update(psi, y);
    }
    double const truth = static_cast<double>(reference.certificate().estimate);
    EXPECT_NEAR(double(pairs.certificate().estimate) / truth, 1, 1e-6);
    EXPECT_GT(doubles.certificate().estimate, 1.5 * truth);
}

/// 2^-3000 is beyond the exponents of the words but one: what m is kept over is settled in time.
TEST(Certificate, StaysOverLongMemoriesInEachWord) {
    auto const check = [](auto f) {
        run_rows(f, 3000, Seed{5});
        EXPECT_LT(double(f.certificate().bound), 1e-6);
    };
    Problem<double> const p{.size = 3, .forgetting = 0.5};
    check(Certified<Ud<double>>(p));
    check(Certified<Ud<double>, 3, Pair>(p));
    check(Certified<Ud<double>, 3, R>(p));
}
TEST(Certificate, IsNoNumberWhereOneProbeIsNone) {
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
        Certified<Ud<double>> f({.size = 2, .prior = Prior<double>{.variance = 1}}, Seed{seed});
        f.update({1e154, 0.5e154}, 1);
        auto const found = f.certificate();
        EXPECT_TRUE(std::isinf(found.bound) || std::isfinite(found.estimate)) << seed;
    }
}

// --- the estimate and the bound --------------------------------------------------------------------------------------

/// Of an error of rank one |r_i| is |v'x_i|: the estimate is within a factor of 2 as often as chi-squared says, and the
/// bound below the truth in 0.08^s of the seeds.
template <int s>
void check_shares(double within) {
    constexpr int runs = 4000;
    int near = 0, below = 0;
    for (int run = 0; run < runs; ++run) {
        Problem<double> const p{.size = 6, .prior = Prior<double>{.variance = 1}};
        Certified<Symmetric<double>, s> f(p, Seed{std::uint64_t(run) * 977});
        Seed rows{std::uint64_t(run)};
        Vector<double> a(6);
        for (double& v : a) v = rows.bell();
        auto form = f.form();
        for (Index j = 0; j < 6; ++j)
            for (Index i = 0; i < 6; ++i) form.P(i, j) += 0.01 * a[i] * a[j];
        double const truth = 0.01 * a.squaredNorm();
        Certificate<double> const found = f.certificate();
        near += truth / 2 <= found.estimate && found.estimate <= 2 * truth;
        below += found.bound < truth;
    }
    EXPECT_NEAR(double(near) / runs, within, 0.025) << s;
    double const expected = runs * Certified<Symmetric<double>, s>::risk;
    EXPECT_LE(below, expected + 4 * std::sqrt(expected) + 1) << s;
}
TEST(Certificate, EstimatesAndBoundsAsChiSquaredSays) {
    check_shares<1>(0.572);
    check_shares<3>(0.854);
    check_shares<6>(0.959);
}

// --- what it sees ----------------------------------------------------------------------------------------------------

template <class Spoil>
double found_after(Spoil spoil) {
    Certified<Ud<float>> f({.size = 4, .forgetting = 0.96875F});
    Seed rows = run_rows(f, 100, Seed{8});
    Certificate<double> const before = f.certificate();
    EXPECT_LT(std::max(before.bound, before.theta), 1e-4);
    spoil(f, rows);
    Certificate<double> const after = f.certificate();
    return std::max(after.bound, after.theta);
}
void flip(float& x, int bit) { x = std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) ^ (std::uint32_t(1) << bit)); }

TEST(Certificate, SeesAFlippedBitASignAndALostRow) {
    for (int const bit : {16, 22, 25, 31}) {  // 2^-7, 1/2, a factor of 2 or 4, the sign
        EXPECT_GT(found_after([&](auto& f, Seed&) { flip(f.form().D[2], bit); }), 3e-4) << bit;
        EXPECT_GT(found_after([&](auto& f, Seed&) { flip(f.form().theta[1], bit); }), 3e-4) << bit;
    }
    EXPECT_GT(found_after([](auto& f, Seed&) { f.form().U(0, 3) += 0.01F; }), 3e-4);
    EXPECT_GT(found_after([](auto& f, Seed&) {  // lambda applied twice
                  discount(f.form().inside(), 0.96875F);
              }),
              3e-4);
    EXPECT_GT(found_after([](auto& f, Seed& rows) {  // a row that the filter did not see
                  float psi[4];
                  auto copy = f.filter();
                  float const y = draw(rows, psi);
                  f.update(psi, y);
                  f.form().inside().D = copy.form().D, f.form().U = copy.form().U, f.form().theta = copy.form().theta;
              }),
              3e-4);
    EXPECT_LT(found_after([](auto&, Seed&) {}), 1e-4);
}
TEST(Certificate, SpeaksBeforeHealth) {
    for (float const lambda : {0.9F, 0.95F, 0.98F}) {
        Certified<Conventional<float>> f({.size = 5, .forgetting = lambda});
        Seed rows{7};
        float psi[5];
        int first = 0, broke = 0;
        for (int k = 1; k <= 3000 && broke == 0; ++k) {
            float const y = draw(rows, psi);
            if (f.update(psi, y).health != Health::sound) broke = k;
            if (first == 0 && k > 10 && !f.certificate().definite) first = k;
        }
        EXPECT_GT(first, 0) << lambda;
        EXPECT_GT(broke, first + 20) << lambda;
    }
}

// --- compositions, states, packs -------------------------------------------------------------------------------------

template <class F>
Certificate<double> certificate_inside(F const& f) {
    if constexpr (requires { f.certificate(); }) return f.certificate();
    else return certificate_inside(f.filter());
}
template <class F>
void check_around(F f) {
    Seed rows{9};
    float psi[4];
    for (int k = 0; k < 300; ++k) {
        float y = draw(rows, psi, 0.125, k < 150 ? 1 : -1);
        if (k == 60) y = 1e6F;
        f.update(psi, y);
        if (k % 50 == 49) {
            EXPECT_LT(certificate_inside(f).bound, 1e-2) << k;
        }
    }
}
TEST(Certificate, FollowsGuardsWindowsWeightsAndRules) {
    using C = Certified<Ud<float, 4>>;
    Problem<float> const p{.size = 4, .forgetting = 0.96875F};
    check_around(Guarded<C>(p));
    check_around(Guarded<C, rebuilding>(p));
    check_around(Windowed<C>(p, {.rows = 20}));
    check_around(Guarded<Windowed<C>>(Windowed<C>(p, {.rows = 30}), p));
    check_around(Weighted<C>(p));
    check_around(Forgetting<C, Fortescue<float>>({.size = 4}));
    check_around(Windowed<Certified<Qr<float, 4>>>(p, {.rows = 20}));
    Forgetting<C, Kulhavy<float>> ends({.size = 4});
    run_rows(ends, 1, Seed{9});
    EXPECT_TRUE(std::isinf(certificate_inside(ends).bound)) << "a rule that adds to P";
}
/// No row that says anything: Phat m is x to the last bit, and P = I / 0.9 is rounded.
TEST(Certificate, IsNotBelowTheRoundingOfItsWord) {
    Certified<Ud<double>> f({.size = 4, .forgetting = 0.9});
    double const zeros[4]{};
    f.update(zeros, 0);
    EXPECT_GE(f.certificate().bound, 0x1p-50);
}
TEST(Certificate, HasTheSameBitsOnEveryInstructionSet) {
    Isa const here = kernels::isa;
    for_each(Dense{}, [&]<class F>() {
        std::vector<double> bounds;
        for (Isa const isa : {Isa::baseline, here}) {
            kernels::isa = isa;
            Certified<F> f({.size = 13, .forgetting = 0.96875F});
            run_rows(f, 50, Seed{10});
            bounds.push_back(f.certificate().bound);
        }
        EXPECT_EQ(bounds[0], bounds[1]) << F::name;
    });
    kernels::isa = here;
}
TEST(Certificate, RefusesAProblemOfAnotherSize) {
    Ud<double> const f({.size = 3});
    Problem<double> p{.size = 2, .prior = Prior<double>{.covariance = Matrix<double>::Identity(2, 2)}};
    EXPECT_THROW((Certified<Ud<double>>(f, p)), std::invalid_argument);
    p.prior = Prior<double>{.theta = Vector<double>::Zero(2)};
    EXPECT_THROW((Certified<Ud<double>>(f, p)), std::invalid_argument);
}
TEST(Certificate, IsInTheState) {
    using F = Certified<Ud<float, 4>>;
    Problem<float> const p{.size = 4, .forgetting = 0.96875F};
    F const f(p, Seed{3});
    check_state(f, F(p, Seed{4}), [](F& of, int rows, Seed seed) { run_rows(of, rows, seed); });
    Certified<Ud<float, 4>, 2> other(p);
    EXPECT_NE(load(other, state_of(f)), StateFault::none);
}
/// As the scalar guards, though one lane is spoiled, another refuses rows, a third restarts, and a fourth is inflated.
template <class T>
void check_lanes_apart(double lambda, int rows_in_all) {
    using P = Pack<T, 8>;
    using Alone = Guarded<Certified<Ud<T, 3>>>;
    Certified<Ud<P, 3>> bare_packs({.size = 3, .forgetting = P(T(lambda))});
    std::vector<Certified<Ud<T, 3>>> bare(8, Certified<Ud<T, 3>>({.size = 3, .forgetting = T(lambda)}));
    Guarded<Certified<Ud<P, 3>>> packs({.size = 3, .forgetting = P(T(lambda))});
    std::vector<Alone> alone(8, Alone({.size = 3, .forgetting = T(lambda)}));
    P added(T(0));
    added.set(4, T(0.5));
    Seed rows{13};
    for (int k = 0; k < rows_in_all; ++k) {
        P psi[3], y;
        for (int lane = 0; lane < 8; ++lane) {
            T one[3];
            T out = draw(rows, one, 0.125, lane == 3 && k >= 100 ? -1 : 1);  // lane 3 changes
            if (lane == 2 && k % 20 == 10) out = T(1e30);                    // lane 2 skips
            for (int i = 0; i < 3; ++i) psi[i].set(lane, one[i]);
            y.set(lane, out);
            if (k == 150 && lane == 4) inflate(alone[4].form(), T(0.5), Regressor<T>(one));
            alone[size_t(lane)].update(one, out), bare[size_t(lane)].update(one, out);
        }
        if (k == 150) inflate(packs.form(), added, Regressor<P>(psi));
        packs.update(psi, y), bare_packs.update(psi, y);
        if (k % 25 != 24) continue;
        auto const found = packs.certificate(), found_bare = bare_packs.certificate();
        for (int lane = 0; lane < 8; ++lane) {
            Certificate<double> const of = alone[size_t(lane)].certificate();
            EXPECT_TRUE(same(found.estimate[lane], of.estimate) && same(found.bound[lane], of.bound))
                << k << " " << lane;
            EXPECT_TRUE(same(found.theta[lane], of.theta) && found.definite[lane] == of.definite) << k << " " << lane;
            EXPECT_EQ(of.ended, lane == 4 && k > 150);
            Certificate<double> const without = bare[size_t(lane)].certificate();
            EXPECT_TRUE(same(found_bare.bound[lane], without.bound) && same(found_bare.theta[lane], without.theta))
                << k;
        }
    }
    EXPECT_EQ(alone[3].counts().changes, 1);
}
TEST(Certificate, OfPacksEndsAndStartsInEachLaneAlone) {
    check_lanes_apart<float>(0.96875, 200);
    check_lanes_apart<float>(0.3125, 500);  // where m is kept over less than 2^-500, but in the lane that restarts
    check_lanes_apart<double>(0.96875, 200);
}

}  // namespace
}  // namespace rlslab
