// A fleet from C: rlslab_fleet is a native::Fleet.
#include "bindings/c/border.hpp"

using namespace rlslab;
using namespace rlslab::c;

namespace {

native::Fleet& of(rlslab_fleet* fleet) { return *reinterpret_cast<native::Fleet*>(fleet); }
native::Fleet const& of(rlslab_fleet const* fleet) { return *reinterpret_cast<native::Fleet const*>(fleet); }
rlslab_fleet* handle(std::unique_ptr<native::Fleet> fleet) { return reinterpret_cast<rlslab_fleet*>(fleet.release()); }

template <class T>
rlslab_status update(rlslab_fleet* fleet, T const* psi, T const* y, std::size_t* missing) noexcept {
    if (!fleet || !psi || !y) return null_among({{"fleet", fleet}, {"psi", psi}, {"y", y}});
    return guarded([&] {
        std::size_t const count = std::size_t(of(fleet).update(psi, y));
        if (missing) *missing = count;
    });
}
bool has(rlslab_fleet const* fleet, std::size_t m) { return m < rlslab_fleet_filters(fleet); }

}  // namespace

rlslab_status rlslab_fleet_new(char const* variant, char const* arithmetic, std::size_t filters,
                               rlslab_options const* options, rlslab_fleet** out) {
    if (!out) return null_among({{"out", out}});
    *out = nullptr;
    Request const request{variant, arithmetic, options, filters};
    if (rlslab_status const status = request.readable()) return status;
    return guarded(
        [&] {
            native::Options const o = request.read();
            *out = handle(native::make_fleet(variant, arithmetic, native::Index(filters), o));
        },
        request.refused());
}
rlslab_status rlslab_fleet_copy(rlslab_fleet const* fleet, rlslab_fleet** out) {
    if (!out) return null_among({{"out", out}});
    *out = nullptr;
    if (!fleet) return null_among({{"fleet", fleet}});
    return guarded([&] { *out = handle(of(fleet).clone()); });
}
void rlslab_fleet_free(rlslab_fleet* fleet) { delete reinterpret_cast<native::Fleet*>(fleet); }
std::size_t rlslab_fleet_size(rlslab_fleet const* fleet) { return fleet ? std::size_t(of(fleet).size()) : 0; }
std::size_t rlslab_fleet_filters(rlslab_fleet const* fleet) { return fleet ? std::size_t(of(fleet).filters()) : 0; }

rlslab_status rlslab_fleet_update(rlslab_fleet* fleet, double const* psi, double const* y, std::size_t* missing) {
    return update(fleet, psi, y, missing);
}
rlslab_status rlslab_fleet_update_f32(rlslab_fleet* fleet, float const* psi, float const* y, std::size_t* missing) {
    return update(fleet, psi, y, missing);
}

rlslab_status rlslab_fleet_theta(rlslab_fleet const* fleet, std::size_t m, double* out) {
    if (!fleet || !out) return null_among({{"fleet", fleet}, {"out", out}});
    if (!has(fleet, m)) return no_filter(m, rlslab_fleet_filters(fleet));
    return guarded([&] { of(fleet).theta(native::Index(m), out); });
}
std::int32_t rlslab_fleet_health(rlslab_fleet const* fleet, std::size_t m) {
    return has(fleet, m) ? of(fleet).health(native::Index(m)) : -1;
}
rlslab_status rlslab_fleet_reset(rlslab_fleet* fleet, std::size_t m) {
    if (!fleet) return null_among({{"fleet", fleet}});
    if (!has(fleet, m)) return no_filter(m, rlslab_fleet_filters(fleet));
    return guarded([&] { of(fleet).reset(native::Index(m)); });
}

std::size_t rlslab_fleet_state_size(rlslab_fleet const* fleet) { return fleet ? state_size(of(fleet)) : 0; }
rlslab_status rlslab_fleet_save(rlslab_fleet const* fleet, void* to, std::size_t room) {
    if (!fleet || !to) return null_among({{"fleet", fleet}, {"to", to}});
    return save(of(fleet), to, room);
}
rlslab_status rlslab_fleet_load(rlslab_fleet* fleet, void const* from, std::size_t bytes) {
    if (!fleet || !from) return null_among({{"fleet", fleet}, {"from", from}});
    return load(of(fleet), from, bytes);
}
