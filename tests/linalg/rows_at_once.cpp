// Rows that are known in advance leave the bits of one update after another: theta, gain, P, and the last step.
#include "tests/common/each_isa.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/core/process.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <bit>
#include <sys/mman.h>
#include <unistd.h>

namespace rlslab {
namespace {

/// Noise, with zeros of both signs and numbers of other scales.
template <class T>
Matrix<T> noise(Index rows, Index columns, Seed seed) {
    Matrix<T> out(rows, columns);
    for (T& x : out.reshaped()) {
        auto const kind = seed.next() % 16;
        x = kind == 0 ? T(0) : kind == 1 ? -T(0) : std::ldexp(T(seed.bell()), kind == 2 ? 20 : kind == 3 ? -20 : 0);
    }
    return out;
}

template <class F>
std::vector<double> reported(F const& filter, Step<typename F::scalar> const& step) {
    std::vector<double> out{double(step.innovation), double(step.residual), double(step.gamma),
                            double(int(step.health))};
    auto const add = [&](auto const& numbers) {
        for (auto const& x : numbers.reshaped()) out.push_back(double(x));
    };
    add(Vector<typename F::scalar>(filter.theta()));
    add(Vector<typename F::scalar>(filter.gain()));
    auto const stored = filter.stored();
    add(stored.F);
    add(stored.D);
    return out;
}

bool same_bits(std::vector<double> const& a, std::vector<double> const& b) {
    return std::ranges::equal(a, b, [](double x, double y) {
        return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y) || (std::isnan(x) && std::isnan(y));
    });
}

template <class F>
F started(Index size) {
    using T = typename F::scalar;
    return F(Problem<T>{.size = size, .forgetting = T(0.984375)});
}

/// Blocks of `block` rows against single rows, and single rows again after them: nothing of a block is left behind.
template <class F>
bool equal(Index size, Index block, Index blocks = 2) {
    using T = typename F::scalar;
    Matrix<T> const psi = noise<T>(size, blocks * block + 1, Seed{std::uint64_t(size)});
    Vector<T> const y = noise<T>(blocks * block + 1, 1, Seed{7});
    F single = started<F>(size), at_once = single;
    Step<T> step{}, last{};
    for (Index k = 0; k < blocks * block; ++k) step = single.update({psi.col(k).data(), size}, y[k]);
    for (Index k = 0; k < blocks; ++k)
        last = rows_at_once(at_once, psi.middleCols(k * block, block), y.segment(k * block, block));
    if (!same_bits(reported(single, step), reported(at_once, last))) return false;
    Regressor<T> const next(psi.col(blocks * block).data(), size);
    step = single.update(next, y[blocks * block]), last = at_once.update(next, y[blocks * block]);
    return same_bits(reported(single, step), reported(at_once, last));
}

template <template <class, int> class F, class T>
void check() {
    on_each_isa([&] {
        for (Index size = 1; size <= 130; ++size)
            for (Index block : {1, 2, 7})
                EXPECT_TRUE((equal<F<T, Dynamic>>(size, block))) << size << " parameters, blocks of " << block;
        // large ones, where each way through the matrix is taken (dispatch.hpp), with every remainder of a group of
        // columns
        for (Index size : {200, 255, 256, 322, 385, 517, 643, 1028, 1606, 1607})
            EXPECT_TRUE((equal<F<T, Dynamic>>(size, 3))) << size << " parameters";
        EXPECT_TRUE((equal<F<T, Dynamic>>(20, 64))) << "64 rows";
        EXPECT_TRUE((equal<F<T, 4>>(4, 7) && equal<F<T, 8>>(8, 7) && equal<F<T, 20>>(20, 7))) << "fixed sizes";
    });
}

TEST(RowsAtOnce, LeaveConventionalTheBitsOfSingleRowsInDouble) { check<Conventional, double>(); }
TEST(RowsAtOnce, LeaveConventionalTheBitsOfSingleRowsInFloat) { check<Conventional, float>(); }
TEST(RowsAtOnce, LeaveSymmetricTheBitsOfSingleRowsInDouble) { check<Symmetric, double>(); }
TEST(RowsAtOnce, LeaveSymmetricTheBitsOfSingleRowsInFloat) { check<Symmetric, float>(); }
TEST(RowsAtOnce, LeaveUdTheBitsOfSingleRowsInDouble) { check<Ud, double>(); }
TEST(RowsAtOnce, LeaveUdTheBitsOfSingleRowsInFloat) { check<Ud, float>(); }
TEST(RowsAtOnce, LeaveCarlsonTheBitsOfSingleRowsInDouble) { check<Carlson, double>(); }
TEST(RowsAtOnce, LeaveCarlsonTheBitsOfSingleRowsInFloat) { check<Carlson, float>(); }
TEST(RowsAtOnce, LeaveInverseQrTheBitsOfSingleRowsInDouble) { check<InverseQr, double>(); }
TEST(RowsAtOnce, LeaveInverseQrTheBitsOfSingleRowsInFloat) { check<InverseQr, float>(); }

/// Sums that start from 0, not from -0, make another zero of zeros.
TEST(RowsAtOnce, LeaveTheSignsOfZeros) {
    auto const check_signs = []<class F>(F) {
        using T = typename F::scalar;
        for (Index size : {20, 136, 256, 640, 1300}) {
            Matrix<T> const psi = Matrix<T>::Constant(size, 3, -T(0));
            Vector<T> const y = Vector<T>::Ones(3);
            F single = started<F>(size), at_once = single;
            Step<T> step{};
            for (Index k = 0; k < 3; ++k) step = single.update({psi.col(k).data(), size}, y[k]);
            EXPECT_TRUE(same_bits(reported(single, step), reported(at_once, rows_at_once(at_once, psi, y))))
                << F::name << ", " << size;
        }
    };
    on_each_isa([&] {
        check_signs(started<Conventional<double>>(1)), check_signs(started<Conventional<float>>(1));
        check_signs(started<Symmetric<double>>(1)), check_signs(started<Symmetric<float>>(1));
        check_signs(started<Ud<double>>(1)), check_signs(started<Carlson<double>>(1)),
            check_signs(started<InverseQr<double>>(1));
    });
}

/// The regressors end where memory ends.
TEST(RowsAtOnce, ReadNothingBehindTheLastRegressor) {
    Index const size = 397, rows = 3, bytes = size * rows * Index(sizeof(double)), page = sysconf(_SC_PAGESIZE),
                pages = (bytes + page - 1) / page * page;
    auto* const memory = static_cast<char*>(
        mmap(nullptr, size_t(pages + page), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    ASSERT_NE(memory, MAP_FAILED);
    ASSERT_EQ(mprotect(memory + pages, size_t(page), PROT_NONE), 0);
    Eigen::Map<Matrix<double>> psi(reinterpret_cast<double*>(memory + pages - bytes), size, rows);
    psi = noise<double>(size, rows, Seed{3});
    Vector<double> const y = Vector<double>::Ones(rows);
    auto const check_end = [&](auto filter) { EXPECT_EQ(rows_at_once(filter, psi, y).health, Health::sound); };
    check_end(started<Conventional<double>>(size)), check_end(started<Symmetric<double>>(size));
    check_end(started<Ud<double>>(size)), check_end(started<Carlson<double>>(size)),
        check_end(started<InverseQr<double>>(size));
    munmap(memory, size_t(pages + page));
}

/// psi may be a view of what the filter shows: a row then changes those behind it, in a block as one by one.
template <class F, class Shown>
void check_view(Shown shown, char const* what) {
    constexpr Index size = 128;
    Vector<double> const y = noise<double>(3, 1, Seed{2});
    auto const trio = [&] {
        std::vector<F> all(3, started<F>(size));
        for (int i = 0; i < 3; ++i)
            for (Index k = 0; k < 4; ++k)
                all[size_t(i)].update(noise<double>(size, 1, Seed{std::uint64_t(10 * i + k)}).col(0), double(k));
        return all;
    };
    auto single = trio(), at_once = trio();
    auto const regressors = [&](std::vector<F> const& of) {
        return Eigen::Map<Matrix<double> const, 0, Eigen::OuterStride<>>(
            shown(of[0]).data(), size, 3, Eigen::OuterStride<>(sizeof(F) / sizeof(double)));
    };
    Step<double> step{};
    for (Index k = 0; k < 3; ++k) step = single[1].update({regressors(single).col(k).data(), size}, y[k]);
    Step<double> const last = rows_at_once(at_once[1], regressors(at_once), y);
    EXPECT_TRUE(same_bits(reported(single[1], step), reported(at_once[1], last))) << F::name << ", " << what;
}
TEST(RowsAtOnce, MayBeViewsOfTheFilter) {
    auto const check_both = []<class F>(std::type_identity<F>) {
        static_assert(sizeof(F) % sizeof(double) == 0);
        check_view<F>([](F const& f) { return f.theta(); }, "theta");
        check_view<F>([](F const& f) { return f.gain(); }, "gain");
    };
    check_both(std::type_identity<Conventional<double, 128>>()),
        check_both(std::type_identity<Symmetric<double, 128>>());
    check_both(std::type_identity<Ud<double, 128>>()), check_both(std::type_identity<Carlson<double, 128>>());
    check_both(std::type_identity<InverseQr<double, 128>>());
}

TEST(RowsAtOnce, AreRefusedByWhatWasMovedFrom) {
    auto const check_moved = []<class F>(F filter) {
        F const taken = std::move(filter);
        EXPECT_THROW(rows_at_once(filter, Matrix<double>(0, 1), Vector<double>::Ones(1)), std::invalid_argument)
            << F::name;
        EXPECT_THROW(filter.update(Vector<double>(0), 1), std::invalid_argument) << F::name;
        F itself = taken;
        F& same = itself;
        itself = std::move(same);
        EXPECT_THROW(itself.update(Vector<double>::Ones(20).eval(), 1), std::invalid_argument) << F::name;
    };
    check_moved(started<Conventional<double>>(20)), check_moved(started<Ud<double>>(20)),
        check_moved(started<InverseQr<double>>(20));
    check_moved(started<Qr<double>>(20)), check_moved(started<ExtendedQr<double>>(20));
}

/// Rounding at random draws a number at each operation: another order of operations would draw others.
TEST(RowsAtOnce, LeaveTheOrderOfRandomRoundings) {
    using T = Chopped<binary16, Rounding::stochastic>;
    auto const run = [](Index block) {
        Seed draws{1};
        StochasticStream const stream(draws);
        Conventional<T> filter = started<Conventional<T>>(5);
        Seed seed{2};
        Matrix<T> const psi = Matrix<T>::NullaryExpr(5, 12, [&] { return T(seed.bell()); });
        Vector<T> const y = Vector<T>::NullaryExpr(12, [&] { return T(seed.bell()); });
        Step<T> step{};
        for (Index k = 0; k < 12; k += block)
            step = rows_at_once(filter, psi.middleCols(k, block), y.segment(k, block));
        return reported(filter, step);
    };
    EXPECT_EQ(run(1), run(12));
}

TEST(RowsAtOnce, AreWhatProcessGivesTheFilter) {
    Matrix<double> const psi = noise<double>(100, 150, Seed{1});
    Vector<double> const y = noise<double>(150, 1, Seed{2});
    auto single = started<Conventional<double>>(100), processed = single;
    Step<double> step{};
    for (Index k = 0; k < 150; ++k) step = single.update({psi.col(k).data(), 100}, y[k]);
    EXPECT_TRUE(same_bits(reported(single, step), reported(processed, process(processed, psi, y))));
    EXPECT_TRUE(TakesRowsAtOnce<Conventional<double>> && TakesRowsAtOnce<Symmetric<float>> &&
                TakesRowsAtOnce<Ud<float>> && !TakesRowsAtOnce<QrBlock<double>>);
}

TEST(RowsAtOnce, RefuseOtherShapesBeforeAnyRow) {
    auto filter = started<Conventional<double>>(20);
    std::vector<double> const before = reported(filter, {});
    EXPECT_THROW(rows_at_once(filter, Matrix<double>::Ones(19, 3), Vector<double>::Ones(3)), std::invalid_argument);
    EXPECT_THROW(rows_at_once(filter, Matrix<double>::Ones(20, 3), Vector<double>::Ones(2)), std::invalid_argument);
    EXPECT_THROW(rows_at_once(filter, Matrix<double>(20, 0), Vector<double>(0)), std::invalid_argument);
    EXPECT_TRUE(same_bits(before, reported(filter, {})));
}

/// A NaN in a row that is still to come does not reach the rows before it; the report of its own row says so.
TEST(RowsAtOnce, ANanOfTheNextRowComesWithThatRow) {
    Matrix<double> psi = noise<double>(100, 3, Seed{1});
    psi(50, 2) = std::numeric_limits<double>::quiet_NaN();
    auto filter = started<Conventional<double>>(100), two = filter;
    EXPECT_EQ(rows_at_once(two, psi.leftCols(2), Vector<double>::Ones(2)).health, Health::sound);
    EXPECT_EQ(rows_at_once(filter, psi, Vector<double>::Ones(3)).health, Health::nonfinite);
}

/// The saboteur multiplies by the matrix as it was before the change. Of a size for which the pass also multiplies on
/// this instruction set.
TEST(RowsAtOnce, DifferIfTheProductIsOfTheOldMatrix) {
    on_each_isa([] {
        Index d = 1;
        while (!kernels::one_pass_is_faster<kernels::SubtractRankOne<double>>(kernels::isa, d)) ++d;
        StateMatrix<double> A(d);
        StateVector<double> x(d), f(d), right(d), wrong(d);
        Seed seed{5};
        for (Index j = 0; j < d; ++j) {
            x[j] = seed.bell(), f[j] = seed.bell();
            for (Index i = 0; i < d; ++i) A(i, j) = seed.bell();
        }
        DivisorNearOne<double> const by_r(0.875);
        multiply(A, x.data(), wrong);
        NextRow<double, Dynamic> next(d);
        next.announce(x.data());
        subtract_rank_one(A, x, f, by_r, next);
        multiply(A, x.data(), right);
        StateVector<double> ahead(d);
        EXPECT_TRUE(next.move_product(ahead) && !next.move_product(ahead))
            << d << " parameters on " << name_of(kernels::isa);
        EXPECT_EQ(Vector<double>(ahead.view()), Vector<double>(right.view()));
        EXPECT_NE(Vector<double>(ahead.view()), Vector<double>(wrong.view()));
    });
}

}  // namespace
}  // namespace rlslab
