// Where C++ ends: no exception passes, and the calling thread keeps the message of its last error.
#pragma once

#include "bindings/c/rlslab.h"

#include <rlslab/catalogue/native/filter.hpp>

#include <initializer_list>

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

/// The state of a filter or of a fleet: its bytes, 0 where memory is not enough to count them; written; read.
template <class Native>
std::size_t state_size(Native const& native) noexcept {
    std::size_t size = 0;
    guarded([&] { size = native.state_size(); });
    return size;
}
template <class Native>
rlslab_status save(Native const& native, void* to, std::size_t room) noexcept {
    std::size_t size = 0;
    if (rlslab_status const status = guarded([&] { size = native.state_size(); })) return status;
    if (rlslab_status const status = has_room(size, room)) return status;
    return guarded([&] { native.save({static_cast<std::byte*>(to), size}); });
}
template <class Native>
rlslab_status load(Native& native, void const* from, std::size_t bytes) noexcept {
    return guarded([&] { native.load({static_cast<std::byte const*>(from), bytes}); }, RLSLAB_STATE);
}

}  // namespace rlslab::c
