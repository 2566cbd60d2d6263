// C -= A B, and what stands on it: the same bits with registers of any width, without them, and on any number of
// threads.
#include "tests/common/each_isa.hpp"
#include "tests/common/same.hpp"

#include <rlslab/adapt/outputs.hpp>
#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/many/threads.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/qr_block.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using kernels::SubtractProduct;

/// C after the product; A and B lie by columns or by rows. `together`: 0, or a saboteur's length of the sums.
template <class T>
std::vector<double> product(Index rows, Index columns, Index depth, bool turned, bool lower, Index together = 0) {
    Seed seed{std::uint64_t(rows + 100 * columns + 10000 * depth)};
    Matrix<T> A(rows, depth), B(depth, columns), C(rows + 3, columns);
    StateVector<T> room(SubtractProduct<T>::room_of);
    for (T& x : A.reshaped()) x = T(float(seed.bell()));
    for (T& x : B.reshaped()) x = T(float(seed.bell()));
    for (T& x : C.reshaped()) x = T(float(seed.bell()));
    if (together > 0) {
        for (Index j = 0; j < columns; ++j)
            for (Index i = 0; i < rows; ++i)
                for (Index from = 0; from < depth; from += together) {
                    T sum(0);
                    for (Index k = from; k < std::min(from + together, depth); ++k) sum += A(i, k) * B(k, j);
                    C(i, j) -= sum;
                }
    } else {
        Matrix<T> const by_rows = A.transpose(), B_by_rows = B.transpose();
        run_kernel<T, Dynamic>(turned ? SubtractProduct<T>{rows, columns, depth, by_rows.data(), depth, 1,
                                                           B_by_rows.data(), columns, 1, C.data(), C.rows(),
                                                           room.data(), lower}
                                      : SubtractProduct<T>{rows, columns, depth, A.data(), 1, rows, B.data(), 1, depth,
                                                           C.data(), C.rows(), room.data(), lower});
    }
    std::vector<double> out;
    for (T const& x : C.reshaped()) out.push_back(static_cast<double>(x));
    return out;
}
template <class T>
void check_products() {
    for (Index rows : {1, 7, 24, 25, 97, 200})
        for (Index columns : {1, 5, 8, 33, 97})
            for (Index depth : {1, 3, 255, 256, 257, 600})
                for (bool lower : {false, true}) {
                    if (lower && columns > rows) continue;
                    auto const plain = product<Counted<T>>(rows, columns, depth, false, lower);
                    on_each_isa([&] {
                        for (bool turned : {false, true})
                            EXPECT_EQ(difference(product<T>(rows, columns, depth, turned, lower), plain), -1)
                                << rows << " x " << columns << " of " << depth << (lower ? ", lower" : "");
                    });
                }
}
TEST(Product, HasTheSameBitsWithAnyRegistersInDouble) { check_products<double>(); }
TEST(Product, HasTheSameBitsWithAnyRegistersInFloat) { check_products<float>(); }
TEST(Product, DiffersIfSumsAreOfAnotherLength) {
    auto const right = product<double>(50, 20, 600, false, false);
    EXPECT_EQ(difference(product<double>(50, 20, 600, false, false, 256), right), -1);
    EXPECT_NE(difference(product<double>(50, 20, 600, false, false, 255), right), -1);
}

// --- blocks of rows: instruction sets, threads -----------------------------------------------------------------------

/// theta and the factor or P of m outputs after blocks of k rows. `cut`: the block in two calls, a saboteur.
template <class F>
std::vector<double> after_blocks(Index d, Index k, Index m, bool cut = false) {
    using T = typename F::scalar;
    Seed seed{std::uint64_t(d + 1000 * k)};
    MultiOutput<F> f(Problem<T>{.size = d, .forgetting = T(0.984375)}, m);
    for (int block = 0; block < 2; ++block) {
        Matrix<T> X(d, k), Y(k, m);
        for (T& x : X.reshaped()) x = T(float(seed.bell()));
        for (T& y : Y.reshaped()) y = T(float(seed.bell()));
        if (cut) {
            f.update_block(X.leftCols(k / 2), Y.topRows(k / 2));
            f.update_block(X.rightCols(k - k / 2), Y.bottomRows(k - k / 2));
        } else {
            f.update_block(X, Y);
        }
    }
    std::vector<double> out;
    Matrix<T> const theta = f.theta(), factor = f.filter().stored().F;
    for (T const& x : theta.reshaped()) out.push_back(static_cast<double>(x));
    for (Index j = 0; j < d; ++j)
        for (Index i = j; i < d; ++i) out.push_back(static_cast<double>(factor(i, j)));
    return out;
}
template <template <class, int> class F, class T>
void check_blocks() {
    for (Index d : {1, 7, 17, 40})
        for (Index k : {1, 5, 16, 37}) {
            auto const plain = after_blocks<F<Counted<T>, Dynamic>>(d, k, 3);
            on_each_isa(
                [&] { EXPECT_EQ(difference(after_blocks<F<T, Dynamic>>(d, k, 3), plain), -1) << d << ", " << k; });
        }
}
TEST(Blocks, HaveTheSameBitsWithAnyRegisters) {
    check_blocks<QrBlock, double>();
    check_blocks<QrBlock, float>();
    check_blocks<JosephRankTwo, double>();
    check_blocks<JosephRankTwo, float>();
}

struct Threads {
    explicit Threads(Index n) { use_threads(n); }
    ~Threads() { use_threads(1); }
};
/// Large enough to be shared (detail::in_team).
template <class F>
void check_threads(Index d, Index k, Index m) {
    auto const alone = after_blocks<F>(d, k, m);
    for (Index n : {2, 3, 7}) {
        Threads const threads(n);
        EXPECT_EQ(difference(after_blocks<F>(d, k, m), alone), -1) << F::name << ", " << n << " threads";
    }
    EXPECT_NE(difference(after_blocks<F>(d, k, m, true), alone), -1) << F::name;
}
TEST(Blocks, HaveTheSameBitsOnAnyNumberOfThreads) {
    for (Index m : {1, 2, 37}) {
        check_threads<QrBlock<double>>(170, 64, m);
        check_threads<QrBlock<float>>(203, 40, m);
        check_threads<JosephRankTwo<double>>(150, 64, m);
        check_threads<JosephRankTwo<float>>(161, 50, m);
    }
    EXPECT_THROW(use_threads(0), std::invalid_argument);
    EXPECT_THROW(use_threads(1025), std::invalid_argument);
}
/// The number of threads changes while blocks are at work.
TEST(Blocks, KeepTheThreadsThatTheyBeganWith) {
    std::atomic<bool> done = false;
    std::thread other([&] {
        for (Index n = 0; !done; ++n) use_threads(1 + n % 3);
    });
    auto const first = after_blocks<QrBlock<float>>(120, 100, 5);
    auto const second = after_blocks<JosephRankTwo<double>>(110, 100, 5);
    for (int k = 0; k < 20; ++k) {
        EXPECT_EQ(difference(after_blocks<QrBlock<float>>(120, 100, 5), first), -1);
        EXPECT_EQ(difference(after_blocks<JosephRankTwo<double>>(110, 100, 5), second), -1);
    }
    done = true;
    other.join();
    use_threads(1);
}
/// Rows whose squares leave the range go one by one, on one thread; merging is a block of its own.
TEST(Blocks, OfThreadsAtTheEndOfTheRangeAndMerged) {
    auto const run = [] {
        Problem<float> const problem{.size = 130, .prior = std::nullopt};
        MultiOutput<QrBlock<float>> a(problem, 3), b(problem, 3);
        Seed seed{4};
        for (float unit : {1.0F, 0x1p-80F}) {
            Matrix<float> X(130, 140), Y(140, 3);
            for (float& x : X.reshaped()) x = float(seed.bell()) * unit;
            for (float& y : Y.reshaped()) y = float(seed.bell());
            a.update_block(X, Y);
            b.update_block(X, Y);
            a.merge(b);
        }
        Matrix<float> const theta = a.theta();
        return std::vector<float>(theta.data(), theta.data() + theta.size());
    };
    auto const alone = run();
    Threads const threads(2);
    EXPECT_EQ(difference(run(), alone), -1);
}

}  // namespace
}  // namespace rlslab
