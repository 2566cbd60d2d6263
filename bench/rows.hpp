// How a row of the benchmarks is timed, and what it reports: the same for all groups of rows.
#pragma once

#include "bench/choice.hpp"
#include "bench/scenario.hpp"

#include <rlslab/core/concept.hpp>
#include <rlslab/catalogue/timing.hpp>

#include <benchmark/benchmark.h>
#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace rlslab::bench {

/// The sizes of the batches, for the rows that are timed and for the limits on them.
inline std::vector<int> const batch_sizes{10, 20, 40, 60, 100};
inline int batch_rows(long size) { return size <= 40 ? 200000 : 50000; }  // more than a cache holds, either way
inline std::string shape(long rows, long size) { return std::to_string(rows) + "x" + std::to_string(size); }

/// A file's rows: its add() is called when the options have been read.
class Rows {
    static std::vector<void (*)()>& all() {
        static std::vector<void (*)()> made;
        return made;
    }

public:
    explicit Rows(void (*add)()) { all().push_back(add); }
    static void add_all() {
        for (auto const add : all()) add();
    }
};

/// Set where the class of a user's own is compiled in.
inline bool has_mine = false;

/// What one row reports besides its time.
struct Answer {
    double digits;
    bool finite;
};

/// The rows of a Google Benchmark: timed() gives the nanoseconds that so many updates took, without prepare(). A row is
/// quoted by the least time over all iterations. Google Benchmark's own time is their mean, and contains the cost of
/// stopping and starting its clock.
template <class Prepare, class Timed, class AnswerOf>
void time_rows(benchmark::State& state, Index updates, Prepare prepare, Timed timed, AnswerOf answer) {
    double least = std::numeric_limits<double>::infinity();
    for (auto _ : state) {
        state.PauseTiming();
        prepare();
        state.ResumeTiming();
        least = std::min(least, timed() / double(updates));
    }
    Answer const found = answer();
    state.counters["ns_per_update"] = least;
    state.counters["digits"] = found.digits;
    state.counters["finite"] = found.finite;
}

template <class Run>
void add_row(std::string const& name, Run run) {
    if (choice().has(name)) benchmark::RegisterBenchmark(name.c_str(), run);
}

template <class T>
Problem<T> problem_in(Problem<double> const& problem) {
    Problem<T> out{.size = problem.size, .forgetting = T(problem.forgetting), .prior = std::nullopt};
    if (problem.prior) out.prior = Prior<T>{.variance = T(problem.prior->variance)};
    return out;
}

/// What a filter propagates and how: the page colours its line by that.
template <class F>
std::string family_of(F const& filter) {
    if constexpr (ReportsCovariance<F>)
        return filter.stored().form == Stored<typename F::scalar>::Form::factor ? "factored covariance" : "covariance";
    else return RecursiveLeastSquares<F> ? "information" : "peer";
}

/// The longest of `steps` steps; step(k) gives the nanoseconds that it took. Each step counts with its least time over
/// several runs through all of them, so that other processes do not: what is long in each run is left. Less what the
/// clock itself takes. begin() comes before each run.
template <class Begin, class Step>
double longest_step(Index steps, Begin begin, Step step) {
    constexpr int runs = 20;
    double clock = std::numeric_limits<double>::infinity();
    std::vector<double> least(size_t(steps), clock);
    for (int run = 0; run < runs; ++run) {
        begin();
        clock = std::min(clock, nanoseconds_of([] {}));
        for (Index k = 0; k < steps; ++k) least[size_t(k)] = std::min(least[size_t(k)], step(k));
    }
    return std::ranges::max(least) - clock;
}

/// The times of single updates as they come, in ns, with what the machine did between them; less what the clock takes.
struct Singles {
    double median, p99, longest;
    double p9999;  ///< 99.99 % take no longer; 0 where too few were timed
};
/// Of at least 100000 steps and 0.3 s, so that what interrupts them now and then is among them, but no more than two
/// seconds. Stretches of `steps` steps are restarted by begin().
template <class Begin, class Step>
Singles singles(Index steps, Begin begin, Step step) {
    constexpr size_t enough = 100000;
    double clock = std::numeric_limits<double>::infinity(), spent = 0;
    std::vector<double> times;
    while ((times.size() < enough || spent < 0.3e9) && spent < 2e9) {
        begin();
        clock = std::min(clock, nanoseconds_of([] {}));
        for (Index k = 0; k < steps; ++k) spent += times.emplace_back(step(k));
    }
    std::ranges::sort(times);
    auto const at = [&](double share) {
        return std::max(times[size_t(share * double(times.size() - 1))] - clock, 1.0);
    };
    return {at(0.5), at(0.99), at(1), times.size() < enough ? 0 : at(0.9999)};
}

/// How a filter is given rows first ... last-1: one by one.
struct OneByOne {
    double operator()(auto& filter, auto const& psi, auto const& y, Index first, Index last) const {
        return stretch<Theta::unasked>(filter, psi, y, first, last);
    }
};
/// As many at once as `process` passes.
struct InBlocks {
    double operator()(auto& filter, auto const& psi, auto const& y, Index first, Index last) const {
        return nanoseconds_of([&] {
            constexpr Index at_once = 64;
            for (Index k = first; k < last; k += at_once) {
                Index const count = std::min(at_once, last - k);
                rows_at_once(filter, psi.middleCols(k, count), y.segment(k, count));
            }
            do_not_optimize(filter);
        });
    }
};

/// F, a variant, what is around one, or a peer dressed as one: F(Problem<T>), update(psi, y), theta(); copies are
/// independent. Fed with the scored rows of the scenario it gives its digits; every timed stretch starts from there.
template <class F, class Feed>
class FilterRow {
    using T = typename F::scalar;
    using Rows = Matrix<T>;
    static constexpr Feed feed{};
    Scenario const& scenario_;
    Rows psi_;
    Vector<T> y_;
    F scored_;
    double digits_;

    static Vector<double> theta(F const& filter) { return Vector<T>(filter.theta()).template cast<double>(); }

    /// The least over a few stretches of calls, as short as the clock allows.
    static double nanoseconds_of_theta(F const& filter) {
        double least = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 20; ++k) {
            constexpr int calls = 16;
            least = std::min(least, nanoseconds_of([&] {
                                        for (int i = 0; i < calls; ++i) {
                                            auto const& answer = filter.theta();
                                            do_not_optimize(answer);
                                        }
                                    }) / calls);
        }
        return least;
    }

public:
    explicit FilterRow(Scenario const& scenario)
        : scenario_(scenario), psi_(scenario_.records.psi.template cast<T>()),
          y_(scenario_.records.y.template cast<T>()), scored_(problem_in<T>(scenario_.problem)) {
        feed(scored_, psi_, y_, 0, scenario_.scored);
        digits_ = digits(scenario_.exact, theta(scored_), std::numeric_limits<T>::digits);
    }
    void run(benchmark::State& state) const {
        Index const rows = y_.size() - scenario_.scored;
        F filter = scored_;
        time_rows(
            state, rows, [&] { filter = scored_; }, [&] { return feed(filter, psi_, y_, scenario_.scored, y_.size()); },
            [&] {
                return Answer{digits_, theta(filter).allFinite()};
            });
        state.SetLabel(family_of(filter));
        if (!std::same_as<Feed, OneByOne>) return;
        state.counters["ns_theta"] = nanoseconds_of_theta(filter);
        auto const begin = [&] { filter = scored_; };
        auto const step = [&](Index k) {
            return stretch<Theta::unasked>(filter, psi_, y_, scenario_.scored + k, scenario_.scored + k + 1);
        };
        state.counters["ns_longest"] = longest_step(rows, begin, step);
        if (choice().made) {
            Singles const single = singles(rows, begin, step);
            state.counters["ns_p50"] = single.median, state.counters["ns_p99"] = single.p99;
            state.counters["ns_p9999"] = single.p9999, state.counters["ns_largest"] = single.longest;
        }
    }
};

/// group/NAME/ARITHMETIC/SIZE. Google Benchmark calls a row several times; its scored filter is made once.
template <class F, class Feed = OneByOne>
void add_filter_row(std::string const& group, Index size, Scenario const& (*scenario)(Index) = tapped_delay_line) {
    std::string const arithmetic = std::same_as<typename F::scalar, float> ? "float" : "double";
    add_row(group + "/" + std::string(F::name) + "/" + arithmetic + "/" + std::to_string(size),
            [=](benchmark::State& state) {
                static std::map<Index, FilterRow<F, Feed>> made;
                try {
                    made.try_emplace(size, scenario(size)).first->second.run(state);
                } catch (std::exception const& error) {  // of a class of somebody's own
                    state.SkipWithError(error.what());
                } catch (...) {
                    state.SkipWithError("threw what is no std::exception");
                }
            });
}

/// A whole set of rows at once: times solve(input) -> theta. input = prepare(records) is made anew for each iteration,
/// outside the time: a copy of what the library overwrites, in the layout in which it is fastest.
template <class Prepare, class Solve>
void run_batch(benchmark::State& state, Scenario const& scenario, Prepare prepare, Solve solve) {
    Vector<double> theta;
    std::optional<decltype(prepare(scenario.records))> input;
    time_rows(
        state, scenario.records.rows(), [&] { input.emplace(prepare(scenario.records)); },
        [&] { return nanoseconds_of([&] { theta = solve(*input); }); },
        [&] {
            return Answer{digits(scenario.exact, theta, std::numeric_limits<double>::digits), theta.allFinite()};
        });
}

/// group/NAME/ROWSxSIZE for every batch shape.
template <class Prepare, class Solve>
void add_batch_rows(std::string const& name, Prepare prepare, Solve solve) {
    for (Index size : batch_sizes)
        add_row(name + "/" + shape(batch_rows(size), size),
                [=](benchmark::State& state) { run_batch(state, batch(batch_rows(size), size), prepare, solve); });
}

}  // namespace rlslab::bench
