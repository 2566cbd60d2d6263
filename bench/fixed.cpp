// fixed/VARIANT/double/SIZE: the filters whose size the compiler knows; fixed/by_hand_VARIANT/double/SIZE: hand-written
// loops.
#include "bench/by_hand.hpp"
#include "bench/rows.hpp"

#include <rlslab/variants/variants.hpp>

namespace rlslab::bench {
namespace {

template <int N>
void add() {
    for_each(Variants<double>{}, []<class F>() { add_filter_row<AtSize<F, N>>("fixed", N); });
}
template <int N>
void add_by_hand() {
    add_filter_row<by_hand::Conventional<N>>("fixed", N);
    add_filter_row<by_hand::Symmetric<N>>("fixed", N);
    add_filter_row<by_hand::Ud<N>>("fixed", N);
    add_filter_row<by_hand::Potter<N>>("fixed", N);
    add_filter_row<by_hand::Carlson<N>>("fixed", N);
}

Rows const added([] {
    add<2>();
    add<3>();
    add<4>();
    add<6>();
    add<8>();
    add_by_hand<2>();
    add_by_hand<3>();
    add_by_hand<4>();
    add_by_hand<6>();
});

}  // namespace
}  // namespace rlslab::bench
