// sparse/VARIANT/SIZE: rows with two numbers that are not zero; blocks where the variant takes them.
#include "bench/rows.hpp"

#include <rlslab/core/process.hpp>
#include <rlslab/variants/cholesky_sparse.hpp>
#include <rlslab/variants/qr_sparse.hpp>

namespace rlslab::bench {
namespace {

template <class F>
void add() {
    for (Index size : {64, 128, 256})
        add_row("sparse/" + std::string(F::name) + "/" + std::to_string(size), [size](benchmark::State& state) {
            Scenario const& scenario = interpolation(size);
            run_batch(
                state, scenario, [&](Records const&) { return F(scenario.problem); },
                [&](F& filter) {
                    process(filter, scenario.records.psi, scenario.records.y);
                    return Vector<double>(filter.theta());
                });
        });
}

Rows const added([] {
    add<CholeskySparse>();
    add<QrSparse>();
});

}  // namespace
}  // namespace rlslab::bench
