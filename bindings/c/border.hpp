// Where C++ ends: no exception passes, and the calling thread keeps the message of its last error.
#pragma once

#include "bindings/c/rlslab.h"

#include <rlslab/catalogue/native/outputs.hpp>

#include <initializer_list>
#include <type_traits>

namespace rlslab::c {

/// Keeps the message in one line, and returns the code.
[[gnu::cold, gnu::format(printf, 2, 3)]] rlslab_status failed(rlslab_status code, char const* format, ...) noexcept;

struct Argument {
    char const* name;
    void const* pointer;
};
char const* message() noexcept;

/// Names the first that is null.
[[gnu::cold]] rlslab_status null_among(std::initializer_list<Argument> arguments) noexcept;

/// Of the exception that is being handled. `refused`: the code of std::invalid_argument.
[[gnu::cold]] rlslab_status caught(rlslab_status refused) noexcept;

template <class Body>
rlslab_status guarded(Body&& body, rlslab_status refused = RLSLAB_INVALID) noexcept {
    try {
        body();
        return RLSLAB_OK;
    } catch (...) {
        return caught(refused);
    }
}

/// What a filter, or a fleet of so many, or one of so many outputs is made from.
struct Request {
    char const *variant, *arithmetic;
    rlslab_options const* options;
    std::size_t filters = 1, outputs = 1;

    /// Whether no pointer is null, and the options are this version's.
    rlslab_status readable() const noexcept;
    /// Throws std::invalid_argument where a number is beyond memory, std::bad_alloc where the system refuses so much.
    native::Options read() const;
    /// The code where it is refused: RLSLAB_NAME where one of its names is none.
    rlslab_status refused() const noexcept;
};

/// Whether a structure of options with so many bytes is this version's.
rlslab_status has_bytes(std::size_t bytes) noexcept;
/// Whether the state fits into the room.
rlslab_status has_room(std::size_t size, std::size_t room) noexcept;

/// As a number of the native layer, which refuses what is beyond memory.
native::Index index(std::size_t count) noexcept;
/// That filter m is not one of so many; that a variant reports the other matrix than this one.
[[gnu::cold]] rlslab_status no_filter(std::size_t m, std::size_t filters) noexcept;
[[gnu::cold]] rlslab_status other_matrix(std::string_view variant, bool covariance) noexcept;

/// The native object behind a handle.
template <class Handle>
using NativeOf =
    std::conditional_t<std::is_same_v<Handle, rlslab_filter>, native::Filter,
                       std::conditional_t<std::is_same_v<Handle, rlslab_outputs>, native::Outputs, native::Fleet>>;
template <class Handle>
auto& of(Handle* handle) {
    return *reinterpret_cast<NativeOf<Handle>*>(handle);
}
template <class Handle>
auto const& of(Handle const* handle) {
    return *reinterpret_cast<NativeOf<Handle> const*>(handle);
}

/// What every kind of filter does alike: *out is what maker(options) makes, and null where it is refused; a copy;
/// as it was made; the rows of `newer` behind its own; the state, 0 bytes where memory is not enough to count them.
template <class Handle>
rlslab_status make(Request const& request, Handle** out, auto const& maker) noexcept {
    if (!out) return null_among({{"out", out}});
    *out = nullptr;
    if (rlslab_status const status = request.readable()) return status;
    return guarded([&] { *out = reinterpret_cast<Handle*>(maker(request.read()).release()); }, request.refused());
}
template <class Handle>
rlslab_status copy(Handle const* filter, Handle** out) noexcept {
    if (!out) return null_among({{"out", out}});
    *out = nullptr;
    if (!filter) return null_among({{"filter", filter}});
    return guarded([&] { *out = reinterpret_cast<Handle*>(of(filter).clone().release()); });
}
template <class Handle>
rlslab_status reset(Handle* filter) noexcept {
    if (!filter) return null_among({{"filter", filter}});
    return guarded([&] { of(filter).reset(); });
}
template <class Handle>
rlslab_status merge(Handle* filter, Handle const* newer) noexcept {
    if (!filter || !newer) return null_among({{"filter", filter}, {"newer", newer}});
    return guarded([&] { of(filter).merge(of(newer)); },
                   of(filter).variant() == "qr_block" ? RLSLAB_INVALID : RLSLAB_ABILITY);
}
template <class Handle>
std::size_t state_size(Handle const* filter) noexcept {
    std::size_t size = 0;
    if (filter) guarded([&] { size = of(filter).state_size(); });
    return size;
}
template <class Handle>
rlslab_status save(Handle const* filter, void* to, std::size_t room) noexcept {
    if (!filter || !to) return null_among({{"filter", filter}, {"to", to}});
    std::size_t size = 0;
    if (rlslab_status const status = guarded([&] { size = of(filter).state_size(); })) return status;
    if (rlslab_status const status = has_room(size, room)) return status;
    return guarded([&] { of(filter).save({static_cast<std::byte*>(to), size}); });
}
template <class Handle>
rlslab_status load(Handle* filter, void const* from, std::size_t bytes) noexcept {
    if (!filter || !from) return null_among({{"filter", filter}, {"from", from}});
    return guarded([&] { of(filter).load({static_cast<std::byte const*>(from), bytes}); }, RLSLAB_STATE);
}

}  // namespace rlslab::c
