// Several outputs from C: rlslab_outputs is a native::Outputs.
#include "bindings/c/border.hpp"

#include <algorithm>

using namespace rlslab;
using namespace rlslab::c;

namespace {

template <class T>
rlslab_status update(rlslab_outputs* filter, T const* psi, T const* y, rlslab_step* steps) noexcept {
    if (!filter || !psi || !y) return null_among({{"filter", filter}, {"psi", psi}, {"y", y}});
    return guarded([&] { of(filter).update(psi, y, reinterpret_cast<native::Step*>(steps)); });
}
template <class T>
rlslab_status update_many(rlslab_outputs* filter, T const* X, std::size_t X_stride, T const* Y, std::size_t Y_stride,
                          std::size_t rows, int leave_out) noexcept {
    if (!filter) return null_among({{"filter", filter}});
    if (rows == 0) return RLSLAB_OK;
    if (!X || !Y) return null_among({{"X", X}, {"Y", Y}});
    X_stride = X_stride ? X_stride : std::size_t(of(filter).size());
    Y_stride = Y_stride ? Y_stride : std::size_t(of(filter).outputs());
    if (std::max(X_stride, Y_stride) > PTRDIFF_MAX / sizeof(double) / rows)
        return failed(RLSLAB_INVALID, "%zu rows of strides %zu and %zu are beyond memory", rows, X_stride, Y_stride);
    return guarded([&] {
        of(filter).update_many({X, Y, index(rows), index(X_stride), index(Y_stride)}, leave_out != 0);
    });
}
template <void (native::Outputs::*member)(double*) const>
rlslab_status numbers(rlslab_outputs const* filter, double* out) noexcept {
    if (!filter || !out) return null_among({{"filter", filter}, {"out", out}});
    return guarded([&] { (of(filter).*member)(out); }, RLSLAB_ABILITY);
}
rlslab_status matrix(rlslab_outputs const* filter, double* out, bool covariance) noexcept {
    if (!filter || !out) return null_among({{"filter", filter}, {"out", out}});
    if (of(filter).reports_covariance() == covariance) return numbers<&native::Outputs::matrix>(filter, out);
    return other_matrix(of(filter).variant(), covariance);
}

}  // namespace

rlslab_status rlslab_outputs_new(char const* variant, char const* arithmetic, std::size_t outputs,
                                 rlslab_options const* options, rlslab_outputs** out) {
    return make(Request{variant, arithmetic, options, 1, outputs}, out, [&](native::Options const& read) {
        return native::make_outputs(variant, arithmetic, index(outputs), read);
    });
}
rlslab_status rlslab_outputs_copy(rlslab_outputs const* filter, rlslab_outputs** out) { return copy(filter, out); }
void rlslab_outputs_free(rlslab_outputs* filter) { delete reinterpret_cast<native::Outputs*>(filter); }
rlslab_status rlslab_outputs_reset(rlslab_outputs* filter) { return reset(filter); }
std::size_t rlslab_outputs_size(rlslab_outputs const* filter) { return filter ? std::size_t(of(filter).size()) : 0; }
std::size_t rlslab_outputs_count(rlslab_outputs const* filter) {
    return filter ? std::size_t(of(filter).outputs()) : 0;
}

rlslab_status rlslab_outputs_update(rlslab_outputs* filter, double const* psi, double const* y, rlslab_step* steps) {
    return update(filter, psi, y, steps);
}
rlslab_status rlslab_outputs_update_f32(rlslab_outputs* filter, float const* psi, float const* y, rlslab_step* steps) {
    return update(filter, psi, y, steps);
}
rlslab_status rlslab_outputs_update_many(rlslab_outputs* filter, double const* X, std::size_t X_stride, double const* Y,
                                         std::size_t Y_stride, std::size_t rows, int leave_out) {
    return update_many(filter, X, X_stride, Y, Y_stride, rows, leave_out);
}
rlslab_status rlslab_outputs_update_many_f32(rlslab_outputs* filter, float const* X, std::size_t X_stride,
                                             float const* Y, std::size_t Y_stride, std::size_t rows, int leave_out) {
    return update_many(filter, X, X_stride, Y, Y_stride, rows, leave_out);
}
rlslab_status rlslab_outputs_add(rlslab_outputs* filter, std::size_t more) {
    if (!filter) return null_among({{"filter", filter}});
    return guarded([&] { of(filter).add_outputs(index(more)); });
}
rlslab_status rlslab_outputs_merge(rlslab_outputs* filter, rlslab_outputs const* newer) { return merge(filter, newer); }

rlslab_status rlslab_outputs_theta(rlslab_outputs const* filter, double* out) {
    return numbers<&native::Outputs::theta>(filter, out);
}
rlslab_status rlslab_outputs_covariance(rlslab_outputs const* filter, double* out) { return matrix(filter, out, true); }
rlslab_status rlslab_outputs_information(rlslab_outputs const* filter, double* out) {
    return matrix(filter, out, false);
}
rlslab_status rlslab_outputs_factor(rlslab_outputs const* filter, double* out) {
    return numbers<&native::Outputs::factor>(filter, out);
}
std::int32_t rlslab_outputs_health(rlslab_outputs const* filter) { return filter ? of(filter).health() : -1; }
std::int64_t rlslab_outputs_left_out(rlslab_outputs const* filter) { return filter ? of(filter).left_out() : -1; }

std::size_t rlslab_outputs_state_size(rlslab_outputs const* filter) { return state_size(filter); }
rlslab_status rlslab_outputs_save(rlslab_outputs const* filter, void* to, std::size_t room) {
    return save(filter, to, room);
}
rlslab_status rlslab_outputs_load(rlslab_outputs* filter, void const* from, std::size_t bytes) {
    return load(filter, from, bytes);
}
rlslab_status rlslab_use_threads(std::size_t threads) {
    return guarded([&] { native::use_threads(index(threads)); });
}
