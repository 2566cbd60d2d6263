// batch/VARIANT/ROWSxSIZE: the variants that take blocks, on many rows; fold_all/THREADS/ROWSxSIZE: the same in parts
// on several cores; reference/ROWSxSIZE: the certified solution.
#include "bench/rows.hpp"

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

/// The digits are proven, and at most the 30 to which the solution is certified.
void reference(benchmark::State& state, Index rows, Index size) {
    Scenario const& scenario = batch(rows, size);
    Stopwatch watch(state, rows);
    double radius = 1;
    for (auto _ : state)
        watch.add([] {},
                  [&] {
                      return nanoseconds_of(
                          [&] { radius = certified(scenario.problem, scenario.records, {rows}).front().radius(); });
                  });
    watch.finish({std::min(-std::log10(radius), 30.0), std::isfinite(radius)});
}

Rows const added([] {
    for_each(Variants<double>{}, []<class F>() {
        if constexpr (TakesBlocks<F> && StartsWithoutPrior<F>) add_blocks<F>();
    });
    for (unsigned threads : {1u, 2u}) add_threads(threads);
    for (Index size : {10, 20})
        add_row("reference/" + shape(100000, size), [=](benchmark::State& state) { reference(state, 100000, size); });
});

}  // namespace
}  // namespace rlslab::bench
