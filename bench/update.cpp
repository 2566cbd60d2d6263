// Time of one update: update/VARIANT/ARITHMETIC/SIZE. Every row carries the health of its answer: NaN is fast.
#include <benchmark/benchmark.h>
#include <rlslab/model/random.hpp>
#include <rlslab/variants/variants.hpp>

namespace {

using namespace rlslab;

/// Fresh bell-shaped rows all the time would time the generator; 64 recycled ones keep P well-conditioned.
template <class F>
void update(benchmark::State& state) {
    using T = typename F::scalar;
    Index const d = state.range(0);
    Seed seed{1};
    Rows<T> const psi = Rows<T>::NullaryExpr(d, 64, [&seed] { return T(seed.bell()); });
    F filter(Problem<T>{.size = d, .forgetting = T(0.99)});
    Index k = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(filter.update({psi.col(k % 64).data(), d}, T(1)));
        ++k;
    }
    Vector<T> const theta = filter.theta();
    state.counters["ns_per_update"] =
        benchmark::Counter(double(state.iterations()) * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["finite"] = theta.allFinite();
}

template <class T>
void add(char const* arithmetic) {
    for_each(Variants<T>{}, [&]<class F>() {
        auto* const row = benchmark::RegisterBenchmark(("update/" + std::string(F::name) + "/" + arithmetic).c_str(), update<F>);
        for (int size : {4, 16, 64}) row->Arg(size);
    });
}

bool const added = [] {
    add<double>("double");
    add<float>("float");
    return true;
}();

}  // namespace
