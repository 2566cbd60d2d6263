// Many rows at once: wrong sizes are refused before any row is processed, and every thread computes as the calling one
// would.
#include "tests/common/laws.hpp"

#include <rlslab/many/fold_all.hpp>
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/core/type_list.hpp>
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

TEST(Feed, RefusesOtherSizes) {
    Records const records = laws::noise_records(3, 80, Seed{4});
    for_each(Variants<double>{}, [&]<class F>() {
        Problem<double> const problem{.size = 3};
        auto const theta_after = [&](Index parameters, Index regressors, Index outputs, bool throws) {
            F f(problem);
            Matrix<double> const psi = records.psi.topLeftCorner(std::min<Index>(parameters, 3), regressors).eval();
            Matrix<double> wide = Matrix<double>::Ones(parameters, regressors);
            wide.topRows(psi.rows()) = psi;
            if (throws) EXPECT_THROW(process(f, wide, records.y.head(outputs)), std::invalid_argument) << F::name;
            else process(f, wide, records.y.head(outputs));
            return Vector<double>(f.theta());
        };
        F const untouched(problem);
        EXPECT_EQ(theta_after(3, 50, 80, true), Vector<double>(untouched.theta()))
            << F::name;  // was read beyond the end
        EXPECT_EQ(theta_after(3, 80, 30, true), Vector<double>(untouched.theta())) << F::name;
        EXPECT_EQ(theta_after(2, 80, 80, true), Vector<double>(untouched.theta())) << F::name;
        EXPECT_EQ(theta_after(4, 80, 80, true), Vector<double>(untouched.theta())) << F::name;
        EXPECT_EQ(theta_after(3, 0, 0, false), Vector<double>(untouched.theta())) << F::name;
        EXPECT_NE(theta_after(3, 80, 80, false), Vector<double>(untouched.theta())) << F::name;
    });
}

TEST(FoldAll, RefusesRecordsWithMoreOrFewerOutputs) {
    Records const whole = laws::noise_records(2, 50, Seed{4});
    for (Index const outputs : {0, 30, 49, 51, 80}) {
        Records records = whole;
        records.y = Vector<double>::Ones(outputs);
        EXPECT_THROW(fold_all<QrBlock<double>>(Problem<double>{.size = 2}, RowsInMemory(records), 2, 16),
                     std::invalid_argument)
            << outputs;
    }
}
TEST(FoldAll, OnePartMayBeAsLargeAsAnyNumber) {
    Records const records = laws::noise_records(2, 50, Seed{4});
    using F = QrBlock<double>;
    auto const theta = [&](Index part) {
        return Vector<double>(fold_all<F>(Problem<double>{.size = 2}, RowsInMemory(records), 2, part).theta());
    };
    EXPECT_EQ(theta(std::numeric_limits<Index>::max()), theta(50));
    EXPECT_EQ(theta(51), theta(50));
    EXPECT_GT(theta(50).norm(), 1);
}
TEST(FoldAll, NoRowsAreThePrior) {
    Records const records{.psi = Matrix<double>(2, 0), .y = Vector<double>(0), .names = {}};
    EXPECT_EQ(fold_all<QrBlock<double>>(Problem<double>{.size = 2}, RowsInMemory(records), 3).theta(),
              Vector<double>::Zero(2));
}

/// Everything that a filter of this arithmetic holds after all rows, on so many threads.
template <class T>
Matrix<double> folded(Records const& records, unsigned threads) {
    auto const filter =
        fold_all<QrBlock<T>>(problem_as<T>({.size = records.parameters()}), RowsInMemory(records), threads, 20);
    Matrix<double> out(records.parameters(), records.parameters() + 1);
    out << filter.stored().F.unaryExpr([](T const& x) { return static_cast<double>(x); }),
        Vector<T>(filter.theta()).unaryExpr([](T const& x) { return static_cast<double>(x); });
    return out;
}
TEST(FoldAll, EveryThreadHasTheCallersPrecision) {
    Records const records = laws::noise_records(3, 300, Seed{5});
    for (int const bits : {8, 12, 30, 53}) {
        PrecisionScope const precision(bits);
        Matrix<double> const one = folded<VariablePrecision>(records, 1);
        for (double const x : one.reshaped()) EXPECT_EQ(x, round_to_bits(x, 0, bits));
        for (unsigned const threads : {2u, 3u, 8u})
            for (int again = 0; again < 5; ++again)
                EXPECT_EQ(folded<VariablePrecision>(records, threads), one) << bits << " bits, " << threads;
    }
}
TEST(FoldAll, StochasticRoundingIsThatOfTheSeedOnAnyThreads) {
    Records const records = laws::noise_records(3, 300, Seed{6});
    auto const with_seed = [&](std::uint64_t seed, unsigned threads) {
        Seed own{seed};
        StochasticStream const stream(own);
        Matrix<double> const first = folded<BFloat16Stochastic>(records, threads);
        return std::pair(first,
                         folded<BFloat16Stochastic>(records, threads));  // the seed goes on, whatever the threads
    };
    auto const one = with_seed(9, 1);
    for (unsigned const threads : {2u, 3u, 8u})
        for (int again = 0; again < 5; ++again) EXPECT_EQ(with_seed(9, threads), one) << threads;
    EXPECT_NE(with_seed(10, 1).first, one.first);
    EXPECT_NE(one.first, one.second);
    EXPECT_THROW(folded<BFloat16Stochastic>(records, 2), std::logic_error) << "no seed in the calling thread";
}
TEST(FoldAll, CountsWhatEveryThreadDid) {
    Records const records = laws::noise_records(3, 300, Seed{7});
    auto const operations = [&](unsigned threads) {
        return counted([&] { fold_all<QrBlock<Counted<double>>>({.size = 3}, RowsInMemory(records), threads, 20); });
    };
    EXPECT_GT(operations(1).multiplications, 300 * 9);
    for (unsigned const threads : {2u, 8u}) EXPECT_EQ(operations(threads), operations(1));
}

}  // namespace
}  // namespace rlslab
