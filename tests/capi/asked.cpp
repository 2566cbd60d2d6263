// Weights, removals, merging, variances, roots, draws and the least excited direction by the C interface: what the
// native layer does, bit for bit, and its refusals by their codes.
#include "tests/capi/filters.hpp"

#include <rlslab/catalogue/native/filter.hpp>

#include <cmath>
#include <cstring>

namespace rlslab::c {
namespace {

using testing::HasSubstr;

constexpr std::size_t d = 4, rows = 60, stride = d + 1;

std::vector<std::byte> state_of(native::Filter const& f) {
    std::vector<std::byte> out(f.state_size());
    f.save(out);
    return out;
}
/// OK or ABILITY, as the native layer answers or throws; the numbers, a NaN for each that was not written, bit for bit.
template <class C, class Native>
void expect_answer(C const& by_c, Native const& by_cpp) {
    std::vector<double> out(rows * d, nan), expected(rows * d, nan);
    std::string const why = files::message_of<std::invalid_argument>([&] { by_cpp(expected.data()); });
    bool const answers = why == "no error";
    EXPECT_EQ(by_c(out.data()), answers ? RLSLAB_OK : RLSLAB_ABILITY) << why;
    if (!answers) {
        EXPECT_EQ(rlslab_message(), why);
    }
    EXPECT_EQ(std::memcmp(out.data(), expected.data(), out.size() * sizeof out[0]), 0) << why;
}

TEST(Asked, IsWhatTheNativeLayerAnswers) {
    auto const psi = numbers(rows * stride, 3), y = numbers(rows, 4);
    auto const psi_f = numbers<float>(rows * stride, 3), y_f = numbers<float>(rows, 4);
    std::vector<double> weights(rows);
    for (std::size_t k = 0; k < rows; ++k) weights[k] = k % 9 == 4 ? 0 : k % 9 == 5 ? -1 : std::abs(y[(k + 7) % rows]);
    std::vector<float> const weights_f(weights.begin(), weights.end());
    int answered = 0;
    for (char const* const guard : {"", "reset"})
        for (std::string_view const variant : native::variants())
            for (std::string_view const arithmetic : native::arithmetics()) {
                rlslab_options options = options_of(d, 0.98);
                if (*guard) options.guard = guard;
                FilterHandle const filter = filter_of(variant.data(), arithmetic.data(), options);
                if (!filter) continue;
                SCOPED_TRACE(std::string(variant) + guard);
                rlslab_filter* const f = filter.get();
                auto const expected =
                    native::make(variant, arithmetic, {.size = d, .forgetting = 0.98, .guard = guard});
                for (std::size_t k = 0; k < rows; ++k) {
                    rlslab_step step;
                    ASSERT_EQ(rlslab_update_weighted(f, &psi[k * stride], y[k], weights[k], &step), RLSLAB_OK);
                    native::Step const other = expected->update(&psi[k * stride], y[k], weights[k]);
                    ASSERT_EQ(std::memcmp(&step, &other, sizeof step), 0) << k;
                }
                rlslab_update_weighted_f32(f, psi_f.data(), y_f[0], 0.5f, nullptr);
                expected->update(psi_f.data(), y_f[0], 0.5f);
                std::vector<rlslab_step> steps(rows);
                std::vector<native::Step> other(rows);
                rlslab_update_many_weighted(f, psi.data(), rows, stride, y.data(), weights.data(), steps.data());
                expected->update_many(psi.data(), rows, stride, y.data(), weights.data(), other.data());
                EXPECT_EQ(std::memcmp(steps.data(), other.data(), rows * sizeof steps[0]), 0);
                rlslab_update_many_weighted_f32(f, psi_f.data(), rows, stride, y_f.data(), weights_f.data(), nullptr);
                expected->update_many(psi_f.data(), rows, stride, y_f.data(), weights_f.data(), nullptr);
                rlslab_update_many_weighted(f, psi.data(), rows, stride, y.data(), nullptr, nullptr);
                expected->update_many(psi.data(), rows, stride, y.data(), static_cast<native::Step*>(nullptr));
                EXPECT_EQ(c::state_of(f), state_of(*expected));

                expect_answer([&](double* out) { return rlslab_variance(f, psi.data(), rows, stride, out); },
                              [&](double* out) { expected->variance(psi.data(), rows, stride, out); });
                expect_answer([&](double* out) { return rlslab_factor(f, out); },
                              [&](double* out) { expected->factor(out); });
                expect_answer([&](double* out) { return rlslab_sample(f, 77, 9, 0.25, out); },
                              [&](double* out) { expected->sample(77, 9, 0.25, out); });
                expect_answer([&](double* out) { return rlslab_least_excited(f, out, out + d); },
                              [&](double* out) {
                                  native::Excitation const found = expected->least_excited(out);
                                  out[d] = found.deviation, out[d + 1] = found.ratio;
                              });
                expect_answer([&](double* out) { return rlslab_remove(f, &psi[59 * stride], y[59], 1, out); },
                              [&](double* out) {
                                  native::Removal const removal = expected->remove(&psi[59 * stride], y[59]);
                                  out[0] = removal.remaining, out[1] = removal.noise;
                              });
                if (expected->downdates()) {
                    EXPECT_EQ(rlslab_remove(f, &psi[58 * stride], y[58], 0.98, nullptr), RLSLAB_OK);
                    expected->remove(&psi[58 * stride], y[58], 0.98);
                }
                options.prior_variance = 0;
                FilterHandle const part = filter_of("qr_block", arithmetic.data(), options_of(d, 0.98));
                options.guard = nullptr;
                FilterHandle const newer = filter_of("qr_block", arithmetic.data(), options);
                auto const newer_expected =
                    native::make("qr_block", arithmetic, {.size = d, .forgetting = 0.98, .prior_variance = 0});
                rlslab_update_many(newer.get(), psi.data(), 20, stride, y.data(), nullptr);
                newer_expected->update_many(psi.data(), 20, stride, y.data(), static_cast<native::Step*>(nullptr));
                if (variant == "qr_block") {
                    EXPECT_EQ(rlslab_merge(f, part.get()), RLSLAB_INVALID);
                    EXPECT_THAT(rlslab_message(), HasSubstr("without a prior"));
                    EXPECT_EQ(rlslab_merge(f, newer.get()), RLSLAB_OK);
                    expected->merge(*newer_expected);
                } else {
                    EXPECT_EQ(rlslab_merge(f, newer.get()), RLSLAB_ABILITY);
                    EXPECT_THAT(rlslab_message(), HasSubstr("qr_block does"));
                }
                EXPECT_EQ(c::state_of(f), state_of(*expected));
                double gain[d], expected_gain[d];
                rlslab_gain(f, gain), expected->gain(expected_gain);
                EXPECT_EQ(std::memcmp(gain, expected_gain, sizeof gain), 0);
                ++answered;
            }
    EXPECT_GT(answered, 60);
}
TEST(Asked, NumbersThatAreNoneAreRefused) {
    FilterHandle const filter = filter_of("ud", "double", options_of(2)),
                       plain = filter_of("symmetric", "double", options_of(2));
    double numbers[4] = {1, 2, 3, 4};
    for (double const scale : {-1.0, nan, HUGE_VAL}) {
        EXPECT_EQ(rlslab_sample(filter.get(), 1, 1, scale, numbers), RLSLAB_INVALID);
        EXPECT_THAT(rlslab_message(), HasSubstr("scale"));
    }
    EXPECT_EQ(rlslab_sample(filter.get(), 1, PTRDIFF_MAX, 1, numbers), RLSLAB_INVALID);
    EXPECT_THAT(rlslab_message(), HasSubstr("beyond memory"));
    EXPECT_EQ(rlslab_sample(filter.get(), 1, 0, 1, nullptr), RLSLAB_OK);
    EXPECT_EQ(rlslab_variance(filter.get(), numbers, 2, 1, numbers), RLSLAB_INVALID);
    EXPECT_THAT(rlslab_message(), HasSubstr("stride"));
    EXPECT_EQ(rlslab_variance(filter.get(), nullptr, 0, 0, nullptr), RLSLAB_OK);
    EXPECT_EQ(rlslab_update_many_weighted(filter.get(), numbers, 1, 1, numbers, numbers, nullptr), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_sample(plain.get(), 1, 1, 1, numbers), RLSLAB_ABILITY);
    EXPECT_THAT(rlslab_message(), HasSubstr("symmetric stores no root"));
    EXPECT_EQ(rlslab_update_many_weighted(filter.get(), nullptr, 0, 0, nullptr, nullptr, nullptr), RLSLAB_OK);
    double out[2];
    std::vector<std::byte> const before = c::state_of(filter.get());
    for (double const w : {-1.0, nan, 1e300}) {
        ASSERT_EQ(rlslab_remove(filter.get(), numbers, 1, w, out), RLSLAB_OK);
        EXPECT_FALSE(out[0] > 0);
        rlslab_step step;
        if (w < 1e300) {
            ASSERT_EQ(rlslab_update_weighted(filter.get(), numbers, 1, w != w ? w : -w - 2, &step), RLSLAB_OK);
            EXPECT_EQ(step.health, 3);
            EXPECT_EQ(rlslab_health(filter.get()), 3);
        }
    }
    EXPECT_EQ(c::state_of(filter.get()), before);
}

}  // namespace
}  // namespace rlslab::c
