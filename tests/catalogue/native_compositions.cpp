// Compositions by name have the bits, the states and the counts of the C++ types, in the native layer and in the lab's.
#include <rlslab/catalogue/composed.hpp>
#include "tests/catalogue/by_name.hpp"

#include <rlslab/adapt/certified.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/arithmetic/quad.hpp>
#include <rlslab/core/input_error.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <gmock/gmock.h>

namespace rlslab {
namespace {

using namespace by_name;
using native::Filter;
using native::Options;
using testing::HasSubstr;

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
std::unique_ptr<Filter> made(std::string_view variant, Options options) {
    options.size = d;
    options.prior_variance = 64;
    return native::make(variant, ArithmeticTraits<T>::name, options);
}

TYPED_TEST(NativeCompositions, Guards) {
    using T = TypeParam;
    auto const p = problem<T>(0.98);
    auto const guard = [](std::string_view policy) { return Options{.forgetting = 0.98, .guard = policy}; };
    expect_alike(Guarded<Ud<T>, reporting>(p), guard("report"));
    expect_alike(Guarded<Ud<T>, resetting>(p), guard("reset"));
    expect_alike(Guarded<Conventional<T>, rebuilding>(p), guard("rebuild"));
    expect_alike(Guarded<Qr<T>, resetting>(p), guard("reset"));
    expect_alike(Guarded<Information<T>, resetting>(p), guard("reset"));
    Options of_numbers = guard("reset");
    of_numbers.largest_variance = 100, of_numbers.innovation = 4, of_numbers.noise_memory = 50;
    expect_alike(
        Guarded<Gentleman<T>, resetting>(p, {.largest_variance = T(100), .innovation = T(4), .noise_memory = 50}),
        of_numbers);
}
TYPED_TEST(NativeCompositions, Windows) {
    using T = TypeParam;
    auto const p = problem<T>(1);
    expect_alike(Windowed<Ud<T>>(p, {.rows = 20}), {.window = 20});
    expect_alike(Windowed<Qr<T>>(problem<T>(0.99), {.rows = 20}), {.forgetting = 0.99, .window = 20});
    expect_alike(Windowed<Symmetric<T>>(p, {.rows = 33}), {.window = 33});
    expect_alike(Guarded<Windowed<Ud<T>>, resetting>(Windowed<Ud<T>>(p, {.rows = 20}), p),
                 {.window = 20, .guard = "reset"});
}
TYPED_TEST(NativeCompositions, Rules) {
    using T = TypeParam;
    auto const p = problem<T>(1), below = problem<T>(0.99);
    static double const kulhavy[] = {0.95, 0.5}, fortescue[] = {0.02, 50, 0.25}, ridge[] = {0.01}, reset[] = {50, 64},
                        walk[] = {0.001};
    auto const ruled = [](std::string_view rule, std::span<double const> numbers, double forgetting = 1) {
        return Options{.forgetting = forgetting, .control = rule, .control_numbers = numbers};
    };
    using K = Kulhavy<T>;
    K const by_kulhavy{.forgetting = T(0.95), .least_excitation = T(0.5)};
    expect_alike(Forgetting<Ud<T>, K>(p, by_kulhavy), ruled("kulhavy", kulhavy));
    expect_alike(Forgetting<Qr<T>, CaoSchwartz<T>>(p, {.forgetting = T(0.95), .least_excitation = T(0.5)}),
                 ruled("cao_schwartz", kulhavy));
    expect_alike(Forgetting<Potter<T>, Fortescue<T>>(p, {.noise_variance = T(0.02), .memory = T(50), .least = T(0.25)}),
                 ruled("fortescue", fortescue));
    expect_alike(Forgetting<Conventional<T>, RotatingRidge<T>>(below, {.ridge = T(0.01)}), ruled("ridge", ridge, 0.99));
    expect_alike(Forgetting<Qr<T>, CovarianceReset<T>>(p, {.period = 50, .variance = T(64)}), ruled("reset", reset));
    expect_alike(Forgetting<Carlson<T>, RandomWalk<T>>(p, {.variance = T(0.001)}), ruled("random_walk", walk));
    expect_alike(Kalman<T>(p, Matrix<T>(Matrix<T>::Identity(d, d) * T(0.001))), ruled("random_walk", walk));
    Options guarded = ruled("kulhavy", kulhavy);
    guarded.guard = "reset";
    expect_alike(Guarded<Forgetting<Ud<T>, K>, resetting>(Forgetting<Ud<T>, K>(p, by_kulhavy), p), guarded);
    expect_alike(Ud<T>(p), ruled("constant", {}));
}
template <class F, class T = typename F::scalar>
void expect_certificate_alike(F typed, std::string_view variant, int rows) {
    auto const filter = made<T>(variant, {.forgetting = 0.98, .certify = F::probe_count});
    EXPECT_EQ(filter->probes(), F::probe_count);
    for (Index k = 0; k < rows; ++k) {
        Vector<double> const psi = records().psi.col(k);
        filter->update(psi.data(), records().y[k]);
        typed.update(Vector<T>(psi.cast<T>()), T(records().y[k]));
    }
    auto const before = saved(*filter);
    native::Certificate const found = filter->certificate(), of_state = native::from_state(before)->certificate();
    auto const expected = typed.certificate();
    EXPECT_EQ(found.estimate, expected.estimate) << variant;
    EXPECT_EQ(found.bound, expected.bound) << variant;
    EXPECT_EQ(found.theta, expected.theta) << variant;
    EXPECT_TRUE(found.definite && expected.definite) << variant;
    EXPECT_EQ(of_state.bound, found.bound) << variant;
    EXPECT_EQ(saved(*filter), before) << variant << ": the filter stays as it was";
}
TYPED_TEST(NativeCompositions, Probes) {
    using T = TypeParam;
    auto const p = problem<T>(0.98);
    expect_alike(Certified<Ud<T>>(p), {.forgetting = 0.98, .certify = 3});
    expect_alike(Certified<Information<T>, 1>(p), {.forgetting = 0.98, .certify = 1});
    using C = Certified<Ud<T>, 2>;
    expect_alike(Guarded<Windowed<C>, rebuilding>(Windowed<C>(p, {.rows = 20}), p),
                 {.forgetting = 0.98, .window = 20, .guard = "rebuild", .certify = 2});
    TypedAs asked(Guarded<C, rebuilding>(p, {.digits = 6}));  // which is not in a state
    auto const by_name = made<T>("ud", {.forgetting = 0.98, .guard = "rebuild", .certify = 2, .digits = 6});
    for (Index k = 0; k < records().rows(); ++k) {
        by_name->update(records().psi.col(k).data(), records().y[k]);
        asked.update(records().psi.col(k), records().y[k]);
    }
    EXPECT_EQ(saved(*by_name), asked.saved());
    EXPECT_EQ(by_name->counts().breakdowns > 0, (std::same_as<T, float>));
    static double const fortescue[] = {0.02, 50, 0.25};
    expect_alike(
        Forgetting<C, Fortescue<T>>(problem<T>(1), {.noise_variance = T(0.02), .memory = T(50), .least = T(0.25)}),
        {.control = "fortescue", .control_numbers = fortescue, .certify = 2});
    expect_certificate_alike(Certified<Ud<T>>(p), "ud", 200);
    expect_certificate_alike(Certified<Qr<T>, 6>(p), "qr", 200);
    expect_certificate_alike(Certified<Information<T>, 1>(p), "information", 200);
    expect_certificate_alike(Certified<Carlson<T>, 4>(p), "carlson", 200);
    expect_certificate_alike(Certified<Gentleman<T>, 5>(p), "gentleman", 200);
    expect_certificate_alike(Certified<Joseph<T>, 2>(p), "joseph", 200);
}
TEST(NativeCompositions, ProbesGoAroundEveryFormOrSayWhyNot) {
    int certified = 0;
    for (std::string_view const variant : native::variants()) {
        try {
            auto const f = made<float>(variant, {.window = 30, .guard = "reset", .certify = 3});
            f->update_many(records().psi.data(), 80, 0, records().y.data(), nullptr);
            EXPECT_LT(f->certificate().bound, 1) << variant;
            ++certified;
        } catch (std::invalid_argument const& error) {
            EXPECT_THAT(error.what(), HasSubstr("probes")) << variant;
        }
    }
    EXPECT_EQ(certified, 15);
    EXPECT_THROW(made<double>("ud", {.certify = 7}), std::invalid_argument);
    EXPECT_THROW(made<double>("ud", {.certify = -1}), std::invalid_argument);
    for (Index const digits : {-1, 4, 15, 1000000})  // 4: without a guard
        EXPECT_THROW(made<double>("ud", {.guard = digits == 4 ? "" : "reset", .certify = 3, .digits = digits}),
                     std::invalid_argument);
    EXPECT_THROW(made<double>("ud", {.guard = "reset", .digits = 4}), std::invalid_argument);
    EXPECT_THROW(made<double>("ud", {.digits = 4}), std::invalid_argument);
    EXPECT_THROW(made<double>("ud", {})->certificate(), std::invalid_argument);
    EXPECT_EQ(made<double>("ud", {.guard = "reset"})->probes(), 0);
    auto const probed = made<double>("ud", {.certify = 2}), more = made<double>("ud", {.certify = 3});
    EXPECT_THROW(probed->load(saved(*more)), std::invalid_argument);
}
TEST(NativeCompositions, NumbersThatAreLeftOutHaveTheirDefaults) {
    static double const period[] = {50};
    auto const p = problem<double>(1);
    EXPECT_EQ(saved(*made<double>("qr", {.control = "reset", .control_numbers = period})),
              TypedAs(Forgetting<Qr<double>, CovarianceReset<double>>(p, {.period = 50, .variance = 64})).saved());
    EXPECT_EQ(saved(*made<double>("gentleman", {.control = "kulhavy"})),
              TypedAs(Forgetting<Gentleman<double>, Kulhavy<double>>(p)).saved());
}
TYPED_TEST(NativeCompositions, TimePassesAsInTheType) {
    using T = TypeParam;
    Guarded<Ud<T>> typed(problem<T>(0.9));
    auto const filter = made<T>("ud", {.forgetting = 0.9, .guard = "reset"});
    for (int k = 0; k < 100; ++k) typed.pass_time(), filter->pass_time();
    EXPECT_EQ(state_of(typed), saved(*filter));
    EXPECT_EQ(filter->counts().windups, typed.counts().windups);
    EXPECT_GT(filter->counts().windups, 0);
}
TEST(NativeCompositions, StatesOfOtherCompositionsAreRefused) {
    auto const ud = made<double>("ud", {}), guarded = made<double>("ud", {.guard = "reset"});
    auto const reported = made<double>("ud", {.guard = "report"}), window = made<double>("ud", {.window = 20});
    auto const refused = [](Filter& f, Filter const& from) {
        try {
            f.load(saved(from));
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
    EXPECT_EQ(state, state_of(typed));
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
    EXPECT_EQ(state, state_of(typed));
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
    EXPECT_EQ(refused("ud", 9, {.size = 2, .guard = "reset"}), "");
    EXPECT_THAT(refused("ud", 0, {.size = 2, .guard = "reset"}), HasSubstr("at least one"));
    EXPECT_THAT(refused("ud", 9, {.size = 2, .window = 5, .control = "kulhavy"}), HasSubstr("takes rows back"));
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
    auto const fleet = native::make_fleet("ud", "double", 3, {.size = 2});
    std::vector<std::byte> state(fleet->state_size());
    fleet->save(state);
    EXPECT_THAT(refusal_of_state(state), HasSubstr("fleet"));
}
TEST(NativeFromState, AWalkOfKalmansOwnIsAmongItsNumbers) {
    double const variance[] = {0.25}, psi[] = {1, 2};
    auto const filter =
        native::make("kalman", "double", {.size = 2, .control = "random_walk", .control_numbers = variance});
    filter->update(psi, 1.0);
    auto const found = native::from_state(saved(*filter));
    filter->update(psi, 2.0);
    found->update(psi, 2.0);
    EXPECT_EQ(saved(*found), saved(*filter));
}
/// Whatever a byte of header and entries is changed to, with the checksum made right: a filter, or one line.
TEST(NativeFromState, ForgedBytesAskForNoMemory) {
    double const number[] = {0.9};
    for (Options const& options :
         {Options{.size = 2, .window = 9, .guard = "reset"},
          Options{.size = 2, .guard = "rebuild", .control = "kulhavy", .control_numbers = number}}) {
        std::vector<std::byte> const whole = saved(*native::make("ud", "float", options));
        StateHeader header;
        ASSERT_EQ(StateHeader::read(whole, header), StateFault::none);
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
