// update/VARIANT/ARITHMETIC/SIZE: one filter, one row at a time; block/VARIANT/ARITHMETIC/SIZE: rows that are known in
// advance. Compiled once for each arithmetic.
#include "bench/rows.hpp"

#include <rlslab/variants/variants.hpp>

namespace rlslab::bench {
namespace {

Rows const added([] {
    for_each(Variants<RLSLAB_BENCH_SCALAR>{}, []<class F>() {
        for (Index size : choice().sizes) {
            add_filter_row<F>("update", size);
            if constexpr (TakesRowsAtOnce<F>) add_filter_row<F, InBlocks>("block", size);
        }
    });
});

}  // namespace
}  // namespace rlslab::bench
