// lockstep/VARIANT/double8/SIZE and float16: as many filters as a Pack has lanes, one row each at a time; ns per
// filter.
#include "bench/rows.hpp"

#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::bench {
namespace {

/// F over a Pack, every lane on the scenario's rows: what a row costs does not depend on its numbers.
template <class F>
void run_lockstep(benchmark::State& state, Index size) {
    using P = typename F::scalar;
    using T = typename P::lane_type;
    Scenario const& scenario = tapped_delay_line(size);
    Matrix<P> const psi = scenario.records.psi.unaryExpr([](double x) { return P(T(x)); });
    Vector<P> const y = scenario.records.y.unaryExpr([](double x) { return P(T(x)); });
    Problem<double> const& p = scenario.problem;
    F scored(Problem<P>{
        .size = size, .forgetting = P(T(p.forgetting)), .prior = Prior<P>{.variance = P(T(p.prior->variance))}});
    stretch<Theta::unasked>(scored, psi, y, 0, scenario.scored);
    auto const lane = [](F const& filter, int i) {
        return Vector<double>(Vector<P>(filter.theta()).unaryExpr([i](P const& x) { return double(x[i]); }));
    };
    double least_digits = std::numeric_limits<double>::infinity();
    for (int i = 0; i < P::lanes; ++i)
        least_digits = std::min(least_digits, digits(scenario.exact, lane(scored, i), std::numeric_limits<T>::digits));
    Index const rows = y.size() - scenario.scored;
    Stopwatch watch(state, rows * P::lanes);
    F filter = scored;
    for (auto _ : state)
        watch.add([&] { filter = scored; },
                  [&] { return stretch<Theta::unasked>(filter, psi, y, scenario.scored, y.size()); });
    bool finite = true;
    for (int i = 0; i < P::lanes; ++i) finite = finite && lane(filter, i).allFinite();
    watch.finish({least_digits, finite});
    state.SetLabel(family_of(filter));
}

template <class T, int L>
void add(std::string const& arithmetic) {
    for_each(Variants<Pack<T, L>>{}, [&]<class F>() {
        for (Index size : choice().sizes)
            if (size <= 64)  // beyond, the squares of so many filters leave the cache
                add_row("lockstep/" + std::string(F::name) + "/" + arithmetic + "/" + std::to_string(size),
                        [size](benchmark::State& state) { run_lockstep<F>(state, size); });
    });
}

Rows const added([] {
    add<double, 8>("double8");
    add<float, 16>("float16");
});

}  // namespace
}  // namespace rlslab::bench
