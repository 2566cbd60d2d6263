// What threads may share (core/concept.hpp), tried. `./lab threads` runs this under the thread sanitizer.
#include "tests/common/laws.hpp"
#include "tests/common/states.hpp"

#include <rlslab/many/fleet.hpp>
#include <rlslab/many/fold_all.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/arithmetic/arithmetics.hpp>
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/reference/certified.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>
#include <thread>
#include <vector>

namespace {

using namespace rlslab;

constexpr Index d = 5, rows = 60;
constexpr int threads = 4;

template <class T>
Problem<T> problem() {
    return {.size = d, .forgetting = T(0.96875), .prior = Prior<T>{.variance = T(1)}};
}
template <class F>
void process_rows(F& f, Records const& records) {
    using T = typename F::scalar;
    for (Index k = 0; k < records.rows(); ++k) {
        Vector<T> const psi = records.psi.col(k).unaryExpr([](double x) { return T(x); });
        f.update(psi, T(records.y[k]));
    }
}
using states::bytes_of;
/// work(0) ... work(threads - 1) at the same time.
template <class Work>
void at_once(Work work) {
    std::vector<std::thread> all;
    for (int t = 0; t < threads; ++t) all.emplace_back(work, t);
    for (std::thread& t : all) t.join();
}

TEST(Threads, ReadAndCopyOneFilterAtTheSameTime) {
    Records const records = laws::noise_records(d, rows, Seed{31});
    for_each(Variants<double>{}, [&]<class F>() {
        F made(problem<double>());
        process_rows(made, records);
        F const& shared = made;
        Vector<double> const theta = shared.theta(), gain = shared.gain();
        auto const state = bytes_of(shared);
        std::vector<int> same(threads, 0);
        at_once([&](int t) {
            for (int i = 0; i < 20; ++i) {
                F own = shared;
                bool const reads = Vector<double>(shared.theta()) == theta && Vector<double>(shared.gain()) == gain &&
                                   bytes_of(shared) == state && shared.stored().F.rows() == d;
                process_rows(own, records);  // a copy is its thread's own
                same[size_t(t)] += reads;
            }
        });
        for (int const times : same) EXPECT_EQ(times, 20) << F::name;
    });
}

/// The same bits as one after another, also where an arithmetic keeps something for each thread.
template <class T>
void update_filters_of_their_own() {
    Records const records = laws::noise_records(d, rows, Seed{31});
    for_each(Variants<T>{}, [&]<class F>() {
        if constexpr (NamesItsState<F>) {
            std::vector<std::vector<std::byte>> left(threads);
            auto const run = [&](int t) {
                Seed seed{std::uint64_t(t + 1)};
                RoundingSeedScope<T> const draws(seed);
                F f(problem<T>());
                process_rows(f, records);
                left[size_t(t)] = bytes_of(f);
            };
            for (int t = 0; t < threads; ++t) run(t);
            auto const in_turn = left;
            at_once(run);
            EXPECT_EQ(left, in_turn) << F::name;
        }
    });
}
TEST(Threads, UpdateFiltersOfTheirOwnInDouble) { update_filters_of_their_own<double>(); }
TEST(Threads, UpdateFiltersOfTheirOwnWhileRoundingAtRandom) {
    update_filters_of_their_own<Chopped<bfloat16, Rounding::stochastic>>();
}

TEST(Threads, WorkInsideTheLibraryOnSharedRows) {
    Records const records = laws::noise_records(d, rows, Seed{31});
    Problem<double> without_prior = problem<double>();
    without_prior.prior.reset();
    auto const one = bytes_of(fold_all<QrBlock<double>>(without_prior, RowsInMemory(records), 1, 8));
    at_once(
        [&](int) { EXPECT_EQ(bytes_of(fold_all<QrBlock<double>>(without_prior, RowsInMemory(records), 3, 8)), one); });

    using F = Ud<Pack<double, 4>, 3>;
    constexpr Index filters = 50;
    Matrix<double> const psi = Matrix<double>::Constant(filters, 3, 0.5);
    Vector<double> const y = Vector<double>::Ones(filters);
    Fleet<F> alone(filters, Problem<double>{.prior = Prior<double>{.variance = 1}}), together = alone;
    for (int k = 0; k < 20; ++k) {
        alone.update(psi, y, 1);
        together.update(psi, y, threads);
    }
    for (Index i = 0; i < filters; ++i) EXPECT_EQ(alone.theta(i), together.theta(i));
}

TEST(Threads, GuardsAndCertificatesAreTheirThreadsOwn) {
    Records const records = laws::noise_records(d, rows, Seed{31});
    Guarded<Ud<double>> first(problem<double>());
    process_rows(first, records);
    Vector<double> const theta = first.theta();
    Vector<Reference> const exact = certified(problem<double>(), records, {rows}).front().theta();
    at_once([&](int) {
        Guarded<Ud<double>> own(problem<double>());
        process_rows(own, records);
        EXPECT_EQ(Vector<double>(own.theta()), theta);
        EXPECT_EQ(certified(problem<double>(), records, {rows}).front().theta(), exact);
    });
}

}  // namespace
