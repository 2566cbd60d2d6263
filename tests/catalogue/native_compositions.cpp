// Compositions by name have the bits, the states and the counts of the C++ types, in the native layer and in the lab's.
#include <rlslab/catalogue/composed.hpp>
#include <rlslab/catalogue/native/filter.hpp>
#include "tests/common/composed.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/arithmetic/quad.hpp>
#include <rlslab/core/input_error.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace composed_laws;
using native::Filter;
using native::Options;
using testing::HasSubstr;

/// Outliers, a change, and a stretch of silence, in which P winds up.
Records const& records() {
    static Records const all = [] {
        Records out = rows_of(500, 100, 250, Seed{21});
        out.psi.middleCols(300, 60).setZero();
        out.psi(1, 420) = std::numeric_limits<double>::quiet_NaN();
        return out;
    }();
    return all;
}
template <class F>
std::vector<std::byte> state_bytes_of(F const& f) {
    std::vector<std::byte> out;
    if constexpr (NamesItsState<F>) {
        out.resize(state_size(f));
        save(f, std::span(out));
    } else {
        out.resize(f.state_size());
        f.save(out);
    }
    return out;
}
/// The same rows into both: the same state after each, and either's state goes on in the other.
template <class F>
void expect_alike(F typed, std::unique_ptr<Filter> filter) {
    using T = typename F::scalar;
    F const start = typed;
    auto const fresh = filter->clone();
    std::unique_ptr<Filter> found;  // from the state alone
    std::vector<double> theta(d), gain(d);
    for (Index k = 0; k < records().rows(); ++k) {
        Vector<T> const psi = records().psi.col(k).cast<T>();
        auto const a = typed.update(psi, T(records().y[k]));
        auto const b = filter->update(psi.data(), T(records().y[k]));
        ASSERT_EQ(std::int32_t(a.health), b.health) << k;
        ASSERT_TRUE(double(a.gamma) == b.gamma || a.gamma != a.gamma) << k;
        ASSERT_EQ(state_bytes_of(typed), state_bytes_of(*filter)) << k;
        if (found) {
            found->update(psi.data(), T(records().y[k]));
            ASSERT_EQ(state_bytes_of(*found), state_bytes_of(*filter)) << k;
        }
        filter->theta(theta.data());
        filter->gain(gain.data());
        Vector<T> const theirs = typed.theta(), K = typed.gain();
        for (Index i = 0; i < d; ++i) {
            ASSERT_TRUE(double(theirs[i]) == theta[std::size_t(i)] || theirs[i] != theirs[i]) << k;
            ASSERT_TRUE(double(K[i]) == gain[std::size_t(i)] || K[i] != K[i]) << k;
        }
        if constexpr (requires { typed.signal(); }) {
            ASSERT_EQ(std::int32_t(typed.signal()), filter->signal()) << k;
            ASSERT_EQ(filter->signal(), b.signal);
        }
        if (k == records().rows() / 2) {
            F other = start;
            auto const another = fresh->clone();
            std::vector<std::byte> const state = state_bytes_of(typed);
            ASSERT_EQ(load(other, state_bytes_of(*filter)), StateFault::none);
            another->load(state);
            ASSERT_EQ(state_bytes_of(other), state);
            ASSERT_EQ(state_bytes_of(*another), state);
            filter = another->clone();
            found = native::from_state(state);
            ASSERT_EQ(state_bytes_of(*found), state);
            ASSERT_EQ(found->variant(), filter->variant());
        }
    }
    if constexpr (requires { typed.counts(); }) {
        EXPECT_EQ(filter->counts().outliers, typed.counts().outliers);
        EXPECT_EQ(filter->counts().windups, typed.counts().windups);
        EXPECT_EQ(filter->counts().changes, typed.counts().changes);
        EXPECT_EQ(filter->counts().unusable, typed.counts().unusable);
        EXPECT_GT(filter->counts().outliers + filter->counts().unusable, 0);
    }
    filter->reset();
    EXPECT_EQ(state_bytes_of(*filter), state_bytes_of(start));
}

TEST(Native, AComposedFilterKeepsItsVariantsName) {
    std::string name = "ud";
    auto const filter = native::make(name, "double", {.size = 2, .guard = "reset"});
    name = "qr";  // a caller's text may be gone when the filter starts anew
    filter->reset();
    EXPECT_EQ(filter->variant(), "ud");
    EXPECT_TRUE(filter->reports_covariance());
}

template <class T>
class NativeCompositions : public testing::Test {};
using Both = testing::Types<float, double>;
TYPED_TEST_SUITE(NativeCompositions, Both);

template <class T>
Problem<T> problem(double forgetting) {
    return {.size = d, .forgetting = T(forgetting), .prior = Prior<T>{.variance = T(64)}};
}
template <class T>
std::unique_ptr<Filter> made(std::string_view variant, Options options) {
    options.size = d;
    options.prior_variance = 64;
    return native::make(variant, ArithmeticTraits<T>::name, options);
}

TYPED_TEST(NativeCompositions, Guards) {
    using T = TypeParam;
    auto const p = problem<T>(0.98);
    expect_alike(Guarded<Ud<T>, reporting>(p), made<T>("ud", {.forgetting = 0.98, .guard = "report"}));
    expect_alike(Guarded<Ud<T>, resetting>(p), made<T>("ud", {.forgetting = 0.98, .guard = "reset"}));
    expect_alike(Guarded<Conventional<T>, rebuilding>(p),
                 made<T>("conventional", {.forgetting = 0.98, .guard = "rebuild"}));
    expect_alike(Guarded<Qr<T>, resetting>(p), made<T>("qr", {.forgetting = 0.98, .guard = "reset"}));
    expect_alike(Guarded<Information<T>, resetting>(p), made<T>("information", {.forgetting = 0.98, .guard = "reset"}));
    expect_alike(
        Guarded<Gentleman<T>, resetting>(p, {.largest_variance = T(100), .innovation = T(4), .noise_memory = 50}),
        made<T>("gentleman",
                {.forgetting = 0.98, .guard = "reset", .largest_variance = 100, .innovation = 4, .noise_memory = 50}));
}
TYPED_TEST(NativeCompositions, Windows) {
    using T = TypeParam;
    expect_alike(Windowed<Ud<T>>(problem<T>(1), {.rows = 20}), made<T>("ud", {.window = 20}));
    expect_alike(Windowed<Qr<T>>(problem<T>(0.99), {.rows = 20}), made<T>("qr", {.forgetting = 0.99, .window = 20}));
    expect_alike(Windowed<Symmetric<T>>(problem<T>(1), {.rows = 33}), made<T>("symmetric", {.window = 33}));
    Windowed<Ud<T>> const window(problem<T>(1), {.rows = 20});
    expect_alike(Guarded<Windowed<Ud<T>>, resetting>(window, problem<T>(1)),
                 made<T>("ud", {.window = 20, .guard = "reset"}));
}
TYPED_TEST(NativeCompositions, Rules) {
    using T = TypeParam;
    auto const p = problem<T>(1), below = problem<T>(0.99);
    double const kulhavy[] = {0.95, 0.5}, fortescue[] = {0.02}, ridge[] = {0.01}, reset[] = {50}, walk[] = {0.001};
    expect_alike(Forgetting<Ud<T>, Kulhavy<T>>(p, {.forgetting = T(0.95), .least_excitation = T(0.5)}),
                 made<T>("ud", {.control = "kulhavy", .control_numbers = kulhavy}));
    expect_alike(Forgetting<Qr<T>, CaoSchwartz<T>>(p, {.forgetting = T(0.95), .least_excitation = T(0.5)}),
                 made<T>("qr", {.control = "cao_schwartz", .control_numbers = kulhavy}));
    expect_alike(Forgetting<Gentleman<T>, Kulhavy<T>>(p), made<T>("gentleman", {.control = "kulhavy"}));
    expect_alike(Forgetting<Potter<T>, Fortescue<T>>(p, {.noise_variance = T(0.02)}),
                 made<T>("potter", {.control = "fortescue", .control_numbers = fortescue}));
    expect_alike(Forgetting<Conventional<T>, RotatingRidge<T>>(below, {.ridge = T(0.01)}),
                 made<T>("conventional", {.forgetting = 0.99, .control = "ridge", .control_numbers = ridge}));
    expect_alike(Forgetting<Qr<T>, CovarianceReset<T>>(p, {.period = 50, .variance = T(64)}),
                 made<T>("qr", {.control = "reset", .control_numbers = reset}));
    expect_alike(Forgetting<Carlson<T>, RandomWalk<T>>(p, {.variance = T(0.001)}),
                 made<T>("carlson", {.control = "random_walk", .control_numbers = walk}));
    expect_alike(Kalman<T>(p, Matrix<T>(Matrix<T>::Identity(d, d) * T(0.001))),
                 made<T>("kalman", {.control = "random_walk", .control_numbers = walk}));
    expect_alike(Guarded<Forgetting<Ud<T>, Kulhavy<T>>, resetting>(
                     Forgetting<Ud<T>, Kulhavy<T>>(p, {.forgetting = T(0.95), .least_excitation = T(0.5)}), p),
                 made<T>("ud", {.guard = "reset", .control = "kulhavy", .control_numbers = kulhavy}));
    expect_alike(Ud<T>(p), made<T>("ud", {.control = "constant"}));
}
TYPED_TEST(NativeCompositions, ManyRowsAreThoseOneByOne) {
    using T = TypeParam;
    Matrix<T> const psi = records().psi.cast<T>();
    Vector<T> const y = records().y.cast<T>();
    auto const a = made<T>("qr", {.window = 20, .guard = "reset"}), b = a->clone();
    std::vector<native::Step> steps(std::size_t(y.size()));
    a->update_many(psi.data(), y.size(), 0, y.data(), nullptr);
    b->update_many(psi.data(), y.size(), 0, y.data(), steps.data());
    EXPECT_EQ(state_bytes_of(*a), state_bytes_of(*b));
    EXPECT_EQ(std::ranges::count(steps, std::int32_t(GuardSignal::outlier), &native::Step::signal) +
                  std::ranges::count(steps, std::int32_t(GuardSignal::change), &native::Step::signal),
              a->counts().outliers);
}
TYPED_TEST(NativeCompositions, TimePassesAsInTheType) {
    using T = TypeParam;
    Guarded<Ud<T>> typed(problem<T>(0.9));
    auto const filter = made<T>("ud", {.forgetting = 0.9, .guard = "reset"});
    for (int k = 0; k < 100; ++k) typed.pass_time(), filter->pass_time();
    EXPECT_EQ(state_bytes_of(typed), state_bytes_of(*filter));
    EXPECT_EQ(filter->counts().windups, typed.counts().windups);
    EXPECT_GT(filter->counts().windups, 0);
}
TEST(NativeCompositions, StatesOfOtherCompositionsAreRefused) {
    auto const ud = made<double>("ud", {}), guarded = made<double>("ud", {.guard = "reset"});
    auto const reported = made<double>("ud", {.guard = "report"}), window = made<double>("ud", {.window = 20});
    auto const refused = [](Filter& f, Filter const& from) {
        try {
            f.load(state_bytes_of(from));
        } catch (std::invalid_argument const& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(refused(*ud, *guarded), HasSubstr("of other options"));
    EXPECT_THAT(refused(*guarded, *ud), HasSubstr("of other options"));
    EXPECT_THAT(refused(*guarded, *reported), HasSubstr("of other options"));
    EXPECT_THAT(refused(*window, *made<double>("ud", {.window = 21})), HasSubstr("of other options"));
    EXPECT_THAT(refused(*guarded, *made<double>("qr", {.guard = "reset"})),
                HasSubstr("of another variant: qr in double"));
    EXPECT_THAT(refused(*guarded, *made<float>("ud", {.guard = "reset"})), HasSubstr("of another arithmetic"));
    EXPECT_EQ(refused(*guarded, *made<double>("ud", {.guard = "reset"})), "");
}

TEST(NativeCompositions, TheLabsAreSavedAndLoaded) {
    Problem<double> const p{.size = d, .forgetting = 1, .prior = Prior<double>{.variance = 64}};
    for (std::string_view const arithmetic : {"float", "double", "reference"}) {
        Composition const window_and_guard{.window = 20, .guard = "reset"};
        auto const a = composed(window_and_guard, "ud", arithmetic, p),
                   b = composed(window_and_guard, "ud", arithmetic, p);
        a->update_block(records(), 0, 100);
        b->load(a->saved());
        EXPECT_EQ(a->saved(), b->saved());
        a->update_block(records(), 100, 200);
        b->update_block(records(), 100, 200);
        EXPECT_EQ(a->saved(), b->saved());
        EXPECT_EQ(a->noise_variance(), b->noise_variance());
        EXPECT_THROW(b->load(composed({.window = 20}, "ud", arithmetic, p)->saved()), InputError);
    }
}

TYPED_TEST(NativeCompositions, FleetsHaveTheBitsOfTheType) {
    using T = TypeParam;
    constexpr Index filters = 19;
    rlslab::Fleet<Ud<Pack<T, 8>>> typed(filters, problem<T>(0.98));
    auto const fleet = native::make_fleet("ud", ArithmeticTraits<T>::name, filters,
                                          {.size = d, .forgetting = 0.98, .prior_variance = 64});
    EXPECT_EQ(fleet->filters(), filters);
    EXPECT_EQ(fleet->size(), d);
    Matrix<T> psi(filters, d);
    Vector<T> y(filters);
    Seed seed{4};
    for (int k = 0; k < 40; ++k) {
        for (T& x : psi.reshaped()) x = T(seed.bell());
        for (T& x : y) x = T(seed.bell());
        if (k == 20) y[3] = std::numeric_limits<T>::quiet_NaN();
        Matrix<T> const by_filter = psi.transpose();
        EXPECT_EQ(fleet->update(by_filter.data(), y.data()), typed.update(psi, y));
    }
    std::vector<std::byte> state(fleet->state_size());
    fleet->save(state);
    EXPECT_EQ(state, state_bytes_of(typed));
    std::vector<double> theta(d);
    for (Index m = 0; m < filters; ++m) {
        fleet->theta(m, theta.data());
        for (Index i = 0; i < d; ++i) EXPECT_EQ(theta[std::size_t(i)], double(typed.theta(m)[i]));
        EXPECT_EQ(fleet->health(m), std::int32_t(typed.health(m)));
    }
    auto const copy = fleet->clone();
    copy->reset(2);
    typed.reset(2);
    copy->save(state);
    EXPECT_EQ(state, state_bytes_of(typed));
    fleet->load(state);
    EXPECT_THROW(fleet->load(std::span(state).first(20)), std::invalid_argument);
    EXPECT_THROW(fleet->theta(filters, theta.data()), std::invalid_argument);
}
TEST(NativeCompositions, FleetsOfWhatHasNoneAreRefused) {
    auto const refused = [](std::string_view variant, Index filters, Options const& options) {
        try {
            native::make_fleet(variant, "double", filters, options);
        } catch (std::invalid_argument const& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(refused("qr_block", 9, {.size = 2}), HasSubstr("no fleet"));
    EXPECT_THAT(refused("ud", 0, {.size = 2}), HasSubstr("at least one"));
    EXPECT_THAT(refused("ud", 9, {.size = 2, .guard = "reset"}), HasSubstr("plain variants"));
    EXPECT_THAT(refused("u", 9, {.size = 2}), HasSubstr("no variant"));
    for (std::string_view const variant : native::variants())
        EXPECT_EQ(refused(variant, 9, {.size = 2}).empty(), variant != "qr_block") << variant;
}

std::string refusal_of_state(std::span<std::byte const> state) {
    try {
        native::from_state(state);
    } catch (std::invalid_argument const& error) {
        return error.what();
    }
    return "";
}
TEST(NativeFromState, WhatHasNoNameIsRefusedInOneLine) {
    constexpr GuardPolicy unnamed{Action::skip, Action::report, Action::report, Action::report};
    Problem<double> const p{.size = 2};
    EXPECT_THAT(refusal_of_state({}), HasSubstr("not a state"));
    EXPECT_THAT(refusal_of_state(state_of(Ud<Quad>({.size = 2}))), HasSubstr("ud in quad"));
    EXPECT_THAT(refusal_of_state(state_of(Assessed<Ud<double>>(p))), HasSubstr("\"assessed\" around ud"));
    EXPECT_THAT(refusal_of_state(state_of(Guarded<Ud<double>, unnamed>(p))), HasSubstr("policy has no name"));
    EXPECT_THAT(refusal_of_state(state_of(Forgetting<Ud<double>, RotatingRidge<double>>(p, {.toward_zero = true}))),
                HasSubstr("other options"));
    EXPECT_THAT(refusal_of_state(state_of(Windowed<Ud<double>>(p, {.rows = 9, .worse = 3}))),
                HasSubstr("other options"));
    EXPECT_THAT(refusal_of_state(state_bytes_of(*native::make_fleet("ud", "double", 3, {.size = 2}))),
                HasSubstr("fleet"));
}
TEST(NativeFromState, AWalkOfKalmansOwnIsAmongItsNumbers) {
    double const variance[] = {0.25}, psi[] = {1, 2};
    auto const filter =
        native::make("kalman", "double", {.size = 2, .control = "random_walk", .control_numbers = variance});
    filter->update(psi, 1.0);
    auto const found = native::from_state(state_bytes_of(*filter));
    filter->update(psi, 2.0);
    found->update(psi, 2.0);
    EXPECT_EQ(state_bytes_of(*found), state_bytes_of(*filter));
}
/// Whatever a byte of header and entries is changed to, with the checksum made right: a filter, or one line.
TEST(NativeFromState, ForgedBytesAskForNoMemory) {
    double const number[] = {0.9};
    for (Options const& options :
         {Options{.size = 2, .window = 9, .guard = "reset"},
          Options{.size = 2, .guard = "rebuild", .control = "kulhavy", .control_numbers = number}}) {
        std::vector<std::byte> const whole = state_bytes_of(*native::make("ud", "float", options));
        std::size_t const first = StateHeader::size + entries_in(whole).size();
        for (std::size_t at = 8; at < first; ++at)
            for (int const change : {1, 0x40, 0x80, 0xff}) {
                std::vector<std::byte> forged = whole;
                forged[at] ^= std::byte(change);
                Checksum sum;
                sum.add(std::span(forged).first(forged.size() - StateHeader::checksum));
                detail::write_low(sum.value(), StateHeader::checksum,
                                  forged.data() + forged.size() - StateHeader::checksum);
                std::string const why = refusal_of_state(forged);
                EXPECT_EQ(why.find('\n'), std::string::npos);
            }
    }
}

}  // namespace
}  // namespace rlslab
