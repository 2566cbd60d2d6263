// Guards and rules by name have the bits, the states and the counts of the C++ types, in the native layer and in the
// lab's; fleets. Windows and probes: native_windows.cpp, so that a compiler needs half the memory.
#include "tests/catalogue/by_name.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab {
namespace {

using namespace by_name;
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
TEST(NativeCompositions, NumbersThatAreLeftOutHaveTheirDefaults) {
    static double const period[] = {50};
    auto const p = problem<double>(1);
    EXPECT_EQ(saved(*made<double>("qr", {.control = "reset", .control_numbers = period})),
              state_of(Forgetting<Qr<double>, CovarianceReset<double>>(p, {.period = 50, .variance = 64})));
    EXPECT_EQ(saved(*made<double>("gentleman", {.control = "kulhavy"})),
              state_of(Forgetting<Gentleman<double>, Kulhavy<double>>(p)));
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
        return refusal([&] { native::make_fleet(variant, "double", filters, options); });
    };
    EXPECT_THAT(refused("qr_block", 9, {.size = 2}), HasSubstr("no fleet"));
    EXPECT_THAT(refused("ud", 0, {.size = 2}), HasSubstr("at least one"));
    EXPECT_EQ(refused("ud", 9, {.size = 2, .guard = "reset"}), "no error");
    EXPECT_THAT(refused("ud", 0, {.size = 2, .guard = "reset"}), HasSubstr("at least one"));
    EXPECT_THAT(refused("ud", 9, {.size = 2, .window = 5, .control = "kulhavy"}), HasSubstr("takes rows back"));
    EXPECT_THAT(refused("u", 9, {.size = 2}), HasSubstr("no variant"));
    for (std::string_view const variant : native::variants())
        EXPECT_EQ(refused(variant, 9, {.size = 2}) == "no error", variant != "qr_block") << variant;
}

}  // namespace
}  // namespace rlslab
