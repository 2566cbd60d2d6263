// Fleets from C: rlslab_fleet, and rlslab_complex, are a native::Fleet.
#include "bindings/c/border.hpp"

#include <algorithm>

using namespace rlslab;
using namespace rlslab::c;

namespace {

template <class Handle>
std::size_t filters_of(Handle const* f) {
    return f ? std::size_t(of(f).filters()) : 0;
}

/// take(): how many rows were missing.
template <class Handle, class T>
rlslab_status update(Handle* f, T const* psi, T const* y, std::size_t rows, std::size_t* missing, auto const& take) {
    if (!f) return null_among({{"filter", f}});
    if (missing) *missing = 0;
    if (rows == 0) return RLSLAB_OK;
    if (!psi || !y) return null_among({{"psi", psi}, {"y", y}});
    if (rows > PTRDIFF_MAX / 64 / filters_of(f) / std::size_t(std::max(of(f).size(), of(f).outputs())))
        return failed(RLSLAB_INVALID, "%zu rows of this size are beyond memory", rows);
    return guarded([&] {
        auto const count = take();
        if (missing) *missing = std::size_t(count);
    });
}
template <class T>
rlslab_status update(rlslab_fleet* f, T const* psi, T const* y, T const* weights, std::size_t rows, rlslab_step* steps,
                     std::size_t* missing) noexcept {
    return update(f, psi, y, rows, missing, [&] {
        return of(f).update({index(rows), psi, y, weights, reinterpret_cast<native::Step*>(steps)});
    });
}
template <class T>
rlslab_status update(rlslab_complex* f, T const* psi, T const* y, T const* weights, std::size_t rows,
                     rlslab_complex_steps const* steps, std::size_t* missing) noexcept {
    return update(f, psi, y, rows, missing, [&] {
        if (!steps) return of(f).update({index(rows), psi, y, weights});
        native::Index const M = of(f).filters(), m = of(f).outputs();
        std::vector<native::Fleet::ComplexStep> told(std::size_t(M * m));
        rlslab_complex_steps to = *steps;
        native::Index out = 0;
        for (std::size_t k = 0; k < rows; ++k, psi += 2 * M * of(f).size(), y += 2 * M * m) {
            out += of(f).update({1, psi, y, weights ? weights + native::Index(k) * M : nullptr, told.data()});
            for (auto const& step : told) {
                bool const first = (&step - told.data()) % m == 0;
                for (double const x : {step.innovation.real(), step.innovation.imag()})
                    if (to.innovation) *to.innovation++ = x;
                for (double const x : {step.residual.real(), step.residual.imag()})
                    if (to.residual) *to.residual++ = x;
                if (to.gamma && first) *to.gamma++ = step.gamma;
                if (to.health && first) *to.health++ = step.health;
                else if (to.health) to.health[-1] = std::max(to.health[-1], step.health);
            }
        }
        return out;
    });
}
template <class Handle>
rlslab_status matrix(Handle const* f, std::size_t i, double* out, bool covariance) noexcept {
    if (!f || !out) return null_among({{"filter", f}, {"out", out}});
    if (i >= filters_of(f)) return no_filter(i, filters_of(f));
    if (of(f).matrix(index(i), nullptr) != covariance) return other_matrix(of(f).variant(), covariance);
    return guarded([&] { of(f).matrix(index(i), out); });
}
/// Of the filters from `first` on, in a row.
template <class Handle>
rlslab_status theta(Handle const* f, std::size_t first, std::size_t end, double* out) noexcept {
    if (!f || !out) return null_among({{"filter", f}, {"out", out}});
    if (first >= filters_of(f)) return no_filter(first, filters_of(f));
    native::Index const numbers = (of(f).is_complex() ? 2 : 1) * of(f).size() * of(f).outputs();
    return guarded([&] {
        for (std::size_t i = first; i < end; ++i) of(f).theta(index(i), out + index(i - first) * numbers);
    });
}
template <class Handle>
std::int32_t health(Handle const* f, std::size_t i) noexcept {
    return i < filters_of(f) ? of(f).health(index(i)) : -1;
}

}  // namespace

rlslab_status rlslab_fleet_new(char const* variant, char const* arithmetic, std::size_t filters,
                               rlslab_options const* options, rlslab_fleet** out) {
    return rlslab_fleet_new_outputs(variant, arithmetic, filters, 1, options, out);
}
rlslab_status rlslab_fleet_new_outputs(char const* variant, char const* arithmetic, std::size_t filters,
                                       std::size_t outputs, rlslab_options const* options, rlslab_fleet** out) {
    return make(Request{variant, arithmetic, options, filters, outputs}, out, [&](auto const& o) {
        return native::make_fleet(variant, arithmetic, index(filters), o, index(outputs));
    });
}
rlslab_status rlslab_fleet_copy(rlslab_fleet const* fleet, rlslab_fleet** out) { return copy(fleet, out); }
void rlslab_fleet_free(rlslab_fleet* fleet) { delete reinterpret_cast<native::Fleet*>(fleet); }
std::size_t rlslab_fleet_size(rlslab_fleet const* fleet) { return fleet ? std::size_t(of(fleet).size()) : 0; }
std::size_t rlslab_fleet_filters(rlslab_fleet const* fleet) { return filters_of(fleet); }
std::size_t rlslab_fleet_outputs(rlslab_fleet const* fleet) { return fleet ? std::size_t(of(fleet).outputs()) : 0; }

rlslab_status rlslab_fleet_update(rlslab_fleet* fleet, double const* psi, double const* y, std::size_t* missing) {
    return update<double>(fleet, psi, y, nullptr, 1, nullptr, missing);
}
rlslab_status rlslab_fleet_update_f32(rlslab_fleet* fleet, float const* psi, float const* y, std::size_t* missing) {
    return update<float>(fleet, psi, y, nullptr, 1, nullptr, missing);
}
rlslab_status rlslab_fleet_update_many(rlslab_fleet* fleet, double const* psi, double const* y, double const* weights,
                                       std::size_t rows, rlslab_step* steps, std::size_t* missing) {
    return update(fleet, psi, y, weights, rows, steps, missing);
}
rlslab_status rlslab_fleet_update_many_f32(rlslab_fleet* fleet, float const* psi, float const* y, float const* weights,
                                           std::size_t rows, rlslab_step* steps, std::size_t* missing) {
    return update(fleet, psi, y, weights, rows, steps, missing);
}
rlslab_status rlslab_fleet_theta(rlslab_fleet const* fleet, std::size_t m, double* out) {
    return theta(fleet, m, m + 1, out);
}
rlslab_status rlslab_fleet_covariance(rlslab_fleet const* fleet, std::size_t m, double* out) {
    return matrix(fleet, m, out, true);
}
rlslab_status rlslab_fleet_information(rlslab_fleet const* fleet, std::size_t m, double* out) {
    return matrix(fleet, m, out, false);
}
std::int32_t rlslab_fleet_health(rlslab_fleet const* fleet, std::size_t m) { return health(fleet, m); }
rlslab_status rlslab_fleet_reset(rlslab_fleet* fleet, std::size_t m) {
    if (!fleet) return null_among({{"fleet", fleet}});
    if (m >= filters_of(fleet)) return no_filter(m, filters_of(fleet));
    return guarded([&] { of(fleet).reset(index(m)); });
}
std::size_t rlslab_fleet_state_size(rlslab_fleet const* fleet) { return state_size(fleet); }
rlslab_status rlslab_fleet_save(rlslab_fleet const* fleet, void* to, std::size_t room) { return save(fleet, to, room); }
rlslab_status rlslab_fleet_load(rlslab_fleet* fleet, void const* from, std::size_t bytes) {
    return load(fleet, from, bytes);
}

rlslab_status rlslab_complex_new(char const* variant, char const* arithmetic, std::size_t filters, std::size_t outputs,
                                 rlslab_options const* options, rlslab_complex** out) {
    return make(Request{variant, arithmetic, options, filters, outputs}, out, [&](auto const& o) {
        return native::make_complex(variant, arithmetic, index(filters), index(outputs), o);
    });
}
rlslab_status rlslab_complex_copy(rlslab_complex const* filter, rlslab_complex** out) { return copy(filter, out); }
void rlslab_complex_free(rlslab_complex* filter) { delete reinterpret_cast<native::Fleet*>(filter); }
rlslab_status rlslab_complex_reset(rlslab_complex* filter) {
    if (!filter) return null_among({{"filter", filter}});
    return guarded([&] {
        for (native::Index i = 0; i < of(filter).filters(); ++i) of(filter).reset(i);
    });
}
std::size_t rlslab_complex_size(rlslab_complex const* f) { return f ? std::size_t(of(f).size()) : 0; }
std::size_t rlslab_complex_filters(rlslab_complex const* f) { return filters_of(f); }
std::size_t rlslab_complex_outputs(rlslab_complex const* f) { return f ? std::size_t(of(f).outputs()) : 0; }

rlslab_status rlslab_complex_update(rlslab_complex* filter, double const* psi, double const* y, std::size_t rows,
                                    rlslab_complex_steps const* steps, std::size_t* missing) {
    return update<double>(filter, psi, y, nullptr, rows, steps, missing);
}
rlslab_status rlslab_complex_update_f32(rlslab_complex* filter, float const* psi, float const* y, std::size_t rows,
                                        rlslab_complex_steps const* steps, std::size_t* missing) {
    return update<float>(filter, psi, y, nullptr, rows, steps, missing);
}
rlslab_status rlslab_complex_update_weighted(rlslab_complex* filter, double const* psi, double const* y,
                                             double const* weights, std::size_t rows, rlslab_complex_steps const* steps,
                                             std::size_t* missing) {
    return update(filter, psi, y, weights, rows, steps, missing);
}
rlslab_status rlslab_complex_update_weighted_f32(rlslab_complex* filter, float const* psi, float const* y,
                                                 float const* weights, std::size_t rows,
                                                 rlslab_complex_steps const* steps, std::size_t* missing) {
    return update(filter, psi, y, weights, rows, steps, missing);
}
rlslab_status rlslab_complex_theta(rlslab_complex const* filter, double* out) {
    return theta(filter, 0, filters_of(filter), out);
}
rlslab_status rlslab_complex_covariance(rlslab_complex const* filter, std::size_t i, double* out) {
    return matrix(filter, i, out, true);
}
rlslab_status rlslab_complex_information(rlslab_complex const* filter, std::size_t i, double* out) {
    return matrix(filter, i, out, false);
}
std::int32_t rlslab_complex_health(rlslab_complex const* filter, std::size_t i) { return health(filter, i); }
std::size_t rlslab_complex_state_size(rlslab_complex const* filter) { return state_size(filter); }
rlslab_status rlslab_complex_save(rlslab_complex const* filter, void* to, std::size_t room) {
    return save(filter, to, room);
}
rlslab_status rlslab_complex_load(rlslab_complex* filter, void const* from, std::size_t bytes) {
    return load(filter, from, bytes);
}
