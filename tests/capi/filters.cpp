// The C interface does what the native layer does, bit for bit, and allocates nothing in an update.
#include "tests/capi/filters.hpp"

#include <rlslab/adapt/rules.hpp>
#include <rlslab/catalogue/native/filter.hpp>

#include <cstring>

namespace rlslab::c {
namespace {

using testing::ElementsAre;

constexpr std::size_t d = 4, rows = 120;

/// The steps, bit for bit: a NaN equals itself.
bool same(rlslab_step const& a, native::Step const& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// What a composition is made from, in C and in C++.
struct Composition {
    char const* what;
    rlslab_options c = options_of(d, 0.98);
    native::Options cpp{.size = d, .forgetting = 0.98};
    explicit Composition(char const* name) : what(name) {}
};
std::vector<Composition> compositions() {
    std::vector<Composition> out;
    out.emplace_back("alone");
    Composition& prior = out.emplace_back("another prior");
    static double const theta[d] = {1, 2, 3, 4};
    static double const P[d * d] = {2, 1, 0, 0, 1, 2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4};
    prior.c.prior_theta = prior.cpp.prior_theta = theta;
    prior.c.prior_covariance = prior.cpp.prior_covariance = P;
    Composition& guarded = out.emplace_back("guarded");
    guarded.c.guard = "reset";
    guarded.cpp.guard = "reset";
    guarded.c.innovation = guarded.cpp.innovation = 4;
    guarded.c.noise_memory = 50;
    guarded.cpp.noise_memory = 50;
    Composition& windowed = out.emplace_back("windowed");
    windowed.c.window = 40;
    windowed.cpp.window = 40;
    windowed.c.forgetting = windowed.cpp.forgetting = 1;
    for (std::string_view const rule : native::controls()) {
        Composition& controlled = out.emplace_back("with a rule");
        controlled.c.control = rule.data();
        controlled.cpp.control = rule;
        static double const number[] = {0.5};
        controlled.c.control_numbers = number;
        controlled.c.control_count = 1;
        controlled.cpp.control_numbers = number;
    }
    return out;
}

TEST(Filters, AreThoseOfTheNativeLayerAloneAndComposed) {
    auto psi = numbers(rows * d, 3), y = numbers(rows, 4);
    y[90] = 50;  // an outlier
    constexpr std::size_t stride = d + 3;
    auto const apart = numbers(rows * stride, 5);
    auto const floats = numbers<float>(rows * stride, 6), y_floats = numbers<float>(rows, 7);
    std::size_t made = 0, refused = 0;
    for (Composition const& composition : compositions())
        for (std::string_view const variant : native::variants())
            for (std::string_view const arithmetic : native::arithmetics()) {
                SCOPED_TRACE(std::string(composition.what) + " " + std::string(variant));
                FilterHandle const filter = filter_of(variant.data(), arithmetic.data(), composition.c);
                std::unique_ptr<native::Filter> expected;
                try {
                    expected = native::make(variant, arithmetic, composition.cpp);
                } catch (std::invalid_argument const& error) {
                    EXPECT_STREQ(rlslab_message(), error.what());
                }
                ASSERT_EQ(bool(filter), bool(expected)) << rlslab_message();
                ++(filter ? made : refused);
                if (!filter) continue;
                EXPECT_EQ(rlslab_variant(filter.get()), variant);
                EXPECT_EQ(rlslab_arithmetic(filter.get()), arithmetic);
                EXPECT_EQ(rlslab_size(filter.get()), d);
                for (std::size_t k = 0; k < rows; ++k) {
                    rlslab_step step;
                    ASSERT_EQ(rlslab_update(filter.get(), &psi[k * d], y[k], &step), RLSLAB_OK);
                    ASSERT_TRUE(same(step, expected->update(&psi[k * d], y[k]))) << k;
                }
                std::vector<std::byte> state(expected->state_size());
                expected->save(state);
                EXPECT_EQ(state_of(filter.get()), state);
                rlslab_filter* alike = nullptr;
                ASSERT_EQ(rlslab_from_state(state.data(), state.size(), &alike), RLSLAB_OK) << rlslab_message();
                FilterHandle const found(alike), copied = copy_of(filter.get());
                EXPECT_EQ(state_of(alike), state);
                EXPECT_EQ(state_of(copied.get()), state);
                auto const further = expected->clone();
                std::vector<rlslab_step> steps(rows);  // rows apart, with steps and without, in either arithmetic
                std::vector<native::Step> expected_steps(rows);
                rlslab_update_many(alike, apart.data(), rows, stride, y.data(), steps.data());
                further->update_many(apart.data(), rows, stride, y.data(), expected_steps.data());
                EXPECT_EQ(std::memcmp(steps.data(), expected_steps.data(), rows * sizeof steps[0]), 0);
                rlslab_update_many_f32(alike, floats.data(), rows, stride, y_floats.data(), nullptr);
                further->update_many(floats.data(), rows, stride, y_floats.data(), nullptr);
                rlslab_step step;
                rlslab_update_f32(alike, floats.data(), y_floats[0], &step);
                EXPECT_TRUE(same(step, further->update(floats.data(), y_floats[0])));
                std::vector<std::byte> later(further->state_size());
                further->save(later);
                EXPECT_EQ(state_of(alike), later);
                EXPECT_EQ(state_of(filter.get()), state) << "a copy goes on alone";
                EXPECT_EQ(rlslab_health(filter.get()), expected->health());
                EXPECT_EQ(rlslab_signal(filter.get()), expected->signal());
                rlslab_counts counts;
                ASSERT_EQ(rlslab_count(filter.get(), &counts, sizeof counts), RLSLAB_OK);
                native::Counts const c = expected->counts();
                EXPECT_THAT((std::vector{counts.rows, counts.unusable, counts.outliers, counts.changes, counts.windups,
                                         counts.breakdowns, counts.refactored, counts.since, counts.handed_over}),
                            ElementsAre(c.rows, c.unusable, c.outliers, c.changes, c.windups, c.breakdowns,
                                        c.refactored, c.since, 0));
            }
    EXPECT_GT(made, 150u);
    EXPECT_GT(refused, 0u);
}

TEST(Filters, ThetaAfterEachRowIsThatOfTheRowsOneByOne) {
    constexpr std::size_t stride = d + 2;
    auto const psi = numbers(rows * stride, 21), y = numbers(rows, 22);
    auto const floats = numbers<float>(rows * stride, 23), y_floats = numbers<float>(rows, 24);
    for (std::string_view const variant : native::variants())
        for (std::string_view const arithmetic : native::arithmetics()) {
            SCOPED_TRACE(variant);
            FilterHandle const filter = filter_of(variant.data(), arithmetic.data(), options_of(d, 0.98));
            FilterHandle const single = copy_of(filter.get());
            std::vector<double> path(rows * d), narrow(rows * d);
            std::vector<rlslab_step> steps(rows);
            ASSERT_EQ(
                rlslab_update_many_theta(filter.get(), psi.data(), rows, stride, y.data(), steps.data(), path.data()),
                RLSLAB_OK);
            ASSERT_EQ(rlslab_update_many_theta_f32(filter.get(), floats.data(), rows, stride, y_floats.data(), nullptr,
                                                   narrow.data()),
                      RLSLAB_OK);
            for (std::size_t k = 0; k < rows; ++k) {
                rlslab_step step;
                rlslab_update(single.get(), &psi[k * stride], y[k], &step);
                EXPECT_EQ(std::memcmp(&step, &steps[k], sizeof step), 0);
                EXPECT_EQ(theta_of(single.get()), std::vector<double>(&path[k * d], &path[k * d] + d));
            }
            for (std::size_t k = 0; k < rows; ++k) {
                rlslab_update_f32(single.get(), &floats[k * stride], y_floats[k], nullptr);
                EXPECT_EQ(theta_of(single.get()), std::vector<double>(&narrow[k * d], &narrow[k * d] + d));
            }
            EXPECT_EQ(state_of(filter.get()), state_of(single.get()));
        }
}

TEST(Filters, ACopyGoesOnAloneAndAResetBeginsAnew) {
    auto const psi = numbers(rows * d, 7), y = numbers(rows, 8);
    FilterHandle const filter = filter_of("carlson", "float", options_of(d, 0.97));
    std::vector<std::byte> const start = state_of(filter.get());
    rlslab_update_many(filter.get(), psi.data(), 60, d, y.data(), nullptr);
    FilterHandle const copy = copy_of(filter.get());
    std::vector<std::byte> const half = state_of(filter.get());
    EXPECT_EQ(state_of(copy.get()), half);
    rlslab_update_many(filter.get(), &psi[60 * d], 60, d, &y[60], nullptr);
    EXPECT_EQ(state_of(copy.get()), half);
    rlslab_update_many(copy.get(), &psi[60 * d], 60, d, &y[60], nullptr);
    EXPECT_EQ(state_of(copy.get()), state_of(filter.get()));
    EXPECT_EQ(theta_of(copy.get()), theta_of(filter.get()));
    EXPECT_EQ(rlslab_load(copy.get(), half.data(), half.size()), RLSLAB_OK);
    EXPECT_EQ(state_of(copy.get()), half);
    EXPECT_EQ(rlslab_reset(filter.get()), RLSLAB_OK);
    EXPECT_EQ(state_of(filter.get()), start);
}

TEST(Filters, CertificatesAreThoseOfTheNativeLayer) {
    auto const psi = numbers(rows * d, 11), y = numbers(rows, 12);
    rlslab_options options = options_of(d, 0.98);
    options.guard = "reset", options.window = 40;
    for (std::size_t const probes : {1, 3, 6}) {
        rlslab_filter* made = nullptr;
        ASSERT_EQ(rlslab_new_certified("ud", "float", &options, probes, 0, &made), RLSLAB_OK) << rlslab_message();
        FilterHandle const filter(made), plain = filter_of("ud", "float", options);
        auto const expected = native::make(
            "ud", "float",
            {.size = d, .forgetting = 0.98, .window = 40, .guard = "reset", .certify = native::Index(probes)});
        rlslab_update_many(made, psi.data(), rows, d, y.data(), nullptr);
        rlslab_update_many(plain.get(), psi.data(), rows, d, y.data(), nullptr);
        expected->update_many(psi.data(), rows, d, y.data(), nullptr);
        EXPECT_EQ(theta_of(made), theta_of(plain.get()));
        std::vector<std::byte> const state = state_of(made);
        double out[3];
        ASSERT_EQ(rlslab_certificate(made, out), RLSLAB_OK);
        native::Certificate const c = expected->certificate();
        EXPECT_THAT(out, ElementsAre(c.estimate, c.bound, c.theta));
        EXPECT_TRUE(0 < out[0] && out[0] <= out[1] && out[1] < 1e-3) << out[1];
        EXPECT_EQ(state_of(made), state);
        rlslab_filter* alike = nullptr;
        ASSERT_EQ(rlslab_from_state(state.data(), state.size(), &alike), RLSLAB_OK) << rlslab_message();
        FilterHandle const found(alike);
        double of_state[3];
        ASSERT_EQ(rlslab_certificate(alike, of_state), RLSLAB_OK);
        EXPECT_THAT(of_state, ElementsAre(out[0], out[1], out[2]));
    }
    rlslab_filter* none = nullptr;
    ASSERT_EQ(rlslab_new_certified("ud", "double", &options, 0, 0, &none), RLSLAB_OK);
    FilterHandle const without(none);
    EXPECT_EQ(state_of(none), state_of(filter_of("ud", "double", options).get()));
}
TEST(Filters, DigitsAreAskedForByTheGuard) {
    auto const psi = numbers(rows * d, 11), y = numbers(rows, 12);
    rlslab_options options = options_of(d, 0.9);
    options.guard = "rebuild";
    std::vector<std::int64_t> breakdowns;
    for (std::size_t const digits : {0, 5}) {  // float has six, and at this lambda the textbook form not even these
        rlslab_filter* made = nullptr;
        ASSERT_EQ(rlslab_new_certified("conventional", "float", &options, 3, digits, &made), RLSLAB_OK);
        FilterHandle const filter(made);
        for (int i = 0; i < 10; ++i) rlslab_update_many(made, psi.data(), rows, d, y.data(), nullptr);
        rlslab_counts counts;
        ASSERT_EQ(rlslab_count(made, &counts, sizeof counts), RLSLAB_OK);
        breakdowns.push_back(counts.breakdowns);
    }
    EXPECT_GT(breakdowns[1], breakdowns[0]);
    rlslab_filter* none = nullptr;
    EXPECT_EQ(rlslab_new_certified("ud", "float", &options, 3, 7, &none), RLSLAB_INVALID);
    EXPECT_THAT(rlslab_message(), testing::HasSubstr("digits <= 6"));
    EXPECT_EQ(rlslab_new_certified("ud", "float", &options, 0, 4, &none), RLSLAB_INVALID);
    EXPECT_THAT(rlslab_message(), testing::HasSubstr("probes and a guard beside digits"));
}

TEST(Filters, AMissingSampleInflatesP) {
    FilterHandle const filter = filter_of("ud", "double", options_of(2, 0.5));
    double before[4], after[4];
    rlslab_covariance(filter.get(), before);
    ASSERT_EQ(rlslab_pass_time(filter.get(), nullptr), RLSLAB_OK);
    rlslab_covariance(filter.get(), after);
    EXPECT_THAT(after, ElementsAre(2 * before[0], 0, 0, 2 * before[3]));
}

/// docs/c.md has a row for each rule of forgetting, with its numbers in their order.
TEST(Filters, ThePageHasTheNumbersOfEachRule) {
    std::string const page = files::read(RLSLAB_SOURCE_DIR "/docs/c.md");
    std::size_t rules = 0;
    for_each(Rules<double>{}, [&]<class Rule>() {
        std::string row;
        detail::for_each_number<Rule>([&](auto const& number) {
            if (number.name.empty()) return;  // of the type alone
            bool const needed =
                number.range.otherwise == RuleDefault::none || number.range.otherwise == RuleDefault::noise_variance;
            row += (row.empty() ? " " : ", ") + std::string(number.member) + (needed ? " (no default)" : "");
        });
        row = "| `" + std::string(Rule::name) + "` |" + row + " |\n";
        EXPECT_THAT(page, testing::HasSubstr(row));
        ++rules;
    });
    EXPECT_EQ(rules, native::controls().size());
}

TEST(Filters, AComposedFleetIsItsFilters) {
    constexpr std::size_t count = 3;
    auto const psi = numbers(rows * count * d, 9);
    auto y = numbers(rows * count, 10);
    y[60 * count + 1] = 1e9;  // an outlier, which the guard of filter 1 skips
    rlslab_options options = options_of(d, 0.98);
    options.guard = "reset";
    options.window = 40;
    rlslab_fleet* made = nullptr;
    ASSERT_EQ(rlslab_fleet_new("carlson", "float", count, &options, &made), RLSLAB_OK) << rlslab_message();
    FleetHandle const fleet(made);
    for (std::size_t m = 0; m < count; ++m) {
        auto const alone = filter_of("carlson", "float", options);
        for (std::size_t k = 0; k < rows; ++k) {
            if (m == 0) {
                ASSERT_EQ(rlslab_fleet_update(made, &psi[k * count * d], &y[k * count], nullptr), RLSLAB_OK);
            }
            rlslab_update(alone.get(), &psi[(k * count + m) * d], y[k * count + m], nullptr);
        }
        std::vector<double> theta(d);
        ASSERT_EQ(rlslab_fleet_theta(made, m, theta.data()), RLSLAB_OK);
        EXPECT_EQ(theta, theta_of(alone.get())) << m;
        EXPECT_EQ(rlslab_fleet_health(made, m), 0);
    }
    std::vector<std::byte> const state = state_of(made);
    ASSERT_EQ(rlslab_fleet_reset(made, 1), RLSLAB_OK);
    ASSERT_EQ(rlslab_fleet_load(made, state.data(), state.size()), RLSLAB_OK);
    EXPECT_EQ(state_of(made), state);
    options.window = 0;
    options.guard = nullptr;
    EXPECT_EQ(rlslab_fleet_new("carlson", "float", count, &options, &made), RLSLAB_OK);
    FleetHandle const plain(made);
    EXPECT_EQ(rlslab_fleet_load(made, state.data(), state.size()), RLSLAB_STATE);
}
TEST(Filters, AFleetIsItsFilters) {
    constexpr std::size_t count = 7;
    auto psi = numbers(rows * count * d, 9), y = numbers(rows * count, 10);
    psi[50 * count * d + 2 * d] = native::Options::unset;  // NaN: filter 2 misses row 50
    rlslab_options const options = options_of(d, 0.98);
    for (char const* const arithmetic : {"float", "double"}) {
        rlslab_fleet* made = nullptr;
        ASSERT_EQ(rlslab_fleet_new("ud", arithmetic, count, &options, &made), RLSLAB_OK) << rlslab_message();
        FleetHandle const fleet(made);
        EXPECT_EQ(rlslab_fleet_size(made), d);
        EXPECT_EQ(rlslab_fleet_filters(made), count);
        std::vector<FilterHandle> alone;
        for (std::size_t m = 0; m < count; ++m) alone.push_back(filter_of("ud", arithmetic, options));
        for (std::size_t k = 0; k < rows; ++k) {
            std::size_t missing = 99;
            ASSERT_EQ(rlslab_fleet_update(made, &psi[k * count * d], &y[k * count], &missing), RLSLAB_OK);
            ASSERT_EQ(missing, k == 50 ? 1u : 0u);
            for (std::size_t m = 0; m < count; ++m)
                if (k != 50 || m != 2)
                    rlslab_update(alone[m].get(), &psi[(k * count + m) * d], y[k * count + m], nullptr);
        }
        for (std::size_t m = 0; m < count; ++m) {
            std::vector<double> theta(d);
            ASSERT_EQ(rlslab_fleet_theta(made, m, theta.data()), RLSLAB_OK);
            EXPECT_EQ(theta, theta_of(alone[m].get())) << m;
            EXPECT_EQ(rlslab_fleet_health(made, m), 0);
        }
        std::vector<std::byte> const state = state_of(made);
        rlslab_fleet* copied = nullptr;
        ASSERT_EQ(rlslab_fleet_copy(made, &copied), RLSLAB_OK);
        FleetHandle const copy(copied);
        ASSERT_EQ(rlslab_fleet_reset(copied, 3), RLSLAB_OK);
        EXPECT_NE(state_of(copied), state);
        ASSERT_EQ(rlslab_fleet_load(copied, state.data(), state.size()), RLSLAB_OK);
        EXPECT_EQ(state_of(copied), state);
    }
}

}  // namespace
}  // namespace rlslab::c
