// fixed/VARIANT/double/SIZE: filters whose size the compiler knows; fixed/by_hand_VARIANT/double/SIZE: loops by hand.
#include "bench/by_hand.hpp"
#include "bench/choice.hpp"
#include "bench/rows.hpp"

#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::bench {
namespace {

template <int N>
void add() {
    for_each(Variants<double>{}, []<class F>() { add_filter_row<AtSize<F, N>>("fixed", N); });
    if constexpr (N < 8)
        for_each(TypeList<by_hand::Conventional<N>, by_hand::Symmetric<N>, by_hand::Ud<N>, by_hand::Potter<N>,
                          by_hand::Carlson<N>>{},
                 []<class F>() { add_filter_row<F>("fixed", N); });
}

Rows const added([] {
    [&]<size_t... i>(std::index_sequence<i...>) {
        (add<fixed_sizes[i]>(), ...);
    }(std::make_index_sequence<fixed_sizes.size()>());
});

}  // namespace
}  // namespace rlslab::bench
