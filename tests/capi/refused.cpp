// What the C interface refuses: each with its code and one line, and the filter is as it was.
#include "tests/capi/filters.hpp"

#include <cmath>
#include <thread>

namespace rlslab::c {
namespace {

using testing::Each;
using testing::HasSubstr;

/// The message is one line that can be printed, and has the text.
void expect_message(std::string const& part) {
    std::string const message = rlslab_message();
    EXPECT_THAT(message, HasSubstr(part));
    EXPECT_THAT(message, Each(testing::Ge(' '))) << message;
}
void expect_refused(rlslab_options const& options, rlslab_status status, std::string const& part,
                    char const* variant = "ud", char const* arithmetic = "double") {
    rlslab_filter* filter = reinterpret_cast<rlslab_filter*>(&filter);
    EXPECT_EQ(rlslab_new(variant, arithmetic, &options, &filter), status) << part;
    EXPECT_EQ(filter, nullptr);
    expect_message(part);
}

TEST(Refused, NullPointers) {
    rlslab_options const options = options_of(2);
    FilterHandle const filter = filter_of("ud", "double", options);
    rlslab_filter* out = nullptr;
    rlslab_step step;
    rlslab_counts counts;
    double numbers[4] = {};
    float floats[2] = {};
    char bytes[1] = {};
    rlslab_filter* const f = filter.get();
    expect_null(rlslab_defaults(nullptr, sizeof options), rlslab_new(nullptr, "double", &options, &out),
                rlslab_new("ud", nullptr, &options, &out), rlslab_new("ud", "double", nullptr, &out),
                rlslab_new("ud", "double", &options, nullptr), rlslab_copy(nullptr, &out), rlslab_copy(f, nullptr),
                rlslab_reset(nullptr), rlslab_update(nullptr, numbers, 0, &step), rlslab_update(f, nullptr, 0, &step),
                rlslab_update_f32(nullptr, floats, 0, &step), rlslab_update_f32(f, nullptr, 0, &step),
                rlslab_update_many(nullptr, numbers, 1, 0, numbers, nullptr),
                rlslab_update_many(f, nullptr, 1, 0, numbers, nullptr),
                rlslab_update_many(f, numbers, 1, 0, nullptr, nullptr),
                rlslab_update_many_f32(nullptr, floats, 1, 0, floats, nullptr),
                rlslab_update_many_f32(f, nullptr, 1, 0, floats, nullptr),
                rlslab_update_many_f32(f, floats, 1, 0, nullptr, nullptr),
                rlslab_update_many_theta(nullptr, numbers, 1, 0, numbers, nullptr, numbers),
                rlslab_update_many_theta(f, numbers, 1, 0, numbers, nullptr, nullptr),
                rlslab_update_many_theta_f32(f, floats, 1, 0, nullptr, nullptr, numbers),
                rlslab_pass_time(nullptr, &step), rlslab_update_weighted(nullptr, numbers, 0, 1, &step),
                rlslab_update_weighted(f, nullptr, 0, 1, &step), rlslab_update_weighted_f32(f, nullptr, 0, 1, &step),
                rlslab_update_many_weighted(nullptr, numbers, 1, 0, numbers, numbers, nullptr),
                rlslab_update_many_weighted(f, nullptr, 1, 0, numbers, numbers, nullptr),
                rlslab_update_many_weighted(f, numbers, 1, 0, nullptr, numbers, nullptr),
                rlslab_update_many_weighted_f32(f, floats, 1, 0, nullptr, floats, nullptr),
                rlslab_remove(nullptr, numbers, 0, 1, numbers), rlslab_remove(f, nullptr, 0, 1, numbers),
                rlslab_merge(nullptr, f), rlslab_merge(f, nullptr), rlslab_variance(nullptr, numbers, 1, 0, numbers),
                rlslab_variance(f, nullptr, 1, 0, numbers), rlslab_variance(f, numbers, 1, 0, nullptr),
                rlslab_factor(nullptr, numbers), rlslab_factor(f, nullptr), rlslab_sample(nullptr, 1, 1, 1, numbers),
                rlslab_sample(f, 1, 1, 1, nullptr), rlslab_least_excited(nullptr, numbers, numbers),
                rlslab_least_excited(f, nullptr, numbers), rlslab_least_excited(f, numbers, nullptr),
                rlslab_theta(nullptr, numbers), rlslab_theta(f, nullptr), rlslab_gain(nullptr, numbers),
                rlslab_gain(f, nullptr), rlslab_covariance(nullptr, numbers), rlslab_covariance(f, nullptr),
                rlslab_information(nullptr, numbers), rlslab_information(f, nullptr),
                rlslab_new_certified("ud", "double", nullptr, 3, 0, &out),
                rlslab_new_certified("ud", "double", &options, 3, 0, nullptr), rlslab_certificate(nullptr, numbers),
                rlslab_certificate(f, nullptr), rlslab_count(nullptr, &counts, sizeof counts),
                rlslab_count(f, nullptr, sizeof counts), rlslab_save(nullptr, bytes, 1), rlslab_save(f, nullptr, 1),
                rlslab_load(nullptr, bytes, 1), rlslab_load(f, nullptr, 1), rlslab_from_state(bytes, 1, nullptr),
                rlslab_from_state(nullptr, 1, &out));
    expect_message("is null");
    rlslab_new("ud", "double", nullptr, &out);
    expect_message("options is null");
    EXPECT_EQ(rlslab_size(nullptr), 0u);
    EXPECT_EQ(rlslab_state_size(nullptr), 0u);
    EXPECT_EQ(rlslab_variant(nullptr), nullptr);
    EXPECT_EQ(rlslab_arithmetic(nullptr), nullptr);
    EXPECT_EQ(rlslab_health(nullptr), -1);
    EXPECT_EQ(rlslab_signal(nullptr), -1);
    rlslab_free(nullptr);
    // Null where null may be.
    EXPECT_EQ(rlslab_update(f, numbers, 0, nullptr), RLSLAB_OK);
    EXPECT_EQ(rlslab_update_many(f, nullptr, 0, 0, nullptr, nullptr), RLSLAB_OK);
    EXPECT_EQ(rlslab_pass_time(f, nullptr), RLSLAB_OK);
}
TEST(Refused, NullPointersOfFleets) {
    rlslab_options const options = options_of(2);
    rlslab_fleet *fleet = nullptr, *out = nullptr;
    ASSERT_EQ(rlslab_fleet_new("ud", "double", 3, &options, &fleet), RLSLAB_OK);
    FleetHandle const owner(fleet);
    double numbers[6] = {};
    float floats[6] = {};
    char bytes[1] = {};
    expect_null(rlslab_fleet_new(nullptr, "double", 3, &options, &out),
                rlslab_fleet_new("ud", nullptr, 3, &options, &out), rlslab_fleet_new("ud", "double", 3, nullptr, &out),
                rlslab_fleet_new("ud", "double", 3, &options, nullptr), rlslab_fleet_copy(nullptr, &out),
                rlslab_fleet_copy(fleet, nullptr), rlslab_fleet_update(nullptr, numbers, numbers, nullptr),
                rlslab_fleet_update(fleet, nullptr, numbers, nullptr),
                rlslab_fleet_update(fleet, numbers, nullptr, nullptr),
                rlslab_fleet_update_f32(nullptr, floats, floats, nullptr),
                rlslab_fleet_update_f32(fleet, nullptr, floats, nullptr),
                rlslab_fleet_update_f32(fleet, floats, nullptr, nullptr), rlslab_fleet_theta(nullptr, 0, numbers),
                rlslab_fleet_theta(fleet, 0, nullptr), rlslab_fleet_reset(nullptr, 0),
                rlslab_fleet_save(nullptr, bytes, 1), rlslab_fleet_save(fleet, nullptr, 1),
                rlslab_fleet_load(nullptr, bytes, 1), rlslab_fleet_load(fleet, nullptr, 1));
    EXPECT_EQ(rlslab_fleet_size(nullptr), 0u);
    EXPECT_EQ(rlslab_fleet_filters(nullptr), 0u);
    EXPECT_EQ(rlslab_fleet_state_size(nullptr), 0u);
    EXPECT_EQ(rlslab_fleet_health(nullptr, 0), -1);
    rlslab_fleet_free(nullptr);
    // A filter beyond the last, and the state of another fleet.
    EXPECT_EQ(rlslab_fleet_theta(fleet, 3, numbers), RLSLAB_INVALID);
    expect_message("no filter 3");
    EXPECT_EQ(rlslab_fleet_reset(fleet, most), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_fleet_health(fleet, 3), -1);
    EXPECT_EQ(rlslab_fleet_save(fleet, bytes, 1), RLSLAB_ROOM);
    EXPECT_EQ(rlslab_fleet_load(fleet, bytes, 1), RLSLAB_STATE);
}

TEST(Refused, UnknownNames) {
    expect_refused(options_of(2), RLSLAB_NAME, "no variant \"udd\"", "udd");
    expect_message("inverse_qr");
    expect_refused(options_of(2), RLSLAB_NAME, "no variant \"\"", "");
    expect_refused(options_of(2), RLSLAB_NAME, "cholesky_sparse", "cholesky_sparse");
    expect_refused(options_of(2), RLSLAB_NAME, "no variant \"u\\x0ad\\x1b", "u\nd\x1b");
    expect_refused(options_of(2), RLSLAB_NAME, "no variant \"xxx", std::string(100000, 'x').c_str());
    expect_refused(options_of(2), RLSLAB_NAME, "bfloat16", "ud", "bfloat16");
    rlslab_options options = options_of(2);
    options.guard = "resset";
    expect_refused(options, RLSLAB_NAME, "resset");
    options = options_of(2);
    options.control = "none_such";
    expect_refused(options, RLSLAB_NAME, "none_such");
    EXPECT_EQ(rlslab_name(6, 0), nullptr);
    EXPECT_EQ(rlslab_name(-1, 0), nullptr);
    EXPECT_EQ(rlslab_name(RLSLAB_HEALTHS, most), nullptr);
}

TEST(Refused, SizesThatAreNone) {
    expect_refused(options_of(0), RLSLAB_INVALID, "size");
    for (std::size_t const size : {most, most / 2, most / 2 + 1, std::size_t(1) << 32})
        expect_refused(options_of(size), RLSLAB_INVALID, "beyond memory");
#ifndef RLSLAB_SANITIZED  // which ends the program in place of std::bad_alloc
    // Terabytes: no vector of them is written before their matrix is refused.
    expect_refused(options_of(2000000), RLSLAB_MEMORY, "memory");
#endif
    for (std::size_t const rows : {most, most / 2, most / 16}) {
        rlslab_options options = options_of(2);
        options.window = rows;
        expect_refused(options, RLSLAB_INVALID, "beyond memory");
        options = options_of(2);
        options.guard = "rebuild";
        options.rebuild_rows = rows;
        expect_refused(options, RLSLAB_INVALID, "beyond memory");
        options = options_of(2);
        options.guard = "reset";
        options.noise_memory = rows;
        expect_refused(options, RLSLAB_INVALID, "beyond memory");
        rlslab_fleet* fleet = nullptr;
        options = options_of(2);
        EXPECT_EQ(rlslab_fleet_new("ud", "double", rows, &options, &fleet), RLSLAB_INVALID);
        EXPECT_EQ(fleet, nullptr);
    }
    rlslab_options const options = options_of(2);
    rlslab_fleet* fleet = nullptr;
    EXPECT_EQ(rlslab_fleet_new("ud", "double", 0, &options, &fleet), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_fleet_new("qr_block", "double", 3, &options, &fleet), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_fleet_new("udd", "double", 3, &options, &fleet), RLSLAB_NAME);
}

TEST(Refused, OptionsOfAnotherSize) {
    for (std::size_t const bytes :
         {std::size_t(0), std::size_t(8), sizeof(rlslab_options) - 8, sizeof(rlslab_options) + 8, most}) {
        rlslab_options options = options_of(2);
        options.bytes = bytes;
        expect_refused(options, RLSLAB_INVALID, "options of " + std::to_string(bytes) + " bytes");
        EXPECT_EQ(rlslab_defaults(&options, bytes), RLSLAB_INVALID);
    }
    // No member beyond `bytes` is read.
    std::vector<std::size_t> const short_one{sizeof(std::size_t)};
    rlslab_filter* out = nullptr;
    EXPECT_EQ(rlslab_new("ud", "double", reinterpret_cast<rlslab_options const*>(short_one.data()), &out),
              RLSLAB_INVALID);
    rlslab_counts counts;
    FilterHandle const filter = filter_of("ud", "double", options_of(2));
    EXPECT_EQ(rlslab_count(filter.get(), &counts, sizeof counts - 8), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_count(filter.get(), &counts, sizeof counts + 8), RLSLAB_INVALID);
}

TEST(Refused, NumbersThatAreNone) {
    for (double const forgetting : {nan, 0.0, -1.0, 1.0000001, HUGE_VAL})
        expect_refused(options_of(2, forgetting), RLSLAB_INVALID, "forgetting");
    double const not_finite[] = {1, nan, nan, HUGE_VAL}, zeros[4] = {};
    for (double const variance : {nan, -1.0, HUGE_VAL}) {
        rlslab_options options = options_of(2);
        options.prior_variance = variance;
        expect_refused(options, RLSLAB_INVALID, "prior");
    }
    rlslab_options options = options_of(2);
    options.prior_theta = not_finite;
    expect_refused(options, RLSLAB_INVALID, "prior_theta");
    options = options_of(2);
    options.prior_covariance = not_finite;
    expect_refused(options, RLSLAB_INVALID, "prior_covariance");
    options.prior_covariance = zeros;
    expect_refused(options, RLSLAB_INVALID, "");
    options = options_of(2);
    options.prior_variance = 0;
    expect_refused(options, RLSLAB_INVALID, "prior");  // ud needs one
    for (double rlslab_options::*const member : {&rlslab_options::innovation, &rlslab_options::least_noise,
                                                 &rlslab_options::largest_variance, &rlslab_options::asymmetry}) {
        options = options_of(2);
        options.guard = "reset";
        options.*member = -1;
        expect_refused(options, RLSLAB_INVALID, "");
        options.guard = nullptr;
        options.*member = 1;
        expect_refused(options, RLSLAB_INVALID, "a guard beside its numbers");
    }
    options = options_of(2);
    options.control = "kulhavy";
    options.control_count = 1;
    expect_refused(options, RLSLAB_INVALID, "control_count");
    std::vector<double> const many(65, 0.5);
    options.control_numbers = many.data();
    options.control_count = many.size();
    expect_refused(options, RLSLAB_INVALID, "control_numbers");
}

TEST(Refused, RowsThatMemoryHasNot) {
    FilterHandle const filter = filter_of("ud", "double", options_of(3, 0.98));
    auto const psi = numbers(6, 1), y = numbers(2, 2);
    auto const floats = numbers<float>(6, 1);
    ASSERT_EQ(rlslab_update_many(filter.get(), psi.data(), 2, 3, y.data(), nullptr), RLSLAB_OK);
    std::vector<std::byte> const before = state_of(filter.get());
    for (std::size_t const stride : {1, 2}) {
        EXPECT_EQ(rlslab_update_many(filter.get(), psi.data(), 2, stride, y.data(), nullptr), RLSLAB_INVALID);
        expect_message("stride");
        EXPECT_EQ(rlslab_update_many_f32(filter.get(), floats.data(), 2, stride, floats.data(), nullptr),
                  RLSLAB_INVALID);
    }
    for (std::size_t const rows : {most, most / 2 + 1, most / 8}) {
        EXPECT_EQ(rlslab_update_many(filter.get(), psi.data(), rows, 0, y.data(), nullptr), RLSLAB_INVALID);
        expect_message("beyond memory");
        EXPECT_EQ(rlslab_update_many(filter.get(), psi.data(), 2, rows, y.data(), nullptr), RLSLAB_INVALID);
        EXPECT_EQ(rlslab_update_many_f32(filter.get(), floats.data(), rows, 3, floats.data(), nullptr), RLSLAB_INVALID);
    }
    EXPECT_EQ(state_of(filter.get()), before);
}

TEST(Refused, TheOtherOfCovarianceAndInformation) {
    double P[4];
    std::size_t covariances = 0;
    for (std::string const& variant : names(RLSLAB_VARIANTS)) {
        FilterHandle const filter = filter_of(variant.c_str(), "double", options_of(2));
        ASSERT_TRUE(filter) << rlslab_message();
        rlslab_status const covariance = rlslab_covariance(filter.get(), P),
                            information = rlslab_information(filter.get(), P);
        EXPECT_EQ(covariance + information, RLSLAB_ABILITY) << variant;
        expect_message(variant);
        covariances += covariance == RLSLAB_OK;
    }
    EXPECT_GT(covariances, 5u);
    EXPECT_LT(covariances, names(RLSLAB_VARIANTS).size());
}

TEST(Refused, ProbesThatNoFilterHas) {
    rlslab_options const options = options_of(2);
    double numbers[3] = {1, 2, 3};
    EXPECT_EQ(rlslab_certificate(filter_of("ud", "double", options).get(), numbers), RLSLAB_ABILITY);
    expect_message("without probes");
    EXPECT_EQ(numbers[0], 1);
    for (std::size_t const probes : {std::size_t(7), most / 2, most}) {
        rlslab_filter* none = nullptr;
        EXPECT_EQ(rlslab_new_certified("ud", "double", &options, probes, 0, &none), RLSLAB_INVALID);
        expect_message("probes");
        EXPECT_EQ(none, nullptr);
    }
    std::size_t refused = 0;
    for (std::string const& variant : names(RLSLAB_VARIANTS)) {
        rlslab_filter* made = nullptr;
        if (rlslab_new_certified(variant.c_str(), "float", &options, 3, 0, &made) == RLSLAB_INVALID) {
            expect_message(variant + " cannot be composed so");
            ++refused;
        }
        rlslab_free(made);
    }
    EXPECT_EQ(refused, 3u);
}

TEST(Refused, StatesThatAreNone) {
    FilterHandle const filter = filter_of("ud", "double", options_of(2));
    double const psi[] = {1, 2};
    rlslab_update(filter.get(), psi, 3, nullptr);
    std::vector<std::byte> const state = state_of(filter.get());
    std::vector<std::byte> small(state.size() - 1);
    EXPECT_EQ(rlslab_save(filter.get(), small.data(), small.size()), RLSLAB_ROOM);
    expect_message(std::to_string(state.size()));
    std::vector<std::byte> large(state.size() + 9);
    EXPECT_EQ(rlslab_save(filter.get(), large.data(), large.size()), RLSLAB_OK);
    rlslab_filter* none = filter.get();
    for (std::size_t length = 0; length < state.size(); ++length) {
        std::vector<std::byte> const part(state.begin(), state.begin() + long(length));
        EXPECT_EQ(rlslab_load(filter.get(), state.data(), length), RLSLAB_STATE) << length;
        EXPECT_EQ(rlslab_from_state(state.data(), length, &none), RLSLAB_STATE) << length;
    }
    for (std::size_t at = 0; at < 8; ++at) {
        std::vector<std::byte> damaged = state;
        damaged[at] ^= std::byte(255);
        EXPECT_EQ(rlslab_load(filter.get(), damaged.data(), damaged.size()), RLSLAB_STATE) << at;
        EXPECT_EQ(rlslab_from_state(damaged.data(), damaged.size(), &none), RLSLAB_STATE) << at;
        EXPECT_EQ(none, nullptr);
    }
    for (auto const& [variant, arithmetic, size] :
         {std::tuple("ud", "float", 2), std::tuple("ud", "double", 3), std::tuple("carlson", "double", 2)}) {
        FilterHandle const other = filter_of(variant, arithmetic, options_of(std::size_t(size)));
        EXPECT_EQ(rlslab_load(other.get(), state.data(), state.size()), RLSLAB_STATE);
        expect_message("state");
    }
    EXPECT_EQ(state_of(filter.get()), state);
    EXPECT_EQ(rlslab_load(filter.get(), state.data(), state.size()), RLSLAB_OK);
}

TEST(Refused, AThreadKeepsItsOwnMessage) {
    expect_refused(options_of(0), RLSLAB_INVALID, "size");
    std::string elsewhere = "unset";
    std::thread([&] {
        elsewhere = rlslab_message();
        rlslab_new(nullptr, nullptr, nullptr, nullptr);
    }).join();
    EXPECT_EQ(elsewhere, "");
    expect_message("size");
}

}  // namespace
}  // namespace rlslab::c
