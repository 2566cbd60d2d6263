// Complex filters by the C interface: the bytes of rlslab::ComplexFleet by its type, and what is refused.
#include "tests/capi/filters.hpp"

#include <rlslab/many/complex_fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace rlslab::c {
namespace {

using testing::HasSubstr;

constexpr std::size_t d = 3, M = 10, rows = 40;

struct FreeComplex {
    void operator()(rlslab_complex* filter) const { rlslab_complex_free(filter); }
};
using Handle = std::unique_ptr<rlslab_complex, FreeComplex>;
Handle made(char const* variant, char const* arithmetic, std::size_t m, std::size_t filters = M) {
    rlslab_options const options = options_of(d, 0.98);
    rlslab_complex* out = nullptr;
    rlslab_complex_new(variant, arithmetic, filters, m, &options, &out);
    return Handle(out);
}
std::vector<std::byte> state_of(rlslab_complex const* filter) {
    std::vector<std::byte> out(rlslab_complex_state_size(filter));
    EXPECT_EQ(rlslab_complex_save(filter, out.data(), out.size()), RLSLAB_OK);
    return out;
}

template <class F>
void expect_the_bytes_of(std::size_t m) {
    using Fleet = ComplexFleet<F>;
    using T = typename Fleet::real;
    SCOPED_TRACE(std::string(F::name));
    auto const psi = numbers<T>(2 * rows * M * d, 5), y = numbers<T>(2 * rows * M * m, 6);
    Fleet fleet(Index(M), {.size = Index(d), .forgetting = T(0.98)}, Index(m));
    std::vector<Complex<T>> innovation(M * m);
    auto const as_complex = [](std::vector<T> const& x, std::size_t from) {
        return reinterpret_cast<Complex<T> const*>(x.data() + from);
    };
    for (std::size_t k = 0; k < rows; ++k)
        fleet.update(as_complex(psi, 2 * k * M * d), as_complex(y, 2 * k * M * m), {.innovation = innovation.data()});

    Handle const filter = made(F::name.data(), ArithmeticTraits<T>::name.data(), m);
    ASSERT_NE(filter, nullptr) << rlslab_message();
    std::vector<double> steps(2 * rows * M * m), theta(2 * M * d * m), P(2 * d * d);
    rlslab_complex_steps const to{steps.data(), nullptr, nullptr, nullptr};
    std::size_t missing = 7;
    if constexpr (std::same_as<T, float>) {
        EXPECT_EQ(rlslab_complex_update_f32(filter.get(), psi.data(), y.data(), rows, &to, &missing), RLSLAB_OK);
    } else {
        EXPECT_EQ(rlslab_complex_update(filter.get(), psi.data(), y.data(), rows, &to, &missing), RLSLAB_OK);
    }
    EXPECT_EQ(missing, 0u);
    EXPECT_EQ(state_of(filter.get()), rlslab::state_of(fleet));
    EXPECT_EQ(steps[steps.size() - 1], double(innovation.back().im));
    ASSERT_EQ(rlslab_complex_theta(filter.get(), theta.data()), RLSLAB_OK);
    EXPECT_EQ(theta[2 * ((4 * d + 1) * m)], double(fleet.theta(4, 1, 0).re));
    EXPECT_EQ(theta.back(), double(fleet.theta(Index(M) - 1, Index(d) - 1, Index(m) - 1).im));
    constexpr bool covariance = ReportsCovariance<F>;
    EXPECT_EQ(rlslab_complex_covariance(filter.get(), 9, P.data()), covariance ? RLSLAB_OK : RLSLAB_ABILITY);
    EXPECT_EQ(rlslab_complex_information(filter.get(), 9, P.data()), covariance ? RLSLAB_ABILITY : RLSLAB_OK);
    EXPECT_EQ(P[2 * d], double(fleet.matrix(9)(0, 1).re));
    EXPECT_EQ(P[2 * d + 1], double(fleet.matrix(9)(0, 1).im));
    EXPECT_EQ(rlslab_complex_health(filter.get(), 3), 0);

    rlslab_complex* copied = nullptr;
    ASSERT_EQ(rlslab_complex_copy(filter.get(), &copied), RLSLAB_OK);
    Handle const copy(copied);
    EXPECT_EQ(rlslab_complex_reset(copy.get()), RLSLAB_OK);
    EXPECT_NE(state_of(copy.get()), state_of(filter.get()));
    auto const state = state_of(filter.get());
    EXPECT_EQ(rlslab_complex_load(copy.get(), state.data(), state.size()), RLSLAB_OK);
    EXPECT_EQ(state_of(copy.get()), state);
}

TEST(ComplexOfC, LeavesTheBytesOfCpp) {
    expect_the_bytes_of<Ud<Complex<Pack<float, 8>>>>(2);
    expect_the_bytes_of<Symmetric<Complex<Pack<double, 8>>>>(1);
    expect_the_bytes_of<Gentleman<Complex<Pack<double, 8>>>>(1);
}
TEST(ComplexOfC, RefusesInALine) {
    rlslab_options options = options_of(d);
    rlslab_complex* out = nullptr;
    EXPECT_EQ(rlslab_complex_new("ut", "double", M, 1, &options, &out), RLSLAB_NAME);
    EXPECT_EQ(rlslab_complex_new("qr_block", "double", M, 1, &options, &out), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_complex_new("qr", "double", M, 2, &options, &out), RLSLAB_INVALID);
    EXPECT_THAT(rlslab_message(), HasSubstr("one output"));
    EXPECT_EQ(rlslab_complex_new("ud", "double", 0, 1, &options, &out), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_complex_new("ud", "double", 1, 0, &options, &out), RLSLAB_INVALID);
    options.guard = "reset";
    EXPECT_EQ(rlslab_complex_new("ud", "double", 1, 1, &options, &out), RLSLAB_INVALID);
    EXPECT_THAT(rlslab_message(), HasSubstr("plain variant"));
    options = options_of(d);
    double const theta[d] = {1, 2, 3};
    options.prior_theta = theta;
    EXPECT_EQ(rlslab_complex_new("ud", "double", 1, 1, &options, &out), RLSLAB_INVALID);
    EXPECT_EQ(out, nullptr);
    EXPECT_NE(rlslab_complex_new("ud", "double", std::numeric_limits<std::size_t>::max(), 1, &options, &out),
              RLSLAB_OK);
    EXPECT_EQ(rlslab_complex_new("ud", "double", 1, 1, nullptr, &out), RLSLAB_NULL);

    Handle const filter = made("ud", "double", 1, 1);
    double const psi[2 * d] = {1, 2, 3, 4, 5, std::numeric_limits<double>::infinity()}, y[2] = {1, 1};
    auto const before = state_of(filter.get());
    std::size_t missing = 0;
    EXPECT_EQ(rlslab_complex_update(filter.get(), psi, y, 1, nullptr, &missing), RLSLAB_OK);
    EXPECT_EQ(missing, 1u);
    EXPECT_EQ(rlslab_complex_update(filter.get(), nullptr, nullptr, 0, nullptr, nullptr), RLSLAB_OK);
    EXPECT_EQ(rlslab_complex_update(filter.get(), nullptr, y, 1, nullptr, nullptr), RLSLAB_NULL);
    EXPECT_EQ(rlslab_complex_update(filter.get(), psi, y, std::numeric_limits<std::size_t>::max(), nullptr, nullptr),
              RLSLAB_INVALID);
    double P[2 * d * d];
    EXPECT_EQ(rlslab_complex_covariance(filter.get(), 1, P), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_complex_health(filter.get(), 1), -1);
    std::byte few[4] = {};
    EXPECT_EQ(rlslab_complex_save(filter.get(), few, sizeof few), RLSLAB_ROOM);
    EXPECT_EQ(rlslab_complex_load(filter.get(), few, sizeof few), RLSLAB_STATE);
    EXPECT_EQ(state_of(filter.get()), before);
    EXPECT_EQ(rlslab_complex_health(nullptr, 0), -1);
    EXPECT_EQ(rlslab_complex_size(nullptr) + rlslab_complex_filters(nullptr) + rlslab_complex_outputs(nullptr), 0u);
    rlslab_complex_free(nullptr);
}

}  // namespace
}  // namespace rlslab::c
