// batch/VARIANT/ROWSxSIZE: variants that take blocks, on many rows; fold_all/THREADS/ROWSxSIZE: the same in parts on
// several cores. large/VARIANT/double/SIZE: a filter of many parameters, row by row; VARIANT_rows_known: in blocks.
#include "bench/large.hpp"

#include <rlslab/core/type_list.hpp>
#include <rlslab/many/fold_all.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::bench {
namespace {

template <class F>
void add_blocks() {
    add_batch_rows(
        "batch/" + std::string(F::name), [](Records const& records) { return &records; },
        [](Records const* records) {
            F filter({.size = records->parameters(), .forgetting = 1, .prior = std::nullopt});
            process(filter, records->psi, records->y);
            return Vector<double>(filter.theta());
        });
}

void add_threads(unsigned threads) {
    add_batch_rows(
        threads == 1 ? "fold_all/1_thread" : "fold_all/" + std::to_string(threads) + "_threads",
        [](Records const& records) { return &records; },
        [threads](Records const* records) {
            Problem<double> const problem{.size = records->parameters(), .forgetting = 1, .prior = std::nullopt};
            return Vector<double>(fold_all<QrBlock<double>>(problem, RowsInMemory(*records), threads).theta());
        });
}

Rows const added([] {
    for_each(Variants<double>{}, []<class F>() {
        if constexpr (TakesBlocks<F> && StartsWithoutPrior<F>) add_blocks<F>();
    });
    for (unsigned threads : {1u, 2u}) add_threads(threads);
    using T = double;
    for_each(TypeList<Conventional<T>, Ud<T>, UdDelta<T>, Carlson<T>, InverseQr<T>>{}, []<class F>() {
        add_large_rows<F>();
        add_large_rows<F, InBlocks>(std::string(F::name) + "_rows_known");
    });
    for_each(TypeList<Symmetric<T>, CarlsonDelta<T>, InverseQrDelta<T>, Potter<T>, Qr<T>, Gentleman<T>>{},
             []<class F>() { add_large_rows<F>(); });
});

}  // namespace
}  // namespace rlslab::bench
