// The message of each thread, and requests whose numbers would be beyond memory.
#include "bindings/c/border.hpp"

#include <rlslab/core/misuse.hpp>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <new>
#include <stdexcept>
#include <string>

namespace rlslab::c {
namespace {

thread_local char last[1024];  // not on the heap: "out of memory" fits, too

/// a b, or throws where it is beyond memory.
std::size_t product(std::size_t a, std::size_t b, char const* what) {
    if (!product_fits(a, b))
        throw std::invalid_argument(std::string(what) + ": " + std::to_string(a) + " times " + std::to_string(b) +
                                    " numbers are beyond memory");
    return a * b;
}
/// Asks the system for as much, and gives it back: the first vector of a filter that is much too large would be
/// allocated, and written, before its matrix is refused.
void try_to_allocate(std::size_t bytes) {
    constexpr std::size_t always = 1u << 24;
    if (bytes > always) ::operator delete(::operator new(bytes));
}
void expect_finite(double const* x, std::size_t count, char const* what) {
    if (x && !std::all_of(x, x + count, [](double number) { return std::isfinite(number); }))
        throw std::invalid_argument(std::string(what) + ": a number is not finite");
}
bool is_one_of(std::span<std::string_view const> names, char const* name) {
    return std::ranges::find(names, std::string_view(name)) != names.end();
}

}  // namespace

rlslab_status failed(rlslab_status code, char const* format, ...) noexcept {
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(last, sizeof last, format, arguments);
    va_end(arguments);
    std::replace(std::begin(last), std::end(last), '\n', ' ');
    return code;
}
char const* message() noexcept { return last; }
rlslab_status null_among(std::initializer_list<Argument> arguments) noexcept {
    for (Argument const& argument : arguments)
        if (!argument.pointer) return failed(RLSLAB_NULL, "%s is null", argument.name);
    return failed(RLSLAB_INTERNAL, "no pointer is null");
}
rlslab_status caught(rlslab_status refused) noexcept {
    try {
        throw;
    } catch (std::invalid_argument const& error) {
        return failed(refused, "%s", error.what());
    } catch (std::bad_alloc const&) {
        return failed(RLSLAB_MEMORY, "out of memory");
    } catch (std::length_error const&) {
        return failed(RLSLAB_MEMORY, "beyond memory");
    } catch (std::exception const& error) {
        return failed(RLSLAB_INTERNAL, "%s", error.what());
    } catch (...) {
        return failed(RLSLAB_INTERNAL, "an exception of an unknown type");
    }
}
// A version that appends members admits the sizes of the versions before it here, and reads those into the defaults.
rlslab_status has_bytes(std::size_t bytes) noexcept {
    if (bytes == sizeof(rlslab_options)) return RLSLAB_OK;
    return failed(RLSLAB_INVALID, "options of %zu bytes, not the %zu of version %s (rlslab_defaults sets them)", bytes,
                  sizeof(rlslab_options), rlslab_version());
}
rlslab_status has_room(std::size_t size, std::size_t room) noexcept {
    if (size <= room) return RLSLAB_OK;
    return failed(RLSLAB_ROOM, "the state has %zu bytes, more than the room of %zu", size, room);
}

rlslab_status Request::readable() const noexcept {
    if (!variant || !arithmetic || !options)
        return null_among({{"variant", variant}, {"arithmetic", arithmetic}, {"options", options}});
    return has_bytes(options->bytes);
}
native::Options Request::read() const {
    rlslab_options const& o = *options;
    if (o.control_count > 0 && !o.control_numbers) throw std::invalid_argument("control_count > 0 of no numbers");
    if (o.control_count > 64) throw std::invalid_argument("more control_numbers than any rule has");
    std::size_t const triangles = product(product(o.size, o.size, "size"), filters, "filters"),
                      thetas = product(product(o.size, outputs, "outputs"), filters, "filters"),
                      kept = std::max(o.window, o.rebuild_rows);
    product(kept, o.size + 1, "window or rebuild_rows");
    product(o.noise_memory, 1, "noise_memory");
    try_to_allocate(triangles / 2 * sizeof(float));
    try_to_allocate(thetas * sizeof(float));
    try_to_allocate(kept * (o.size + 1) * sizeof(float));
    expect_finite(&o.prior_variance, 1, "prior_variance");
    expect_finite(o.prior_theta, o.size, "prior_theta");
    expect_finite(o.prior_covariance, o.size * o.size, "prior_covariance");

    native::Options out;
    out.size = native::Index(o.size);
    out.forgetting = o.forgetting;
    out.prior_variance = o.prior_variance;
    out.prior_theta = o.prior_theta;
    out.prior_covariance = o.prior_covariance;
    out.window = native::Index(o.window);
    if (o.guard) out.guard = o.guard;
    if (o.control) out.control = o.control;
    if (o.control_numbers) out.control_numbers = {o.control_numbers, o.control_count};
    out.largest_variance = o.largest_variance;
    out.innovation = o.innovation;
    out.least_noise = o.least_noise;
    out.asymmetry = o.asymmetry;
    out.noise_memory = native::Index(o.noise_memory);
    out.rebuild_rows = native::Index(o.rebuild_rows);
    return out;
}
rlslab_status Request::refused() const noexcept try {
    bool const known = is_one_of(native::variants(), variant) && is_one_of(native::arithmetics(), arithmetic) &&
                       (!options->guard || is_one_of(native::guards(), options->guard)) &&
                       (!options->control || is_one_of(native::controls(), options->control));
    return known ? RLSLAB_INVALID : RLSLAB_NAME;
} catch (...) {  // the lists are made at the first call
    return RLSLAB_MEMORY;
}

native::Index index(std::size_t count) noexcept { return native::Index(std::min(count, std::size_t(PTRDIFF_MAX))); }
rlslab_status no_filter(std::size_t m, std::size_t filters) noexcept {
    return failed(RLSLAB_INVALID, "no filter %zu; there are %zu, from 0", m, filters);
}
rlslab_status other_matrix(std::string_view variant, bool covariance) noexcept {
    return failed(RLSLAB_ABILITY, "%s reports the %s", variant.data(),
                  covariance ? "information, not the covariance" : "covariance, not the information");
}

}  // namespace rlslab::c
