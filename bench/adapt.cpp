// guard/, window/ and state/: what is around a filter costs, beside the filter alone (update/VARIANT/double/SIZE).
#include "bench/rows.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/adapt/window.hpp>
#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/inverse_qr.hpp>
#include <rlslab/variants/potter.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>

namespace rlslab::bench {
namespace {

/// A full window: each row takes another one back. refactor/: the kept rows factored anew, once in a while.
template <class F>
struct InWindow : Windowed<F> {
    explicit InWindow(Problem<double> const& problem) : Windowed<F>(problem, {.rows = window_rows(problem.size)}) {}
};

template <class F>
void add_window(Index size) {
    add_filter_row<InWindow<F>>("window", size, window_of_delay_line);
    add_row("refactor/" + std::string(F::name) + "/double/" + std::to_string(size), [size](benchmark::State& state) {
        Scenario const& s = rows_of_window(size);
        InWindow<F> window(s.problem);
        stretch<Theta::unasked>(window, s.records.psi, s.records.y, 0, s.scored);
        Stopwatch watch(state, window.rows());
        for (auto _ : state) watch.add([] {}, [&] { return nanoseconds_of([&] { window.refactor(); }); });
        Vector<double> const theta = window.theta();
        watch.finish({digits(s.exact, theta, 53), theta.allFinite()});
    });
}

/// A state saved and loaded again; the digits are those of the filter that took it.
template <class F>
void add_state(Index size) {
    add_row("state/" + std::string(F::name) + "/double/" + std::to_string(size), [size](benchmark::State& state) {
        Scenario const& s = tapped_delay_line(size);
        F filter(s.problem), other(s.problem);
        stretch<Theta::unasked>(filter, s.records.psi, s.records.y, 0, s.scored);
        std::vector<std::byte> bytes(state_size(filter));
        Stopwatch watch(state, 1);
        StateFault fault = StateFault::none;
        for (auto _ : state)
            watch.add([] {},
                      [&] {
                          return nanoseconds_of([&] {
                              save(filter, bytes);
                              fault = load(other, bytes);
                          });
                      });
        Vector<double> const theta = other.theta();
        watch.finish({fault == StateFault::none ? digits(s.exact, theta, 53) : 0, theta.allFinite()});
        state.counters["bytes"] = double(bytes.size());
    });
}

Rows const added([] {
    using T = double;
    for (Index const size : {4, 16, 32, 64, 128}) {
        for_each(TypeList<Conventional<T>, Symmetric<T>, Potter<T>, Ud<T>, UdDelta<T>, InverseQr<T>, Qr<T>>{},
                 [size]<class F>() { add_filter_row<Guarded<F>>("guard", size); });
        for_each(TypeList<Conventional<T>, Symmetric<T>, Ud<T>, UdDelta<T>, Qr<T>, Gentleman<T>>{},
                 [size]<class F>() { add_window<F>(size); });
        for_each(TypeList<Ud<T>, UdDelta<T>, Qr<T>>{}, [size]<class F>() { add_state<F>(size); });
    }
});

}  // namespace
}  // namespace rlslab::bench
