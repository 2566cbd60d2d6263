// fixed/VARIANT/double/SIZE: the filters whose size the compiler knows; fixed/by_hand_VARIANT/double/SIZE: hand-written
// loops.
#include "bench/by_hand.hpp"
#include "bench/choice.hpp"
#include "bench/rows.hpp"

#include <rlslab/variants/variants.hpp>

namespace rlslab::bench {
namespace {

template <int N>
void add() {
    for_each(Variants<double>{}, []<class F>() { add_filter_row<AtSize<F, N>>("fixed", N); });
    if constexpr (N < 8) {
        add_filter_row<by_hand::Conventional<N>>("fixed", N);
        add_filter_row<by_hand::Symmetric<N>>("fixed", N);
        add_filter_row<by_hand::Ud<N>>("fixed", N);
        add_filter_row<by_hand::Potter<N>>("fixed", N);
        add_filter_row<by_hand::Carlson<N>>("fixed", N);
    }
}

Rows const added([] {
    [&]<size_t... i>(std::index_sequence<i...>) {
        (add<fixed_sizes[i]>(), ...);
    }(std::make_index_sequence<fixed_sizes.size()>());
});

}  // namespace
}  // namespace rlslab::bench
