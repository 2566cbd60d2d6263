// Windows, guards and rules: what was loaded goes on bit for bit as what was saved; what is damaged is refused.
#include <rlslab/state/state.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/assessed.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/information.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>

#include <gtest/gtest.h>

#include <cstring>

namespace rlslab {
namespace {

using namespace adapt_laws;

using Bytes = std::vector<std::byte>;

template <class F>
Bytes bytes_of(F const& f) {
    Bytes out(state_size(f));
    save(f, out);
    return out;
}

/// What comes around a filter, made with its options and any problem.
template <class F>
struct Made {
    template <class T>
    static F of(T forgetting, T variance) {
        Problem<T> const problem{.size = 3, .forgetting = forgetting, .prior = Prior<T>{.variance = variance}};
        if constexpr (std::constructible_from<F, Problem<T>, WindowOptions<T>>)
            return F(problem, WindowOptions<T>{.rows = 7});
        else if constexpr (std::constructible_from<F, Problem<T>, GuardOptions<T>>)
            return F(problem, GuardOptions<T>{.noise_memory = 20});
        else return F(problem);
    }
    static F saved() { return of<typename F::scalar>(0.9375, 64); }
    static F other() { return of<typename F::scalar>(0.5, 4); }
};
/// Good rows, then silence, outliers, a NaN, a change of sign: whatever the guard and the window know of comes up. Each
/// row's report.
template <class F>
std::vector<double> reports(F& f, int rows, Seed seed) {
    using T = typename F::scalar;
    std::vector<double> out;
    T psi[3];
    for (int k = 0; k < rows; ++k) {
        T y = draw(seed, psi, 0.125, k % 400 < 300 ? 1 : -1);
        int const part = k % 100;
        if (part > 80)
            for (T& x : psi) x *= T(part > 90 ? 0 : 1000);
        if (part == 70) y += T(1e5);
        if (part == 75) psi[1] = T(NAN);
        Step<T> const step = f.update(psi, y);
        for (T const x : {step.innovation, step.residual, step.gamma, f.theta()[0], f.theta()[2], f.gain()[1]})
            out.push_back(double(x));
        out.push_back(double(int(step.health)));
    }
    return out;
}
bool same(std::vector<double> const& a, std::vector<double> const& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}
/// "" or where what was loaded parts from what was saved.
template <class F>
std::string parted(int before) {
    F f = Made<F>::saved(), g = Made<F>::other();
    reports(f, before, Seed{11});
    if (before > 1) reports(g, 33, Seed{12});
    if (load(g, bytes_of(f)) != StateFault::none) return "refused";
    if (bytes_of(g) != bytes_of(f)) return "at once";
    if (!same(reports(f, 900, Seed{13}), reports(g, 900, Seed{13}))) return "in a report";
    return bytes_of(f) == bytes_of(g) ? "" : "at the end";
}
template <class F>
void check(char const* what) {
    for (int before : {0, 1, 20, 74, 95, 250}) EXPECT_EQ(parted<F>(before), "") << what << " after " << before;
    F const f = Made<F>::saved();
    Ud<typename F::scalar, 3> bare({});
    EXPECT_EQ(load(bare, bytes_of(f)), F::name == "ud" ? StateFault::layout : StateFault::variant) << what;
    F g = Made<F>::other();
    EXPECT_NE(load(g, bytes_of(bare)), StateFault::none) << what;
}

TEST(State, OfAWindowContinuesBitForBit) {
    check<Windowed<Ud<float, 3>>>("ud");
    check<Windowed<Qr<double>>>("qr");
    check<Windowed<Symmetric<double, 3>>>("symmetric");
}
TEST(State, OfAGuardContinuesBitForBit) {
    check<Guarded<Ud<float, 3>>>("resetting");
    check<Guarded<Qr<double, 3>, rebuilding>>("rebuilding");
    check<Guarded<Symmetric<double>, reporting>>("reporting");
    check<Guarded<Windowed<Ud<double, 3>>>>("a window");
}
TEST(State, OfARuleContinuesBitForBit) {
    using F = Ud<double, 3>;
    check<Forgetting<F, ConstantForgetting<double>>>("constant");
    check<Forgetting<F, Fortescue<double>>>("fortescue");
    check<Forgetting<F, Kulhavy<double>>>("kulhavy");
    check<Forgetting<F, CaoSchwartz<double>>>("cao");
    check<Forgetting<F, RotatingRidge<double>>>("ridge");
    check<Forgetting<F, CovarianceReset<double>>>("reset");
    check<Forgetting<F, RandomWalk<double>>>("walk");
    check<Guarded<Forgetting<Ud<float, 3>, RotatingRidge<float>>>>("guarded ridge");
}

/// Another rule, policy or option is refused, and the filter is then as it was.
template <class From, class To>
StateFault crossed(From const& from, To to) {
    Bytes const before = bytes_of(to);
    StateFault const fault = load(to, bytes_of(from));
    EXPECT_EQ(bytes_of(to), before);
    return fault;
}
TEST(State, NamesRulesPoliciesAndOptions) {
    using F = Ud<double>;
    Problem<double> const p{.size = 3, .forgetting = 0.96875};
    Forgetting<F, RotatingRidge<double>> const ridge(p);
    EXPECT_EQ(crossed(ridge, Forgetting<F, RotatingRidge<double>>(p)), StateFault::none);
    EXPECT_EQ(crossed(ridge, Forgetting<F, RotatingRidge<double>>(p, {.ridge = 0.002})), StateFault::options);
    EXPECT_EQ(crossed(ridge, Forgetting<F, RotatingRidge<double>>(p, {.toward_zero = true})), StateFault::options);
    EXPECT_EQ(crossed(ridge, Forgetting<F, Fortescue<double>>(p)), StateFault::layout);
    EXPECT_EQ(crossed(ridge, Forgetting<F, Kulhavy<double>>(p)), StateFault::layout);
    EXPECT_EQ(crossed(Forgetting<F, Kulhavy<double>>(p), Forgetting<F, CaoSchwartz<double>>(p)), StateFault::layout);
    EXPECT_EQ(crossed(Guarded<F, resetting>(p), Guarded<F, reporting>(p)), StateFault::options);
    EXPECT_EQ(crossed(Guarded<F>(p), Guarded<F>(p, {.innovation = 4})), StateFault::options);
    EXPECT_EQ(crossed(Guarded<F>(p, {.least_noise = -0.0}), Guarded<F>(p)), StateFault::none);
    EXPECT_EQ(crossed(Windowed<F>(p, {.rows = 7}), Windowed<F>(p, {.rows = 8})), StateFault::options);
    EXPECT_EQ(crossed(Windowed<F>(p, {.rows = 7}), Guarded<F>(p)), StateFault::layout);
    EXPECT_EQ(crossed(Weighted<F>(p), Assessed<F>(p)), StateFault::layout);
    EXPECT_EQ(crossed(Assessed<F>(p), Assessed<F>(p, {.noise_memory = 7})), StateFault::options);
    EXPECT_EQ(crossed(MultiOutput<F>(p, 2), MultiOutput<F>(p, 2, MissingOutput::stands)), StateFault::options);
}
/// A variant whose bits have changed.
struct NextUd : Ud<double, 3> {
    using Ud::Ud;
    static constexpr int edition = 2;
};
TEST(State, OfAnotherEditionIsRefused) {
    Ud<double, 3> f({.forgetting = 0.5});
    f.update({1, 2, 3}, 4);
    NextUd next(Problem<double>{});
    Bytes const before = bytes_of(next);
    EXPECT_EQ(load(next, bytes_of(f)), StateFault::edition);
    EXPECT_EQ(bytes_of(next), before);
    EXPECT_EQ(load(f, bytes_of(next)), StateFault::edition);
    Guarded<Ud<double, 3>> guarded({});
    Guarded<NextUd> guarded_next({});
    EXPECT_EQ(load(guarded_next, bytes_of(guarded)), StateFault::edition);
}
template <class F>
void expect_a_fleet_to_continue(Problem<double> const& p) {
    F f(10, p), g(10, {.size = 3}), other(11, p);
    Seed seed{17};
    auto const take = [&seed](F& fleet, int rows) {
        for (int k = 0; k < rows; ++k) {
            Matrix<double> psi = Matrix<double>::NullaryExpr(10, 3, [&seed] { return seed.bell(); });
            if (k % 3 == 1) psi(k % 10, 1) = NAN;
            fleet.update(psi, Vector<double>::NullaryExpr(10, [&seed] { return seed.bell(); }));
            if (k % 5 == 4) fleet.reset(k % 10);
        }
    };
    take(f, 6);
    ASSERT_EQ(load(g, bytes_of(f)), StateFault::none);
    EXPECT_EQ(load(other, bytes_of(f)), StateFault::options);
    Seed const here = seed;
    take(f, 20);
    seed = here;
    take(g, 20);
    EXPECT_EQ(bytes_of(f), bytes_of(g));
    for (Index i = 0; i < 10; ++i) EXPECT_EQ(f.health(i), g.health(i));
}
TEST(State, OfAFleetContinuesBitForBit) {
    Problem<double> p{.size = 3, .forgetting = 0.96875};
    expect_a_fleet_to_continue<Fleet<Ud<Pack<double, 4>, 3>>>(p);
    expect_a_fleet_to_continue<Fleet<Conventional<Pack<double, 4>>>>(p);
    p.prior = std::nullopt;
    expect_a_fleet_to_continue<Fleet<Information<Pack<double, 4>>>>(p);
    expect_a_fleet_to_continue<Fleet<Gentleman<Pack<double, 4>>>>(p);
}
/// Whether the law sees that member i is missing from the list. It holds for the members that these rows need: what a
/// look at one coordinate corrects, or what counts, is not among them.
template <class F, size_t i>
bool is_missed() {
    for (int before : {20, 250}) {
        F f = Made<F>::saved(), g = Made<F>::other();
        reports(f, before, Seed{11});
        auto to = F::state(g);
        auto const from = F::state(std::as_const(f));
        [&]<size_t... j>(std::index_sequence<j...>) {
            ((j == i ? void() : void(std::get<j>(to) = std::get<j>(from))), ...);
        }(std::make_index_sequence<std::tuple_size_v<decltype(to)>>());
        if (!same(reports(f, 900, Seed{13}), reports(g, 900, Seed{13})) || bytes_of(f) != bytes_of(g)) return true;
    }
    return false;
}
template <class F, size_t... i>
void check_missed(char const* what) {
    auto const one = [what](size_t member, bool missed) { EXPECT_TRUE(missed) << what << ", member " << member; };
    (one(i, is_missed<F, i>()), ...);
    EXPECT_FALSE((is_missed<F, 1000>())) << what;
}
TEST(StateSaboteur, AListThatForgetsAMemberOfWhatIsAroundIsCaught) {
    check_missed<Windowed<Ud<double, 3>>, 0, 1, 2, 4, 6>("window");
    check_missed<Guarded<Ud<float, 3>>, 0, 3, 4, 5, 6, 7, 8, 9, 10>("guard");
    check_missed<Guarded<Qr<double, 3>, rebuilding>, 0>("rebuilding guard");
    check_missed<Forgetting<Ud<double, 3>, RotatingRidge<double>>, 0, 1, 2, 3>("ridge");
}

/// Each bit flipped, each length, each byte gone or twice.
template <class F>
int accepted() {
    F f = Made<F>::saved();
    reports(f, 60, Seed{3});
    Bytes const whole = bytes_of(f);
    F g = Made<F>::other();
    Bytes const before = bytes_of(g);
    int out = 0;
    auto const offer = [&](Bytes const& bytes) {
        if (bytes != whole) out += load(g, bytes) == StateFault::none;
    };
    for (size_t i = 0; i < 8 * whole.size(); ++i) {
        Bytes bytes = whole;
        bytes[i / 8] ^= std::byte(1 << i % 8);
        offer(bytes);
    }
    for (size_t n = 0; n < whole.size(); ++n) {
        Bytes less = whole, more = whole;
        less.erase(less.begin() + std::ptrdiff_t(n));
        more.insert(more.begin() + std::ptrdiff_t(n), whole[n]);
        offer(less);
        offer(more);
        offer(Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(n)));
    }
    return out + (bytes_of(g) != before);
}
TEST(State, OfWhatIsAroundIsRefusedWhereDamaged) {
    EXPECT_EQ((accepted<Windowed<Ud<float, 3>>>()), 0);
    EXPECT_EQ((accepted<Guarded<Ud<float, 3>>>()), 0);
    EXPECT_EQ((accepted<Forgetting<Ud<double, 3>, Fortescue<double>>>()), 0);
}
/// With another number at a place, and the checksum made right.
Bytes forged(Bytes bytes, size_t at, std::uint64_t number) {
    detail::write_low(number, 8, &bytes[at]);
    Checksum sum;
    sum.add(std::span(bytes).first(bytes.size() - StateHeader::checksum));
    detail::write_low(sum.value(), StateHeader::checksum, bytes.data() + bytes.size() - StateHeader::checksum);
    return bytes;
}
/// A forged checksum does not make a program reach outside its memory: places in a ring and counts of what is kept have
/// an end.
TEST(State, OfAWindowHoldsNoPlaceOutsideItsRing) {
    using W = Windowed<Ud<float, 3>>;
    W f = Made<W>::saved();
    reports(f, 5, Seed{3});
    Bytes const whole = bytes_of(f);
    W g = Made<W>::other();
    Bytes const before = bytes_of(g);
    int taken = 0, refused = 0;
    for (size_t at = StateHeader::size; at + 8 <= whole.size() - StateHeader::checksum; ++at) {
        std::uint64_t count = 0;
        std::memcpy(&count, &whole[at], 8);
        if (count != 5) continue;  // rows held, the next place, rows since
        for (std::uint64_t wrong : {std::uint64_t(8), std::uint64_t(1) << 40, ~std::uint64_t(0)})
            (load(g, forged(whole, at, wrong)) == StateFault::value ? refused : taken) += 1;
    }
    EXPECT_EQ(refused, 6);
    EXPECT_EQ(taken, 3) << "rows since the last factoring are a count alone";
}
/// A rule goes round the coordinates by the number of its rows, the last number of its state.
TEST(State, OfARuleHoldsNoNumberOfRowsBelowNone) {
    using F = Forgetting<Ud<double, 3>, RotatingRidge<double>>;
    F f({.size = 3});
    reports(f, 5, Seed{3});
    Bytes const whole = bytes_of(f);
    F g({.size = 3});
    size_t const last = whole.size() - StateHeader::checksum - 8;
    EXPECT_EQ(load(g, forged(whole, last, 6)), StateFault::none);
    for (std::uint64_t wrong : {std::uint64_t(-2), std::uint64_t(1) << 63})
        EXPECT_EQ(load(g, forged(whole, last, wrong)), StateFault::value);
}

}  // namespace
}  // namespace rlslab
