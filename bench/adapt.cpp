// guard/, window/, state/ and certified/: what is around a filter costs, beside the filter alone
// (update/VARIANT/double/SIZE).
#include "bench/rows.hpp"

#include <rlslab/adapt/certified.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/arithmetic/pair.hpp>
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
        auto const answer = [&] {
            Vector<double> const theta = window.theta();
            return Answer{digits(s.exact, theta, 53), theta.allFinite()};
        };
        time_rows(
            state, window.rows(), [] {}, [&] { return nanoseconds_of([&] { window.refactor(); }); }, answer);
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
        StateFault fault = StateFault::none;
        time_rows(
            state, 1, [] {},
            [&] {
                return nanoseconds_of([&] {
                    save(filter, bytes);
                    fault = load(other, bytes);
                });
            },
            [&] {
                Vector<double> const theta = other.theta();
                return Answer{fault == StateFault::none ? digits(s.exact, theta, 53) : 0, theta.allFinite()};
            });
        state.counters["bytes"] = double(bytes.size());
    });
}

/// Of a fixed size, as on a board. over_ud: an update over one of `ud` alone; check: a check, in updates of `ud`.
template <class T, int N, class L = double>
void add_certified() {
    std::string const word = std::same_as<T, float> ? "float/" : "double/";
    add_row((std::same_as<L, Pair> ? "certified_pairs/ud/" : "certified/ud/") + word + std::to_string(N),
            [](benchmark::State& state) {
                Scenario const& s = tapped_delay_line(N);
                Matrix<T> const psi = s.records.psi.template cast<T>();
                Vector<T> const y = s.records.y.template cast<T>();
                Ud<T, N> alone(problem_in<T>(s.problem));
                Certified<Ud<T, N>, 3, L> filter(problem_in<T>(s.problem));
                double update = std::numeric_limits<double>::infinity(), check = update;
                time_rows(
                    state, y.size(),
                    [&] {
                        update =
                            std::min(update, stretch<Theta::unasked>(alone, psi, y, 0, y.size()) / double(y.size()));
                        check = std::min(check, nanoseconds_of([&] {
                                             auto const found = filter.certificate();
                                             do_not_optimize(found);
                                         }));
                    },
                    [&] { return stretch<Theta::unasked>(filter, psi, y, 0, y.size()); },
                    [&] {
                        return Answer{0, Vector<T>(filter.theta()).allFinite()};
                    });
                state.counters["over_ud"] = double(state.counters["ns_per_update"]) / update;
                state.counters["check"] = check / update;
            });
}

Rows const added([] {
    using T = double;
    add_certified<float, 16>(), add_certified<float, 64>(), add_certified<T, 16>(), add_certified<T, 64>();
    add_certified<T, 16, Pair>(), add_certified<T, 64, Pair>();
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
