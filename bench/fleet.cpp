// lockstep/VARIANT/double8/SIZE and float16: as many filters as a Pack has lanes, a row each at a time; ns per filter.
// fleet/VARIANT/double8/SIZE and float16: a million filters in the order of memory, one row each; ns per filter, and
// bytes of state moved. ud_steps/: with a report of each filter; ud_missing/: that, and every tenth filter misses its
// samples. ud_guard/ and ud_guard_missing/: the same of guarded filters, whose state's bytes are an upper bound.
#include "bench/rows.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/many/fleet.hpp>
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
    F filter = scored;
    time_rows(
        state, rows * P::lanes, [&] { filter = scored; },
        [&] { return stretch<Theta::unasked>(filter, psi, y, scenario.scored, y.size()); },
        [&] {
            Answer out{least_digits, true};
            for (int i = 0; i < P::lanes; ++i) out.finite = out.finite && lane(filter, i).allFinite();
            return out;
        });
    state.SetLabel(family_of(filter));
}

template <class T, int L>
void add_lockstep(std::string const& arithmetic) {
    for_each(Variants<Pack<T, L>>{}, [&]<class F>() {
        for (Index size : choice().sizes)
            if (size <= 64)  // beyond, the squares of so many filters leave the cache
                add_row("lockstep/" + std::string(F::name) + "/" + arithmetic + "/" + std::to_string(size),
                        [size](benchmark::State& state) { run_lockstep<F>(state, size); });
    });
}

constexpr Index million = 1'000'000;

struct Kind {
    char const* name;
    unsigned threads = 1;
    bool steps = false, missing = false;
};

/// Every filter on the scenario's rows: a row's cost does not depend on its numbers. A timed stretch: a row of each.
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
    time_rows(
        state, million, next,
        [&] {
            return nanoseconds_of([&] {
                if (kind.steps) fleet.update(psi, y, steps, kind.threads);
                else fleet.update(psi, y, kind.threads);
            });
        },
        [&] {
            return Answer{digits(scenario.exact, theta, std::numeric_limits<T>::digits),
                          fleet.theta(million - 1).allFinite()};
        });
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
    add_lockstep<double, 8>("double8");
    add_lockstep<float, 16>("float16");
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
