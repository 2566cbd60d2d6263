// Filters by the C interface that free themselves, and rows.
#pragma once

#include "bindings/c/rlslab.h"

#include <rlslab/core/random.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rlslab::c {

struct Free {
    void operator()(rlslab_filter* filter) const { rlslab_free(filter); }
    void operator()(rlslab_fleet* fleet) const { rlslab_fleet_free(fleet); }
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
inline std::vector<std::byte> state_of(rlslab_filter const* filter) {
    std::vector<std::byte> out(rlslab_state_size(filter));
    rlslab_save(filter, out.data(), out.size());
    return out;
}

}  // namespace rlslab::c
