// Filters by the C interface that free themselves, their states, and rows.
#pragma once

#include "bindings/c/rlslab.h"
#include "tests/common/files.hpp"

#include <rlslab/core/random.hpp>

#include <limits>
#include <memory>
#include <vector>

namespace rlslab::c {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr std::size_t most = std::numeric_limits<std::size_t>::max();

struct Free {
    void operator()(rlslab_filter* filter) const { rlslab_free(filter); }
    void operator()(rlslab_fleet* fleet) const { rlslab_fleet_free(fleet); }
    void operator()(rlslab_complex* filter) const { rlslab_complex_free(filter); }
    void operator()(rlslab_outputs* filter) const { rlslab_outputs_free(filter); }
};
using FilterHandle = std::unique_ptr<rlslab_filter, Free>;
using FleetHandle = std::unique_ptr<rlslab_fleet, Free>;

inline rlslab_options options_of(std::size_t size, double forgetting = 1) {
    rlslab_options out;
    rlslab_defaults(&out, sizeof out);
    out.size = size;
    out.forgetting = forgetting;
    return out;
}
/// Null where it is refused.
inline FilterHandle filter_of(char const* variant, char const* arithmetic, rlslab_options const& options) {
    rlslab_filter* out = nullptr;
    rlslab_new(variant, arithmetic, &options, &out);
    return FilterHandle(out);
}
inline FilterHandle copy_of(rlslab_filter const* filter) {
    rlslab_filter* out = nullptr;
    rlslab_copy(filter, &out);
    return FilterHandle(out);
}
/// Of calls with a null pointer.
inline void expect_null(std::same_as<rlslab_status> auto... statuses) {
    for (rlslab_status const status : {statuses...}) EXPECT_EQ(status, RLSLAB_NULL);
}
inline std::vector<std::string> names(rlslab_list list) {
    std::vector<std::string> out;
    while (char const* name = rlslab_name(list, out.size())) out.push_back(name);
    return out;
}

template <class T = double>
std::vector<T> numbers(std::size_t count, std::uint64_t seed) {
    Seed draws{seed};
    std::vector<T> out(count);
    for (T& x : out) x = T(float(draws.bell()));  // the same in float and double
    return out;
}
inline std::vector<double> theta_of(rlslab_filter const* filter) {
    std::vector<double> out(rlslab_size(filter));
    rlslab_theta(filter, out.data());
    return out;
}
/// By the functions of one kind of filter.
std::vector<std::byte> bytes_of(auto const* filter, auto state_size, auto save) {
    std::vector<std::byte> out(state_size(filter));
    EXPECT_EQ(save(filter, out.data(), out.size()), RLSLAB_OK);
    return out;
}
inline auto state_of(rlslab_filter const* f) { return bytes_of(f, rlslab_state_size, rlslab_save); }
inline auto state_of(rlslab_fleet const* f) { return bytes_of(f, rlslab_fleet_state_size, rlslab_fleet_save); }
inline auto state_of(rlslab_complex const* f) { return bytes_of(f, rlslab_complex_state_size, rlslab_complex_save); }
inline auto state_of(rlslab_outputs const* f) { return bytes_of(f, rlslab_outputs_state_size, rlslab_outputs_save); }

}  // namespace rlslab::c
