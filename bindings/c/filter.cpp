// One filter from C: rlslab_filter is a native::Filter.
#include "bindings/c/border.hpp"

#include <rlslab/catalogue/native/theta_path.hpp>

#include <limits>
#include <new>

using namespace rlslab;
using namespace rlslab::c;

namespace {

static_assert(sizeof(rlslab_step) == sizeof(native::Step) && alignof(rlslab_step) == alignof(native::Step));
/// The step is made where the caller wants it: a copy would load what was stored in smaller parts, and wait for it.
template <class Update>
void report(rlslab_step* to, Update const& update) {
    native::Step unwanted;
    ::new (to ? static_cast<void*>(to) : &unwanted) native::Step(update());
}

/// weight: one, or none.
template <class T, class... Weight>
rlslab_status update(rlslab_filter* filter, T const* psi, T y, rlslab_step* step, Weight... weight) noexcept {
    if (!filter || !psi) [[unlikely]]
        return null_among({{"filter", filter}, {"psi", psi}});
    return guarded([&] { report(step, [&] { return of(filter).update(psi, y, weight...); }); });
}
/// OK if the rows, each of `each` bytes where it goes, fit into memory; the stride is d where it was 0.
rlslab_status fit(rlslab_filter const* filter, std::size_t rows, std::size_t& stride, std::size_t each) noexcept {
    std::size_t const d = std::size_t(of(filter).size());
    if (stride == 0) stride = d;
    if (stride < d) return failed(RLSLAB_INVALID, "a stride of %zu, less than the %zu parameters", stride, d);
    if (stride > PTRDIFF_MAX / each / rows)
        return failed(RLSLAB_INVALID, "%zu rows of stride %zu are beyond memory", rows, stride);
    return RLSLAB_OK;
}
template <class T>
rlslab_status update_many(rlslab_filter* filter, T const* psi, std::size_t rows, std::size_t stride, T const* y,
                          T const* weights, rlslab_step* steps, double* theta = nullptr) noexcept {
    if (!filter) return null_among({{"filter", filter}});
    if (rows == 0) return RLSLAB_OK;
    if (!psi || !y) return null_among({{"psi", psi}, {"y", y}});
    if (rlslab_status const status = fit(filter, rows, stride, sizeof(native::Step))) return status;
    auto* const to = reinterpret_cast<native::Step*>(steps);
    return guarded([&] {
        if (theta)
            native::update_many(of(filter), psi, native::Index(rows), native::Index(stride), y, weights, to, theta);
        else of(filter).update_many(psi, native::Index(rows), native::Index(stride), y, weights, to);
    });
}
/// theta is not left out.
template <class T>
rlslab_status update_many_theta(rlslab_filter* filter, T const* psi, std::size_t rows, std::size_t stride, T const* y,
                                rlslab_step* steps, double* theta) noexcept {
    if (filter && rows > 0 && !theta) return null_among({{"theta", theta}});
    return update_many(filter, psi, rows, stride, y, decltype(y)(nullptr), steps, theta);
}
template <void (native::Filter::*member)(double*) const>
rlslab_status numbers(rlslab_filter const* filter, double* out, rlslab_status refused = RLSLAB_INVALID) noexcept {
    if (!filter || !out) return null_among({{"filter", filter}, {"out", out}});
    return guarded([&] { (of(filter).*member)(out); }, refused);
}

}  // namespace

rlslab_status rlslab_new(char const* variant, char const* arithmetic, rlslab_options const* options,
                         rlslab_filter** out) {
    return rlslab_new_certified(variant, arithmetic, options, 0, 0, out);
}
rlslab_status rlslab_new_certified(char const* variant, char const* arithmetic, rlslab_options const* options,
                                   std::size_t probes, std::size_t digits, rlslab_filter** out) {
    return make(Request{variant, arithmetic, options}, out, [&](native::Options read) {
        read.certify = index(probes);
        read.digits = index(digits);
        return native::make(variant, arithmetic, read);
    });
}
rlslab_status rlslab_copy(rlslab_filter const* filter, rlslab_filter** out) { return copy(filter, out); }
void rlslab_free(rlslab_filter* filter) { delete reinterpret_cast<native::Filter*>(filter); }
rlslab_status rlslab_reset(rlslab_filter* filter) { return reset(filter); }
std::size_t rlslab_size(rlslab_filter const* filter) { return filter ? std::size_t(of(filter).size()) : 0; }
char const* rlslab_variant(rlslab_filter const* filter) { return filter ? of(filter).variant().data() : nullptr; }
char const* rlslab_arithmetic(rlslab_filter const* filter) { return filter ? of(filter).arithmetic().data() : nullptr; }

rlslab_status rlslab_update(rlslab_filter* filter, double const* psi, double y, rlslab_step* step) {
    return update(filter, psi, y, step);
}
rlslab_status rlslab_update_f32(rlslab_filter* filter, float const* psi, float y, rlslab_step* step) {
    return update(filter, psi, y, step);
}
rlslab_status rlslab_update_many(rlslab_filter* filter, double const* psi, std::size_t rows, std::size_t stride,
                                 double const* y, rlslab_step* steps) {
    return update_many(filter, psi, rows, stride, y, decltype(y)(nullptr), steps);
}
rlslab_status rlslab_update_many_f32(rlslab_filter* filter, float const* psi, std::size_t rows, std::size_t stride,
                                     float const* y, rlslab_step* steps) {
    return update_many(filter, psi, rows, stride, y, decltype(y)(nullptr), steps);
}
rlslab_status rlslab_update_weighted(rlslab_filter* filter, double const* psi, double y, double weight,
                                     rlslab_step* step) {
    return update(filter, psi, y, step, weight);
}
rlslab_status rlslab_update_weighted_f32(rlslab_filter* filter, float const* psi, float y, float weight,
                                         rlslab_step* step) {
    return update(filter, psi, y, step, weight);
}
rlslab_status rlslab_update_many_weighted(rlslab_filter* filter, double const* psi, std::size_t rows,
                                          std::size_t stride, double const* y, double const* weights,
                                          rlslab_step* steps) {
    return update_many(filter, psi, rows, stride, y, weights, steps);
}
rlslab_status rlslab_update_many_weighted_f32(rlslab_filter* filter, float const* psi, std::size_t rows,
                                              std::size_t stride, float const* y, float const* weights,
                                              rlslab_step* steps) {
    return update_many(filter, psi, rows, stride, y, weights, steps);
}
rlslab_status rlslab_update_many_theta(rlslab_filter* filter, double const* psi, std::size_t rows, std::size_t stride,
                                       double const* y, rlslab_step* steps, double* theta) {
    return update_many_theta(filter, psi, rows, stride, y, steps, theta);
}
rlslab_status rlslab_update_many_theta_f32(rlslab_filter* filter, float const* psi, std::size_t rows,
                                           std::size_t stride, float const* y, rlslab_step* steps, double* theta) {
    return update_many_theta(filter, psi, rows, stride, y, steps, theta);
}
rlslab_status rlslab_pass_time(rlslab_filter* filter, rlslab_step* step) {
    if (!filter) return null_among({{"filter", filter}});
    return guarded([&] { report(step, [&] { return of(filter).pass_time(); }); });
}
rlslab_status rlslab_remove(rlslab_filter* filter, double const* psi, double y, double weight, double* out) {
    if (!filter || !psi) return null_among({{"filter", filter}, {"psi", psi}});
    return guarded(
        [&] {
            native::Removal const removal = of(filter).remove(psi, y, weight);
            if (out) out[0] = removal.remaining, out[1] = removal.noise;
        },
        RLSLAB_ABILITY);
}
rlslab_status rlslab_merge(rlslab_filter* filter, rlslab_filter const* newer) { return merge(filter, newer); }

rlslab_status rlslab_theta(rlslab_filter const* filter, double* out) {
    return numbers<&native::Filter::theta>(filter, out);
}
rlslab_status rlslab_gain(rlslab_filter const* filter, double* out) {
    return numbers<&native::Filter::gain>(filter, out);
}
rlslab_status rlslab_covariance(rlslab_filter const* filter, double* out) {
    return numbers<&native::Filter::covariance>(filter, out, RLSLAB_ABILITY);
}
rlslab_status rlslab_information(rlslab_filter const* filter, double* out) {
    return numbers<&native::Filter::information>(filter, out, RLSLAB_ABILITY);
}
rlslab_status rlslab_certificate(rlslab_filter const* filter, double* out) {
    if (!filter || !out) return null_among({{"filter", filter}, {"out", out}});
    return guarded(
        [&] {
            native::Certificate const found = of(filter).certificate();
            out[0] = found.estimate, out[1] = found.bound, out[2] = found.theta;
        },
        RLSLAB_ABILITY);
}
rlslab_status rlslab_variance(rlslab_filter const* filter, double const* psi, std::size_t rows, std::size_t stride,
                              double* out) {
    if (!filter) return null_among({{"filter", filter}});
    if (rows == 0) return RLSLAB_OK;
    if (!psi || !out) return null_among({{"psi", psi}, {"out", out}});
    if (rlslab_status const status = fit(filter, rows, stride, sizeof(double))) return status;
    return guarded([&] { of(filter).variance(psi, native::Index(rows), native::Index(stride), out); }, RLSLAB_ABILITY);
}
rlslab_status rlslab_factor(rlslab_filter const* filter, double* out) {
    return numbers<&native::Filter::factor>(filter, out, RLSLAB_ABILITY);
}
rlslab_status rlslab_sample(rlslab_filter const* filter, std::uint64_t seed, std::size_t n, double scale, double* out) {
    if (!filter) return null_among({{"filter", filter}});
    if (!(0 <= scale && scale <= std::numeric_limits<double>::max()))
        return failed(RLSLAB_INVALID, "a scale that is not finite, or below 0");
    if (n == 0) return RLSLAB_OK;
    if (!out) return null_among({{"out", out}});
    std::size_t stride = 0;
    if (rlslab_status const status = fit(filter, n, stride, sizeof(double))) return status;
    return guarded([&] { of(filter).sample(seed, native::Index(n), scale, out); },
                   of(filter).stores_a_root() ? RLSLAB_INVALID : RLSLAB_ABILITY);
}
rlslab_status rlslab_least_excited(rlslab_filter const* filter, double* direction, double* out) {
    if (!filter || !direction || !out) return null_among({{"filter", filter}, {"direction", direction}, {"out", out}});
    return guarded(
        [&] {
            native::Excitation const found = of(filter).least_excited(direction);
            out[0] = found.deviation, out[1] = found.ratio;
        },
        RLSLAB_ABILITY);
}
std::int32_t rlslab_health(rlslab_filter const* filter) { return filter ? of(filter).health() : -1; }
std::int32_t rlslab_signal(rlslab_filter const* filter) { return filter ? of(filter).signal() : -1; }

rlslab_status rlslab_count(rlslab_filter const* filter, rlslab_counts* out, std::size_t bytes) {
    if (!filter || !out) return null_among({{"filter", filter}, {"out", out}});
    if (bytes != sizeof *out) return failed(RLSLAB_INVALID, "counts of %zu bytes, not %zu", bytes, sizeof *out);
    native::Counts const c = of(filter).counts();
    *out = {c.rows, c.unusable, c.outliers, c.changes, c.windups, c.breakdowns, c.refactored, c.since, 0};
    return RLSLAB_OK;
}

std::size_t rlslab_state_size(rlslab_filter const* filter) { return state_size(filter); }
rlslab_status rlslab_save(rlslab_filter const* filter, void* to, std::size_t room) { return save(filter, to, room); }
rlslab_status rlslab_load(rlslab_filter* filter, void const* from, std::size_t bytes) {
    return load(filter, from, bytes);
}
rlslab_status rlslab_from_state(void const* from, std::size_t bytes, rlslab_filter** out) {
    if (!out) return null_among({{"out", out}});
    *out = nullptr;
    if (!from) return null_among({{"from", from}});
    return guarded(
        [&] {
            auto made = native::from_state({static_cast<std::byte const*>(from), bytes});
            *out = reinterpret_cast<rlslab_filter*>(made.release());
        },
        RLSLAB_STATE);
}
