// States as bytes: damaged, forged, and of which a filter takes all members but one.
#pragma once

#include <rlslab/state/state.hpp>

#include <vector>

namespace rlslab::states {

using Bytes = std::vector<std::byte>;

template <class F>
Bytes bytes_of(F const& f) {
    auto const bytes = state_of(f);
    return {bytes.begin(), bytes.end()};
}
/// With a checksum that is right.
inline Bytes sealed(Bytes bytes) {
    std::size_t const end = bytes.size() - StateHeader::checksum;
    Checksum sum;
    sum.add(std::span(bytes).first(end));
    detail::write_low(sum.value(), StateHeader::checksum, bytes.data() + end);
    return bytes;
}
/// offer(bytes) with each bit flipped, of each lesser length, with each byte gone or twice.
void each_damaged(Bytes const& whole, auto offer) {
    for (std::size_t i = 0; i < 8 * whole.size(); ++i) {
        Bytes bytes = whole;
        bytes[i / 8] ^= std::byte(1 << i % 8);
        offer(bytes);
    }
    for (std::ptrdiff_t n = 0; n < std::ssize(whole); ++n) {
        Bytes less = whole, more = whole;
        less.erase(less.begin() + n);
        more.insert(more.begin() + n, whole[std::size_t(n)]);
        offer(Bytes(whole.begin(), whole.begin() + n)), offer(less), offer(more);
    }
}
/// g is f but for its i-th member.
template <std::size_t i, class F>
void take_all_but(F& g, F const& f) {
    auto to = F::state(g);
    auto const from = F::state(f);
    [&]<std::size_t... j>(std::index_sequence<j...>) {
        ((j == i ? void() : void(std::get<j>(to) = std::get<j>(from))), ...);
    }(std::make_index_sequence<std::tuple_size_v<decltype(to)>>());
}

}  // namespace rlslab::states
