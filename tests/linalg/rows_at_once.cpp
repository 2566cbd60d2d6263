// Rows that are known in advance leave the bits of one update after another: theta, gain, what is stored, and the last
// step. Of the forms that store P or its factor the next product is computed ahead; into R several rows are rotated at
// the same time.
#include "tests/common/each_isa.hpp"
#include "tests/linalg/known_rows.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/core/process.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <sys/mman.h>
#include <unistd.h>

namespace rlslab {
using namespace known_rows;
namespace {

/// These rows one by one and at once: "", or where what is left parts.
template <class F, class Psi, class Y, class T = typename F::scalar>
std::string parted(F& single, F& at_once, Psi const& psi, Y const& y) {
    Step<T> step{};
    for (Index k = 0; k < Index(y.size()); ++k) step = single.update({psi.col(k).data(), psi.rows()}, y[k]);
    return twins::parted(twins::left_by(single, step), twins::left_by(at_once, rows_at_once(at_once, psi, y)));
}
template <class F, class Psi, class Y>
std::string parted_from(F single, Psi const& psi, Y const& y) {
    F at_once = single;
    return parted(single, at_once, psi, y);
}

template <class T>
struct Rows {
    Matrix<T> psi;
    Vector<T> y;

    Rows(Index d, Index count, Kind kind, Seed seed) : psi(d, count), y(count) {
        for (T& x : psi.reshaped()) x = number<T>(seed, kind);
        for (T& x : y) x = number<T>(seed, kind);
        if (kind != Kind::ordinary && kind != Kind::mild)
            for (Index k = 0; k < count; k += 5) psi.col(k).setZero();
    }
};

/// Blocks against single rows after each block, and a single row after them: nothing of a block is left behind.
template <class F>
bool equal(Problem<typename F::scalar> const& problem, Rows<typename F::scalar> const& rows, Index block) {
    F single(problem), at_once(problem);
    Index k = 0;
    for (; k + block < rows.y.size(); k += block)
        if (!parted(single, at_once, rows.psi.middleCols(k, block), rows.y.segment(k, block)).empty()) return false;
    auto const left = [&](F& f) {
        return twins::left_by(f, f.update({rows.psi.col(k).data(), problem.size}, rows.y[k]));
    };
    return twins::parted(left(single), left(at_once)).empty();
}

/// d x columns of mild noise.
template <class T>
Matrix<T> noise(Index d, Index columns, Seed seed) {
    return Rows<T>(d, columns, Kind::mild, seed).psi;
}

template <class F>
F started(Index size) {
    using T = typename F::scalar;
    return F(Problem<T>{.size = size, .forgetting = T(0.984375)});
}
template <class F>
bool equal(Index size, Index block) {
    using T = typename F::scalar;
    return equal<F>({.size = size, .forgetting = T(0.984375)},
                    Rows<T>(size, 2 * block + 1, Kind::mild, Seed{std::uint64_t(size)}), block);
}

// --- a product computed ahead ----------------------------------------------------------------------------------------

template <template <class, int> class F, class T>
void check() {
    on_each_isa([&] {
        for (Index size = 1; size <= 130; ++size)
            for (Index block : {1, 2, 7})
                EXPECT_TRUE((equal<F<T, Dynamic>>(size, block))) << size << " parameters, blocks of " << block;
        // large ones, where each way through the matrix is taken (dispatch.hpp), with every remainder of a group of
        // columns; beyond 1600 one for each arithmetic
        for (Index size : {200, 255, 256, 322, 385, 517, 643, 1028, sizeof(T) == 8 ? 1606 : 1607})
            EXPECT_TRUE((equal<F<T, Dynamic>>(size, 3))) << size << " parameters";
        EXPECT_TRUE((equal<F<T, Dynamic>>(20, 64))) << "64 rows";
        EXPECT_TRUE((equal<F<T, 4>>(4, 7) && equal<F<T, 8>>(8, 7) && equal<F<T, 20>>(20, 7))) << "fixed sizes";
    });
}

template <class T>
void check_all() {
    check<Conventional, T>();
    check<Ud, T>();
    check<UdDelta, T>();
    check<Carlson, T>();
    check<InverseQr, T>();
}

TEST(RowsAtOnce, LeaveTheBitsOfSingleRowsInDouble) { check_all<double>(); }
TEST(RowsAtOnce, LeaveTheBitsOfSingleRowsInFloat) { check_all<float>(); }

/// Sums that start from 0, not from -0, make another zero of zeros.
TEST(RowsAtOnce, LeaveTheSignsOfZeros) {
    auto const check_signs = []<class F>(F) {
        using T = typename F::scalar;
        for (Index size : {20, 136, 256, 640, 1300}) {
            Matrix<T> const psi = Matrix<T>::Constant(size, 3, -T(0));
            Vector<T> const y = Vector<T>::Ones(3);
            EXPECT_EQ(parted_from(started<F>(size), psi, y), "") << F::name << ", " << size;
        }
    };
    on_each_isa([&] {
        check_signs(started<Conventional<double>>(1)), check_signs(started<Conventional<float>>(1));
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
    check_end(started<Conventional<double>>(size));
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
    EXPECT_EQ(twins::parted(twins::left_by(single[1], step), twins::left_by(at_once[1], last)), "")
        << F::name << ", " << what;
}
TEST(RowsAtOnce, MayBeViewsOfTheFilter) {
    for_each(TypeList<Conventional<double, 128>, Ud<double, 128>, Carlson<double, 128>, InverseQr<double, 128>>{},
             []<class F>() {
                 static_assert(sizeof(F) % sizeof(double) == 0);
                 check_view<F>([](F const& f) { return f.theta(); }, "theta");
                 check_view<F>([](F const& f) { return f.gain(); }, "gain");
             });
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
        NextRow<kernels::SubtractRankOne<double>, Dynamic> next(d);
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

// --- rows rotated in together ----------------------------------------------------------------------------------------

template <class F>
void check_rotated() {
    using T = typename F::scalar;
    on_each_isa([] {
        for (Index d = 1; d <= 70; ++d)
            for (Kind kind : kinds)
                for (Index block : {1, 2, 3, 4, 5, 6, 7, 8, 9, 100}) {
                    if (d > 24 && block % 4 != d % 4 && block != 5) continue;  // each rest of either still
                    Problem<T> problem{.size = d, .forgetting = block % 2 ? T(0.984375) : T(1)};
                    if (StartsWithoutPrior<F> && d % 3 == 0) problem.prior.reset();
                    Rows<T> const rows(d, block == 100 ? 101 : 2 * block + 1, kind, Seed{std::uint64_t(d)});
                    EXPECT_TRUE((equal<F>(problem, rows, block)))
                        << d << " parameters, blocks of " << block << ", kind " << int(kind);
                }
    });
}
TEST(RowsAtOnce, LeaveExtendedQrTheBitsOfSingleRowsInDouble) { check_rotated<ExtendedQr<double>>(); }
TEST(RowsAtOnce, LeaveExtendedQrTheBitsOfSingleRowsInFloat) { check_rotated<ExtendedQr<float>>(); }

TEST(RowsAtOnce, LeaveTheBitsAtFixedSizesAndInOtherArithmetics) {
    using Filters =
        TypeList<ExtendedQr<double, 4>, ExtendedQr<float, 8>, ExtendedQr<double, 9>, ExtendedQr<float, 20>,
                 ExtendedQr<double, 16>, ExtendedQr<float, 3>, ExtendedQr<long double>, ExtendedQr<Chopped<binary16>>>;
    for_each(Filters{}, []<class F>() {
        using T = typename F::scalar;
        Index const d = detail::size_of<F> == Dynamic ? 20 : detail::size_of<F>;
        Rows<double> const rows(d, 27, Kind::zeros, Seed{3});
        Matrix<T> const psi = rows.psi.unaryExpr([](double x) { return T(x); });
        Vector<T> const y = rows.y.unaryExpr([](double x) { return T(x); });
        EXPECT_EQ(parted_from(F(Problem<T>{.size = d}), psi, y), "") << d << " parameters";
    });
}

/// One row of a block is not finite. The rows before it are as they were, and the health after it is that of single
/// rows.
TEST(RowsAtOnce, ReportABreakdownInTheMiddleOfABlock) {
    Index const d = 20, count = 14;
    for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e308})
        for (Index at = 0; at < count; ++at) {
            Rows<double> rows(d, count, Kind::ordinary, Seed{4});
            rows.psi(at % d, at) = bad, rows.psi((at + 7) % d, at) = bad;
            ExtendedQr<double> single(Problem<double>{.size = d}), at_once = single;
            EXPECT_EQ(parted(single, at_once, rows.psi, rows.y), "") << bad << " in row " << at;
            if (!std::isfinite(bad)) {
                EXPECT_EQ(single.update({rows.psi.col(0).data(), d}, 1).health, Health::nonfinite) << bad << ' ' << at;
            }
        }
}

/// y is a view of theta or of the gain: a row changes the y of the rows behind it.
TEST(RowsAtOnce, TakeOutputsThatAreViewsOfTheFilterAsSingleRowsDo) {
    Index const d = 12;
    Rows<double> const rows(d, 30, Kind::ordinary, Seed{5});
    ExtendedQr<double> filter(Problem<double>{.size = d, .forgetting = 0.9375});
    for (Index k = 0; k < 30; ++k) filter.update({rows.psi.col(k).data(), d}, rows.y[k]);
    auto const check = [&](auto const& view_of) {
        ExtendedQr<double> single = filter, at_once = filter;
        auto const y = view_of(single);
        Step<double> step{};
        for (Index k = 0; k < d; ++k) step = single.update({rows.psi.col(k).data(), d}, y[k]);
        Step<double> const last = rows_at_once(at_once, rows.psi.leftCols(d), view_of(at_once));
        EXPECT_EQ(twins::parted(twins::left_by(single, step), twins::left_by(at_once, last)), "");
    };
    check([](auto const& f) { return f.theta(); });
    check([](auto const& f) { return f.gain(); });
}

// --- both ------------------------------------------------------------------------------------------------------------

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
    check_moved(started<ExtendedQr<double>>(20));
}

/// Rounding at random draws a number at each operation: another order of operations would draw others.
TEST(RowsAtOnce, LeaveTheOrderOfRandomRoundings) {
    using T = Chopped<binary16, Rounding::stochastic>;
    auto const run = []<class F>(std::type_identity<F>, Index block) {
        Seed draws{1};
        StochasticStream const stream(draws);
        F filter(Problem<T>{.size = 9, .forgetting = T(0.984375)});
        Seed seed{2};
        Matrix<T> const psi = Matrix<T>::NullaryExpr(9, 12, [&] { return T(seed.bell()); });
        Vector<T> const y = Vector<T>::NullaryExpr(12, [&] { return T(seed.bell()); });
        Step<T> step{};
        for (Index k = 0; k < 12; k += block)
            step = rows_at_once(filter, psi.middleCols(k, block), y.segment(k, block));
        return twins::left_by(filter, step);
    };
    twins::expect_one("conventional", run(std::type_identity<Conventional<T>>{}, 1),
                      run(std::type_identity<Conventional<T>>{}, 12));
    twins::expect_one("extendedqr", run(std::type_identity<ExtendedQr<T>>{}, 1),
                      run(std::type_identity<ExtendedQr<T>>{}, 12));
}

TEST(RowsAtOnce, AreWhatProcessGivesTheFilter) {
    auto const check_process = []<class F>(F single) {
        Rows<double> const rows(100, 150, Kind::ordinary, Seed{1});
        F processed = single;
        Step<double> step{};
        for (Index k = 0; k < 150; ++k) step = single.update({rows.psi.col(k).data(), 100}, rows.y[k]);
        twins::expect_one(F::name, twins::left_by(single, step),
                          twins::left_by(processed, process(processed, rows.psi, rows.y)));
    };
    check_process(started<Conventional<double>>(100)), check_process(started<ExtendedQr<double>>(100));
    EXPECT_TRUE(TakesRowsAtOnce<Ud<float>> && TakesRowsAtOnce<ExtendedQr<float>> &&
                !TakesRowsAtOnce<Symmetric<float>> && !TakesRowsAtOnce<QrBlock<double>> &&
                !TakesRowsAtOnce<Qr<double>>);
}

TEST(RowsAtOnce, RefuseOtherShapesBeforeAnyRow) {
    auto const check = []<class F>(F filter) {
        twins::Left const before = twins::left_by(filter, Step<double>{});
        EXPECT_THROW(rows_at_once(filter, Matrix<double>::Ones(19, 9), Vector<double>::Ones(9)), std::invalid_argument);
        EXPECT_THROW(rows_at_once(filter, Matrix<double>::Ones(20, 9), Vector<double>::Ones(8)), std::invalid_argument);
        EXPECT_THROW(rows_at_once(filter, Matrix<double>(20, 0), Vector<double>(0)), std::invalid_argument);
        twins::expect_one(F::name, before, twins::left_by(filter, Step<double>{}));
    };
    check(Conventional<double>(Problem<double>{.size = 20}));
    check(ExtendedQr<double>(Problem<double>{.size = 20}));
}

}  // namespace
}  // namespace rlslab
