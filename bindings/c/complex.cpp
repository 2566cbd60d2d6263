// Complex filters from C: rlslab_complex is a native::ComplexFleet.
#include "bindings/c/border.hpp"

#include <rlslab/catalogue/native/complex.hpp>

#include <algorithm>

using namespace rlslab;
using namespace rlslab::c;

namespace {

native::ComplexFleet& of(rlslab_complex* f) { return *reinterpret_cast<native::ComplexFleet*>(f); }
native::ComplexFleet const& of(rlslab_complex const* f) { return *reinterpret_cast<native::ComplexFleet const*>(f); }
rlslab_complex* handle(std::unique_ptr<native::ComplexFleet> f) {
    return reinterpret_cast<rlslab_complex*>(f.release());
}
bool has(rlslab_complex const* f, std::size_t i) { return i < rlslab_complex_filters(f); }

template <class T>
rlslab_status update(rlslab_complex* f, T const* psi, T const* y, std::size_t rows, rlslab_complex_steps const* steps,
                     std::size_t* missing) noexcept {
    if (!f) return null_among({{"filter", f}});
    if (missing) *missing = 0;
    if (rows == 0) return RLSLAB_OK;
    if (!psi || !y) return null_among({{"psi", psi}, {"y", y}});
    std::size_t const of_a_row = std::size_t(of(f).filters()) * std::size_t(std::max(of(f).size(), of(f).outputs()));
    if (rows > PTRDIFF_MAX / (2 * sizeof(double)) / of_a_row)
        return failed(RLSLAB_INVALID, "%zu rows of this size are beyond memory", rows);
    return guarded([&] {
        native::ComplexFleet::Steps to;
        if (steps) to = {steps->innovation, steps->residual, steps->gamma, steps->health};
        auto const count = of(f).update(index(rows), psi, y, to);
        if (missing) *missing = std::size_t(count);
    });
}
rlslab_status matrix(rlslab_complex const* f, std::size_t i, double* out, bool covariance) noexcept {
    if (!f || !out) return null_among({{"filter", f}, {"out", out}});
    if (!has(f, i)) return no_filter(i, rlslab_complex_filters(f));
    if (of(f).reports_covariance() != covariance) return other_matrix(of(f).variant(), covariance);
    return guarded([&] { of(f).matrix(index(i), out); });
}

}  // namespace

rlslab_status rlslab_complex_new(char const* variant, char const* arithmetic, std::size_t filters, std::size_t outputs,
                                 rlslab_options const* options, rlslab_complex** out) {
    if (!out) return null_among({{"out", out}});
    *out = nullptr;
    Request const request{variant, arithmetic, options, filters, outputs};
    if (rlslab_status const status = request.readable()) return status;
    return guarded(
        [&] {
            native::Options const o = request.read();
            *out = handle(native::make_complex(variant, arithmetic, index(filters), index(outputs), o));
        },
        request.refused());
}
rlslab_status rlslab_complex_copy(rlslab_complex const* filter, rlslab_complex** out) {
    if (!out) return null_among({{"out", out}});
    *out = nullptr;
    if (!filter) return null_among({{"filter", filter}});
    return guarded([&] { *out = handle(of(filter).clone()); });
}
void rlslab_complex_free(rlslab_complex* filter) { delete reinterpret_cast<native::ComplexFleet*>(filter); }
rlslab_status rlslab_complex_reset(rlslab_complex* filter) {
    if (!filter) return null_among({{"filter", filter}});
    return guarded([&] { of(filter).reset(); });
}
std::size_t rlslab_complex_size(rlslab_complex const* f) { return f ? std::size_t(of(f).size()) : 0; }
std::size_t rlslab_complex_filters(rlslab_complex const* f) { return f ? std::size_t(of(f).filters()) : 0; }
std::size_t rlslab_complex_outputs(rlslab_complex const* f) { return f ? std::size_t(of(f).outputs()) : 0; }

rlslab_status rlslab_complex_update(rlslab_complex* filter, double const* psi, double const* y, std::size_t rows,
                                    rlslab_complex_steps const* steps, std::size_t* missing) {
    return update(filter, psi, y, rows, steps, missing);
}
rlslab_status rlslab_complex_update_f32(rlslab_complex* filter, float const* psi, float const* y, std::size_t rows,
                                        rlslab_complex_steps const* steps, std::size_t* missing) {
    return update(filter, psi, y, rows, steps, missing);
}
rlslab_status rlslab_complex_theta(rlslab_complex const* filter, double* out) {
    if (!filter || !out) return null_among({{"filter", filter}, {"out", out}});
    return guarded([&] { of(filter).theta(out); });
}
rlslab_status rlslab_complex_covariance(rlslab_complex const* filter, std::size_t i, double* out) {
    return matrix(filter, i, out, true);
}
rlslab_status rlslab_complex_information(rlslab_complex const* filter, std::size_t i, double* out) {
    return matrix(filter, i, out, false);
}
std::int32_t rlslab_complex_health(rlslab_complex const* filter, std::size_t i) {
    return has(filter, i) ? of(filter).health(index(i)) : -1;
}

std::size_t rlslab_complex_state_size(rlslab_complex const* filter) { return filter ? state_size(of(filter)) : 0; }
rlslab_status rlslab_complex_save(rlslab_complex const* filter, void* to, std::size_t room) {
    if (!filter || !to) return null_among({{"filter", filter}, {"to", to}});
    return save(of(filter), to, room);
}
rlslab_status rlslab_complex_load(rlslab_complex* filter, void const* from, std::size_t bytes) {
    if (!filter || !from) return null_among({{"filter", filter}, {"from", from}});
    return load(of(filter), from, bytes);
}
