// fixed/VARIANT/double/SIZE: the filters whose size the compiler knows.
#include "bench/rows.hpp"

#include <rlslab/variants/variants.hpp>

namespace rlslab::bench {
namespace {

/// Calls visit.operator()<F of size N>(), given the F of dynamic size. Real accepts the templates of a Field as well.
template <int N, template <Real, int> class F, Real T, class Visit>
void fixed(std::type_identity<F<T, Dynamic>>, Visit visit) {
    visit.template operator()<F<T, N>>();
}

template <int N>
void add() {
    for_each(Variants<double>{},
             []<class F>() { fixed<N>(std::type_identity<F>{}, []<class Fixed>() { add_filter_row<Fixed>("fixed", N); }); });
}

[[maybe_unused]] bool const added = [] {
    add<2>();
    add<4>();
    add<8>();
    return true;
}();

}  // namespace
}  // namespace rlslab::bench
