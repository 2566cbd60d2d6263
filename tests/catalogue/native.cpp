// The native layer has the bits of the C++ types, takes rows in place, and exchanges states with them.
#include "tests/catalogue/by_name.hpp"

#include <rlslab/variants/variants.hpp>

#include <gmock/gmock.h>

namespace rlslab {
namespace {

using namespace by_name;
using native::Options;

template <class T>
void expect_each_variant_alike() {
    for_each(Variants<T>{}, []<class F>() { expect_alike(F(problem<T>(0.98)), {.forgetting = 0.98}); });
}
TEST(Native, HasTheBitsOfTheTypesInFloat) { expect_each_variant_alike<float>(); }
TEST(Native, HasTheBitsOfTheTypesInDouble) { expect_each_variant_alike<double>(); }

TEST(Native, PriorsAreTheProblems) {
    double const theta[] = {1, -2}, P0[] = {4, 1, 1, 9};
    Prior<double> prior{.variance = 5, .theta = Vector<double>{{1, -2}}};
    auto filter = native::make("ud", "double", {.size = 2, .prior_variance = 5, .prior_theta = theta});
    EXPECT_EQ(saved(*filter), state_of(Ud<double>({.size = 2, .prior = prior})));
    prior.covariance = Matrix<double>{{4, 1}, {1, 9}};
    filter =
        native::make("ud", "double", {.size = 2, .prior_variance = 5, .prior_theta = theta, .prior_covariance = P0});
    EXPECT_EQ(saved(*filter), state_of(Ud<double>({.size = 2, .prior = prior})));
    filter = native::make("qr", "float", {.size = 2, .prior_variance = 0});
    double const psi[] = {1, 2};
    EXPECT_EQ(filter->update(psi, 1.0).health, std::int32_t(Health::undetermined));
    EXPECT_FALSE(native::make("qr", "float", {.size = 2, .prior_variance = 0})->update(psi, 1.0).sound());
}

std::string refusal_of(std::string_view variant, std::string_view arithmetic, Options const& options) {
    return refusal([&] { native::make(variant, arithmetic, options); });
}
TEST(Native, WhatIsNoFilterIsRefusedInOneLine) {
    using testing::HasSubstr;
    double const numbers[] = {0.95, 0.5, 7}, theta[] = {0, 0}, lopsided[] = {1, 2, 3, 4};
    Options const two{.size = 2};
    auto const with = [&](auto change) {
        Options out = two;
        change(out);
        return out;
    };
    EXPECT_THAT(refusal_of("udd", "double", two), HasSubstr("no variant \"udd\"; there are conventional, "));
    EXPECT_THAT(refusal_of("qr_sparse", "double", two), HasSubstr("no variant"));
    EXPECT_THAT(refusal_of("ud", "half\n", two), HasSubstr("no arithmetic \"half\\x0a\"; there are float, double"));
    EXPECT_THAT(refusal_of("ud", "double", {}), HasSubstr("size >= 1"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.forgetting = 0; })), HasSubstr("0 < forgetting <= 1"));
    EXPECT_THAT(refusal_of("ud", "float", with([](auto& o) { o.forgetting = 1e-60; })), HasSubstr("forgetting"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.prior_variance = -1; })), HasSubstr("prior variance"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.prior_variance = 0; })), HasSubstr("prior"));
    EXPECT_THAT(refusal_of("qr", "double", with([&](auto& o) { o.prior_variance = 0, o.prior_theta = theta; })),
                HasSubstr("beside a prior theta"));
    EXPECT_THAT(refusal_of("ud", "double", with([&](auto& o) { o.prior_covariance = lopsided; })),
                HasSubstr("symmetric"));
    auto const large = with([](auto& o) { o.prior_variance = 1e300; });
    EXPECT_EQ(refusal_of("ud", "double", large), "no error");
    EXPECT_THAT(refusal_of("ud", "float", large), HasSubstr("numbers in the arithmetic's range"));
    EXPECT_THROW(native::make_fleet("ud", "float", 3, large), std::invalid_argument);
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.window = -1; })), HasSubstr("window"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.guard = "rest"; })), HasSubstr("no guard \"rest\""));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.control = "?"; })), HasSubstr("no control \"?\""));
    EXPECT_THAT(refusal_of("ud", "double", with([&](auto& o) { o.control_numbers = numbers; })), HasSubstr("control"));
    EXPECT_THAT(refusal_of("ud", "double", with([&](auto& o) { o.control = "kulhavy", o.control_numbers = numbers; })),
                HasSubstr("at most 2 numbers, found 3"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.control = "fortescue"; })), HasSubstr("VARIANCE"));
    double const beyond[] = {1.5};
    EXPECT_THAT(refusal_of("ud", "double", with([&](auto& o) { o.control = "kulhavy", o.control_numbers = beyond; })),
                HasSubstr("LAMBDA is out of its range"));
    EXPECT_THAT(refusal_of("extended_qr", "double", with([](auto& o) { o.window = 9; })), HasSubstr("shows no state"));
    EXPECT_THAT(refusal_of("qr_block", "double", with([](auto& o) { o.guard = "reset"; })),
                HasSubstr("shows no state"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.window = 9, o.control = "ridge"; })),
                HasSubstr("a window takes rows back"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.guard = "reset", o.asymmetry = -1; })),
                HasSubstr("options"));
    for (std::string_view const guard : native::guards())
        EXPECT_EQ(refusal_of("ud", "float", {.size = 2, .guard = guard}), "no error") << guard;
    for (std::string_view const variant : native::variants())
        for (std::string_view const arithmetic : native::arithmetics())
            EXPECT_EQ(refusal_of(variant, arithmetic, two), "no error") << variant;
    std::vector<std::string_view> listed;
    for_each(Variants<double>{}, [&]<class F>() { listed.push_back(F::name); });
    EXPECT_THAT(native::variants(), testing::ElementsAreArray(listed));
}
TEST(Native, ReportsWhatTheVariantPropagates) {
    double P[4];
    EXPECT_THROW(native::make("qr", "double", {.size = 2})->covariance(P), std::invalid_argument);
    EXPECT_THROW(native::make("ud", "double", {.size = 2})->information(P), std::invalid_argument);
}

TEST(Native, NamesOfHealthAndSignals) {
    EXPECT_EQ(native::name_of_health(2), "indefinite");
    EXPECT_EQ(native::name_of_signal(5), "windup");
}

}  // namespace
}  // namespace rlslab
