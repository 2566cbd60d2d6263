// fleet/VARIANT/double8/SIZE and float16: a million filters in the order of memory, one row each; ns per filter, and
// bytes of state moved. ud_steps/: with a report of each filter; ud_missing/: that, and every tenth filter misses its
// samples. ud_guard/ and ud_guard_missing/: the same of guarded filters, whose state's bytes are an upper bound.
#include "bench/rows.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/ud.hpp>

namespace rlslab::bench {
namespace {

constexpr Index million = 1'000'000;

struct Kind {
    char const* name;
    unsigned threads = 1;
    bool steps = false, missing = false;
};

/// Every filter on the scenario's rows: what a row costs does not depend on its numbers. A timed stretch is one row of
/// each filter.
template <class F>
void run_fleet(benchmark::State& state, Index size, Kind const& kind) {
    using T = typename F::scalar::lane_type;
    Scenario const& scenario = tapped_delay_line(size);
    Fleet<F> fleet(million, problem_in<T>(scenario.problem));
    Matrix<T> psi(million, size);
    Vector<T> y(million);
    FleetSteps<T> steps(kind.steps ? million : 0);
    Index k = 0;  // the row that comes next; after the last one, the last one again
    auto const next = [&] {
        if (k == scenario.records.rows()) return;
        for (Index i = 0; i < size; ++i) psi.col(i).setConstant(T(scenario.records.psi(i, k)));
        y.setConstant(T(scenario.records.y[k]));
        if (kind.missing)
            for (Index i = 0; i < million; i += 10) y[i] = undefined<T>();
        ++k;
    };
    while (k < scenario.scored) {
        next();
        fleet.update(psi, y, std::thread::hardware_concurrency());
    }
    Vector<double> const theta = fleet.theta(million - 1).template cast<double>();
    Stopwatch watch(state, million);
    for (auto _ : state)
        watch.add(next, [&] {
            return nanoseconds_of([&] {
                if (kind.steps) fleet.update(psi, y, steps, kind.threads);
                else fleet.update(psi, y, kind.threads);
            });
        });
    watch.finish({digits(scenario.exact, theta, std::numeric_limits<T>::digits), fleet.theta(million - 1).allFinite()});
    double const bytes =
        double(fleet.bytes_per_filter()) * 2 + double(size + 1) * sizeof(T);  // read and written; the row
    state.counters["GB_per_s"] = bytes / double(state.counters["ns_per_update"]);
}

template <class F>
void add(std::string const& arithmetic, Index size, std::initializer_list<Kind> kinds) {
    for (Kind const& kind : kinds)
        add_row("fleet/" + std::string(F::name) + kind.name + "/" + arithmetic + "/" + std::to_string(size),
                [=](benchmark::State& state) { run_fleet<F>(state, size, kind); });
}

Rows const added([] {
    Kind const bare{""}, two_threads{"_2_threads", 2}, steps{"_steps", 1, true}, missing{"_missing", 1, true, true};
    add<Ud<Pack<double, 8>, 4>>("double8", 4, {bare, two_threads, steps, missing});
    add<Ud<Pack<float, 16>, 4>>("float16", 4, {bare, two_threads, steps, missing});
    add<Guarded<Ud<Pack<double, 8>, 4>>>("double8", 4,
                                         {{"_guard"}, {"_guard_steps", 1, true}, {"_guard_missing", 1, true, true}});
    add<Conventional<Pack<double, 8>, 4>>("double8", 4, {bare, two_threads});
    add<Conventional<Pack<float, 16>, 4>>("float16", 4, {bare, two_threads});
});

}  // namespace
}  // namespace rlslab::bench
