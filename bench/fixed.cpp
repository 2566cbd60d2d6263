// fixed/VARIANT/double/SIZE: the filters whose size the compiler knows.
#include "bench/rows.hpp"

#include <rlslab/variants/variants.hpp>

namespace rlslab::bench {
namespace {

template <int N>
void add() {
    for_each(Variants<double>{}, []<class F>() { add_filter_row<AtSize<F, N>>("fixed", N); });
}

[[maybe_unused]] bool const added = [] {
    add<2>();
    add<4>();
    add<8>();
    return true;
}();

}  // namespace
}  // namespace rlslab::bench
