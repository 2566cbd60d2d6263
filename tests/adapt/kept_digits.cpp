// A guard that is asked for digits rebuilds where the probes' bound is above them, and nowhere else.
#include <rlslab/adapt/certified.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/window.hpp>
#include <rlslab/arithmetic/pair.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace adapt_laws;

template <class F>
concept TakesDigits = requires(Problem<float> p) { Guarded<F>(p, {.digits = 4}); };
static_assert(TakesDigits<Certified<Ud<float>>> && TakesDigits<Windowed<Certified<Ud<float>>>>);
static_assert(!TakesDigits<Ud<float>> && !TakesDigits<Windowed<Ud<float>>>, "digits without probes");

/// The largest bound at each check, and right after each breakdown; `Look` sees the filter before each row.
template <class G, class Look>
double largest_bound(G& f, int rows, int every, Look look) {
    Seed seed{7};
    float psi[5];
    double most = 0;
    for (int k = 1; k <= rows; ++k) {
        look(f, k);
        float const y = draw(seed, psi);
        EXPECT_EQ(f.update(psi, y).health, Health::sound) << k;
        if (k % every == 0 || f.signal() == GuardSignal::breakdown) most = std::max(most, f.certificate().bound);
    }
    return most;
}
constexpr auto nothing = [](auto const&, int) {};

TEST(GuardedDigits, AreKeptByRebuilding) {
    Problem<float> const p{.size = 5, .forgetting = 0.95F};
    Guarded<Certified<Conventional<float>>, rebuilding> f(p, {.digits = {3, 20}});
    EXPECT_LE(largest_bound(f, 20000, 20, nothing), 1e-3);
    EXPECT_GT(f.counts().breakdowns, 100) << "each 60 rows or so";
    EXPECT_EQ(f.counts().outliers, 0);
    Guarded<Certified<Conventional<float>>, rebuilding> without(p);
    EXPECT_GT(largest_bound(without, 400, 20, nothing), 1e-3) << "a guard that is asked for none";
}
TEST(GuardedDigits, RaiseNoFalseAlarmInAMillionRows) {
    Guarded<Certified<Ud<float, 5>>, rebuilding> f({.size = 5, .forgetting = 0.98F}, {.digits = 4});
    EXPECT_LE(largest_bound(f, 1000000, 100, nothing), 1e-4);
    EXPECT_EQ(f.counts().breakdowns, 0);
}
/// The rows of docs/certificate.md, without its damage: D of the constant regressor comes to rest, and drifts.
TEST(GuardedDigits, OfAConstantRegressorAreThreeInFloat) {
    for (std::uint64_t run = 2; run < 22; ++run)
        for (int digits : {3, 4}) {
            Guarded<Certified<Ud<float, 3>>, reporting> f({.forgetting = 0.99F}, {.digits = {digits, 100}});
            Seed seed{run};
            for (int k = 0; k < 3000; ++k) {
                float const x[] = {1, float(seed.bell()), float(seed.bell())};
                f.update(x, 2 + x[1] - x[2] + 0.1F * float(seed.bell()));
            }
            EXPECT_EQ(f.counts().breakdowns > 0, digits == 4) << run;
        }
}
TEST(GuardedDigits, AreBackAfterAnErrorOfP) {
    Guarded<Windowed<Certified<Ud<float>>>, rebuilding> windowed(
        Windowed<Certified<Ud<float>>>({.size = 5}, {.rows = 300}), {.size = 5}, {.digits = 4});
    Guarded<Certified<Ud<float>>, rebuilding> f({.size = 5, .forgetting = 0.98F}, {.digits = 4});
    auto const spoil = [](auto& g, int k) {
        if (k == 450) g.form().D[2] *= 1.5F;
    };
    EXPECT_LE(largest_bound(f, 1000, 100, spoil), 1e-4);
    EXPECT_EQ(f.counts().breakdowns, 1);
    EXPECT_LE(largest_bound(windowed, 1000, 100, nothing), 1e-4);
    EXPECT_EQ(windowed.counts().breakdowns, 0);
}
TEST(GuardedDigits, OfACertificateThatHasEndedAreNotAskedFor) {
    using F = Forgetting<Certified<Ud<float>>, Kulhavy<float>>;
    Guarded<F, rebuilding> f({.size = 5}, {.digits = {4, 1}});
    largest_bound(f, 100, 10, nothing);
    EXPECT_EQ(f.counts().breakdowns, 0);
    EXPECT_THROW((Guarded<F>({.size = 5}, {.digits = -1})), std::invalid_argument);
    EXPECT_THROW((Guarded<F>({.size = 5}, {.digits = {4, 0}})), std::invalid_argument);
}
/// Numbers that overflow are a breakdown, but of a certificate that has ended.
TEST(GuardedDigits, TellAnOverflowFromAnEnd) {
    Problem<double> const p{.size = 3};
    auto const breakdowns = []<class F>(Guarded<F, rebuilding> f) {
        Seed seed{7};
        double psi[3];
        for (int k = 1; k <= 20; ++k) {
            double const y = draw(seed, psi);
            f.update(psi, y);
            for (int i = 0; i < 3 && k == 10; ++i) f.form().D[i] = 1e170;  // |r_i|^2 overflows after a row and a cap
        }
        return f.counts().breakdowns;
    };
    using F = Certified<Ud<double>>;
    GuardOptions<double, true> const options{.innovation = 0, .digits = {4, 1}};
    EXPECT_EQ(breakdowns(Guarded<F, rebuilding>(p, options)), 1);
    EXPECT_EQ(breakdowns(Guarded<Forgetting<F, Kulhavy<double>>, rebuilding>(p, options)), 0);
}
/// A check that would fall on a row that is refused or skipped is made at the next row taken.
TEST(GuardedDigits, OfARowThatIsNotTakenAreLookedAtWithTheNext) {
    for (float const bad : {1e30F, 1e6F}) {  // beyond (1), and an outlier
        Guarded<Certified<Ud<float>>, rebuilding> f({.size = 5}, {.digits = {4, 50}});
        Seed seed{7};
        float psi[5];
        for (int k = 1; k <= 201; ++k) {
            float const y = draw(seed, psi);
            if (k == 200) f.form().D[2] *= 1.5F;
            f.update(psi, k == 200 ? bad : y);
            ASSERT_EQ(f.counts().breakdowns, k > 200) << k << " " << bad;
        }
        EXPECT_EQ(f.counts().unusable + f.counts().outliers, 1) << bad;
    }
}
/// The most that is asked is kept by a filter that does nothing; one more is refused, and said.
template <class F>
void at_most(Index d, int most) {
    using T = typename F::scalar;
    Problem<T> const p{.size = d};
    Guarded<F> f(p, {.digits = {most, 1}});
    Vector<T> const zeros = Vector<T>::Zero(d);
    for (int k = 0; k < 5; ++k) f.update(zeros, T(0));
    EXPECT_EQ(f.counts().breakdowns, 0);
    try {
        Guarded<F> const refused(p, {.digits = most + 1});
        ADD_FAILURE() << most + 1 << " digits";
    } catch (std::invalid_argument const& e) {
        EXPECT_EQ(e.what(), "expected digits <= " + std::to_string(most) + ", all that a bound in these words shows");
    }
}
TEST(GuardedDigits, BeyondTheWordsAreRefused) {
    at_most<Certified<Ud<float>>>(5, 6);
    at_most<Certified<Ud<double>>>(3, 14);
    at_most<Certified<Ud<double>>>(128, 13);
    at_most<Certified<Ud<double>, 3, Pair>>(128, 14);
}
TEST(GuardedDigits, AreNotInTheState) {
    using F = Guarded<Certified<Ud<float>>, rebuilding>;
    F f({.size = 5}, {.digits = 4}), other({.size = 5});
    largest_bound(f, 50, 10, nothing);
    EXPECT_EQ(load(other, state_of(f)), StateFault::none);
    EXPECT_EQ(state_of(other), state_of(f));
}

}  // namespace
}  // namespace rlslab
