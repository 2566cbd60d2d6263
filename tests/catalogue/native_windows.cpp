// Windows and probes by name have the bits, the states and the counts of the C++ types; states of other compositions
// and of no composition.
#include <rlslab/catalogue/composed.hpp>
#include "tests/catalogue/by_name.hpp"

#include <rlslab/adapt/certified.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/arithmetic/quad.hpp>
#include <rlslab/core/input_error.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab {
namespace {

using namespace by_name;
using native::Filter;
using native::Options;
using testing::HasSubstr;

template <class T>
class NativeWindows : public testing::Test {};
using Both = testing::Types<float, double>;
TYPED_TEST_SUITE(NativeWindows, Both);

TYPED_TEST(NativeWindows, AloneAndGuarded) {
    using T = TypeParam;
    auto const p = problem<T>(1);
    expect_alike(Windowed<Ud<T>>(p, {.rows = 20}), {.window = 20});
    expect_alike(Windowed<Qr<T>>(problem<T>(0.99), {.rows = 20}), {.forgetting = 0.99, .window = 20});
    expect_alike(Windowed<Symmetric<T>>(p, {.rows = 33}), {.window = 33});
    expect_alike(Guarded<Windowed<Ud<T>>, resetting>(Windowed<Ud<T>>(p, {.rows = 20}), p),
                 {.window = 20, .guard = "reset"});
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
    EXPECT_EQ(of_state.theta, found.theta) << variant;
    EXPECT_EQ(saved(*filter), before) << variant << ": the filter stays as it was";
}
TYPED_TEST(NativeWindows, AndProbes) {
    using T = TypeParam;
    auto const p = problem<T>(0.98);
    expect_alike(Certified<Ud<T>>(p), {.forgetting = 0.98, .certify = 3});
    expect_alike(Certified<Information<T>, 1>(p), {.forgetting = 0.98, .certify = 1});
    using C = Certified<Ud<T>, 2>;
    expect_alike(Guarded<Windowed<C>, rebuilding>(Windowed<C>(p, {.rows = 20}), p),
                 {.forgetting = 0.98, .window = 20, .guard = "rebuild", .certify = 2});
    Guarded<C, rebuilding> asked(p, {.digits = 6});  // which is not in a state
    auto const by_name = made<T>("ud", {.forgetting = 0.98, .guard = "rebuild", .certify = 2, .digits = 6});
    for (Index k = 0; k < records().rows(); ++k) {
        Vector<double> const psi = records().psi.col(k);
        by_name->update(psi.data(), records().y[k]);
        asked.update(Vector<T>(psi.cast<T>()), T(records().y[k]));
    }
    EXPECT_EQ(saved(*by_name), state_of(asked));
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
TEST(NativeCompositions, StatesOfOtherCompositionsAreRefused) {
    auto const ud = made<double>("ud", {}), guarded = made<double>("ud", {.guard = "reset"});
    auto const reported = made<double>("ud", {.guard = "report"}), window = made<double>("ud", {.window = 20});
    auto const refused = [](Filter& f, Filter const& from) { return refusal([&] { f.load(saved(from)); }); };
    EXPECT_THAT(refused(*ud, *guarded), HasSubstr("of other options"));
    EXPECT_THAT(refused(*guarded, *ud), HasSubstr("of other options"));
    EXPECT_THAT(refused(*guarded, *reported), HasSubstr("of other options"));
    EXPECT_THAT(refused(*window, *made<double>("ud", {.window = 21})), HasSubstr("of other options"));
    EXPECT_THAT(refused(*guarded, *made<double>("qr", {.guard = "reset"})),
                HasSubstr("of another variant: qr in double"));
    EXPECT_THAT(refused(*guarded, *made<float>("ud", {.guard = "reset"})), HasSubstr("of another arithmetic"));
    EXPECT_EQ(refused(*guarded, *made<double>("ud", {.guard = "reset"})), "no error");
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

std::string refusal_of_state(std::span<std::byte const> state) {
    return refusal([&] { native::from_state(state); });
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
