// block/VARIANT/ARITHMETIC/SIZE: one filter, rows that are known in advance, as many at once as `process` passes.
#include "bench/rows.hpp"

#include <rlslab/core/process.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::bench {
namespace {

/// The rows of update/, for the forms that take several at once.
template <class F>
void run_blocks(benchmark::State& state, Index size) {
    using T = typename F::scalar;
    Scenario const& scenario = tapped_delay_line(size);
    Matrix<T> const psi = scenario.records.psi.template cast<T>();
    Vector<T> const y = scenario.records.y.template cast<T>();
    Index const scored = scenario.scored, rows = y.size() - scored;
    F start(problem_in<T>(scenario.problem));
    process(start, psi.leftCols(scored), y.head(scored));
    auto const theta = [](F const& filter) {
        return Vector<double>(Vector<T>(filter.theta()).template cast<double>());
    };
    double const start_digits = digits(scenario.exact, theta(start), std::numeric_limits<T>::digits);
    Stopwatch watch(state, rows);
    F filter = start;
    for (auto _ : state)
        watch.add([&] { filter = start; },
                  [&] {
                      return nanoseconds_of([&] {
                          constexpr Index at_once = 64;
                          for (Index k = scored; k < y.size(); k += at_once) {
                              Index const count = std::min(at_once, y.size() - k);
                              rows_at_once(filter, psi.middleCols(k, count), y.segment(k, count));
                          }
                          do_not_optimize(filter);
                      });
                  });
    watch.finish({start_digits, theta(filter).allFinite()});
    state.SetLabel(family_of(filter));
}

template <class T>
void add(std::string const& arithmetic) {
    for_each(Variants<T>{}, [&]<class F>() {
        if constexpr (TakesRowsAtOnce<F>)
            for (Index size : choice().sizes)
                add_row("block/" + std::string(F::name) + "/" + arithmetic + "/" + std::to_string(size),
                        [size](benchmark::State& state) { run_blocks<F>(state, size); });
    });
}

Rows const added([] {
    add<double>("double");
    add<float>("float");
});

}  // namespace
}  // namespace rlslab::bench
