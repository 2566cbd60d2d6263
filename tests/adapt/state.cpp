// Windows, guards and rules: what was loaded goes on bit for bit as what was saved; what is damaged is refused.
#include <rlslab/state/state.hpp>

#include "tests/adapt/adapt.hpp"
#include "tests/common/twins.hpp"

#include <rlslab/adapt/assessed.hpp>
#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/adapt/weighted.hpp>

#include <gtest/gtest.h>

#include <cstring>

namespace rlslab {
namespace {

using namespace adapt_laws;

using states::Bytes, states::bytes_of, states::sealed;

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
/// Good rows, then silence, outliers, a NaN, a change of sign: whatever the guard and the window know of comes up.
twins::Rows rows_of(Index count, Seed seed) {
    twins::Rows out;
    for (Index k = 0; k < count; ++k) {
        double psi[3];
        double y = draw(seed, psi, 0.125, k % 400 < 300 ? 1 : -1);
        Index const part = k % 100;
        if (part > 80)
            for (double& x : psi) x *= part > 90 ? 0 : 1000;
        if (part == 70) y += 1e5;
        if (part == 75) psi[1] = NAN;
        out.push_back({Vector<double>{{psi[0], psi[1], psi[2]}}, y, 1, k});
    }
    return out;
}
/// f after these rows.
template <class F>
F after(F const& start, Index count, Seed seed) {
    F f = start;
    for (auto const& row : rows_of(count, seed)) twins::Update{}(f, twins::row_in<typename F::scalar>(row));
    return f;
}
/// What f leaves from here on, its whole state included.
template <class F>
twins::Trace from_here(F const& f) {
    return twins::trace(f, rows_of(900, Seed{13}), true);
}
/// "" or where what was loaded parts from what was saved.
template <class F>
std::string parted(int before) {
    F const f = after(Made<F>::saved(), before, Seed{11});
    F g = after(Made<F>::other(), before > 1 ? 33 : 0, Seed{12});
    if (load(g, bytes_of(f)) != StateFault::none) return "refused";
    return bytes_of(g) == bytes_of(f) ? twins::parted(from_here(f), from_here(g)) : "at once";
}
void expect_kept(std::string_view what, std::vector<std::string> const& parted, StateFault into_bare, bool is_ud,
                 StateFault from_bare) {
    EXPECT_EQ(parted, std::vector<std::string>(parted.size())) << what;
    EXPECT_EQ(into_bare, is_ud ? StateFault::layout : StateFault::variant) << what;
    EXPECT_NE(from_bare, StateFault::none) << what;
}
template <class F>
void check(char const* what) {
    Ud<typename F::scalar, 3> bare({});
    F g = Made<F>::other();
    expect_kept(what, {parted<F>(0), parted<F>(1), parted<F>(20), parted<F>(74), parted<F>(95), parted<F>(250)},
                load(bare, bytes_of(Made<F>::saved())), F::name == "ud", load(g, bytes_of(bare)));
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
/// Whether the law sees that member i is missing from the list. It holds for the members that these rows need: what a
/// look at one coordinate corrects, or what counts, is not among them.
template <class F, size_t i>
bool is_missed() {
    for (int before : {20, 250}) {
        F const f = after(Made<F>::saved(), before, Seed{11});
        F g = Made<F>::other();
        states::take_all_but<i>(g, f);
        if (!twins::parted(from_here(f), from_here(g)).empty()) return true;
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

template <class F>
int accepted() {
    F const f = after(Made<F>::saved(), 60, Seed{3});
    F g = Made<F>::other();
    Bytes const before = bytes_of(g);
    int out = 0;
    states::each_damaged(bytes_of(f), [&](Bytes const& bytes) { out += load(g, bytes) == StateFault::none; });
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
    return sealed(bytes);
}
/// A forged checksum does not make a program reach outside its memory: places in a ring and counts of what is kept have
/// an end.
TEST(State, OfAWindowHoldsNoPlaceOutsideItsRing) {
    using W = Windowed<Ud<float, 3>>;
    W const f = after(Made<W>::saved(), 5, Seed{3});
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
    F const f = after(F({.size = 3}), 5, Seed{3});
    Bytes const whole = bytes_of(f);
    F g({.size = 3});
    size_t const last = whole.size() - StateHeader::checksum - 8;
    EXPECT_EQ(load(g, forged(whole, last, 6)), StateFault::none);
    for (std::uint64_t wrong : {std::uint64_t(-2), std::uint64_t(1) << 63})
        EXPECT_EQ(load(g, forged(whole, last, wrong)), StateFault::value);
}

}  // namespace
}  // namespace rlslab
