// Rows that are rotated in at the same time leave the bits of one row after another: the kernel against the text for
// single rows, and rows_at_once of qr and extended_qr against update, with whatever rows.
#include "tests/common/each_isa.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/core/process.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/extended_qr.hpp>
#include <rlslab/variants/qr.hpp>

#include <gtest/gtest.h>

#include <bit>

namespace rlslab {
namespace {

/// Rows of white noise; with zeros of both signs and whole rows of them; of every magnitude; with infinities and NaN
/// besides.
enum class Kind { ordinary, zeros, scaled, special };
constexpr Kind kinds[] = {Kind::ordinary, Kind::zeros, Kind::scaled, Kind::special};

template <class T>
T number(Seed& seed, Kind kind) {
    T const x = T(seed.bell());
    auto const chance = seed.next() % 16;
    if (kind == Kind::ordinary) return x;
    if (chance < 4) return chance % 2 ? T(0) : -T(0);
    if (kind == Kind::zeros) return x;
    if (chance < 10) return std::ldexp(x, int(seed.next() % 2001 - 1000) / (sizeof(T) == 8 ? 1 : 8));
    if (chance == 10) return std::numeric_limits<T>::denorm_min() * T(1 + seed.next() % 9);
    if (kind == Kind::special && seed.next() % 64 == 0) {
        T const bad[] = {std::numeric_limits<T>::infinity(), -std::numeric_limits<T>::infinity(),
                         std::numeric_limits<T>::quiet_NaN()};
        return bad[seed.next() % 3];
    }
    return x;
}

template <class T>
bool same(T a, T b) {
    using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b) || (std::isnan(a) && std::isnan(b));
}
template <class T>
bool same(std::vector<T> const& a, std::vector<T> const& b) {
    return std::ranges::equal(a, b, [](T x, T y) { return same(x, y); });
}

// --- the kernel ------------------------------------------------------------------------------------------------------

constexpr Index together = kernels::RotateInRows<double>::together;

/// A triangle with numbers behind every end that no result may depend on, and the rows to be rotated in.
template <class T>
struct Operands {
    Index d, ld;
    std::vector<T, detail::Aligned<T>> L, x, z, c, s;
    T eta[together], r;

    Operands(Index size, Kind kind, Seed seed)
        : d(size), ld(column_stride<T, Dynamic>(size)), L(size_t(ld * d)), x(size_t(ld * together)), z(size_t(ld)),
          c(x), s(x) {
        for (auto* v : {&L, &x, &z, &c, &s})
            for (T& number_of_v : *v) number_of_v = number<T>(seed, kind);
        for (T& e : eta) e = number<T>(seed, kind);
        for (Index i = 0; i < d; ++i) L[size_t(i * ld + i)] = std::abs(L[size_t(i * ld + i)]);
        r = seed.next() % 2 ? T(1) : T(0.9375);
    }
    std::vector<T> results() const {
        std::vector<T> out(eta, eta + together);
        for (Index i = 0; i < d; ++i) {
            out.push_back(z[size_t(i)]);
            for (Index j = 0; j < d; ++j) out.push_back(L[size_t(i * ld + j)]);  // above the diagonal nothing changes
            for (Index n = 0; n < together; ++n)
                out.push_back(c[size_t(n * ld + i)]), out.push_back(s[size_t(n * ld + i)]);
        }
        return out;
    }
    kernels::RotateInRows<T> kernel(bool kept = true) {
        return {d, ld, L.data(), x.data(), z.data(), eta, kept ? c.data() : nullptr, s.data(), r};
    }
    kernels::RotateIn<T> row(Index n) {
        return {d, ld, L.data(), x.data() + n * ld, z.data(), eta + n, c.data() + n * ld, s.data() + n * ld, r};
    }
};

template <class T>
std::vector<T> row_after_row(Operands<T> o) {
    for (Index n = 0; n < together; ++n) kernels::portable::evaluate<kernels::portable::ScalarRow<T>>(o.row(n));
    return o.results();
}

template <class T>
void check_kernel(Index d, Kind kind) {
    Operands<T> const operands(d, kind, Seed{std::uint64_t(d)});
    std::vector<T> const expected = row_after_row(operands);
    auto const check = [&](char const* set, auto run) {
        Operands<T> o = operands;
        run(o.kernel());
        EXPECT_TRUE(same(expected, o.results())) << set << ", " << d << " parameters, kind " << int(kind);
        Operands<T> other = operands;  // no rotations wanted: the rest is the same
        run(other.kernel(false));
        other.c = o.c, other.s = o.s;
        EXPECT_TRUE(same(o.results(), other.results())) << set << ", " << d << " parameters, kind " << int(kind);
    };
    using K = kernels::RotateInRows<T>;
    check("SSE2", [](K const& k) { kernels::portable::run_outlined<kernels::portable::InRegisters<K, T, 16>>(k); });
#ifdef __x86_64__
    if (kernels::best_isa() >= Isa::avx2)
        check("AVX2", [](K const& k) { kernels::avx2::run_outlined<kernels::avx2::InRegisters<K, T, 32>>(k); });
    if constexpr (sizeof(T) == 8)
        if (kernels::best_isa() >= Isa::avx512)
            check("AVX-512",
                  [](K const& k) { kernels::avx512::run_outlined<kernels::avx512::InRegisters<K, T, 64>>(k); });
#endif
}

template <class T>
class RowsInFlightKernel : public testing::Test {};
using HardwareArithmetics = testing::Types<float, double>;
TYPED_TEST_SUITE(RowsInFlightKernel, HardwareArithmetics);

TYPED_TEST(RowsInFlightKernel, LeavesTheBitsOfOneRowAfterAnother) {
    for (Index d = 1; d <= 130; ++d) {
        for (Kind kind : kinds) check_kernel<TypeParam>(d, kind);
        if (testing::Test::HasFailure()) return;  // one size tells enough
    }
}

/// The rotations (row n, column i) in the order of i + lag n. With lag 1 each finds what it needs. The saboteur starts
/// one rotation too early: where two rows turn against one column in one step, the later row comes first.
template <class T>
std::vector<T> interleaved(Operands<T> o, Index lag) {
    for (Index step = 0; step < o.d + lag * (together - 1); ++step)
        for (Index n = together - 1; n >= 0; --n) {
            Index const i = step - lag * n;
            if (i < 0 || i >= o.d) continue;
            auto const k = o.row(n);
            kernels::portable::finish_corner_row(k, 0, i, o.d, k.x);
        }
    return o.results();
}

TYPED_TEST(RowsInFlightKernel, WouldDifferIfARowStartedOneRotationTooEarly) {
    for (Index d : {1, 2, 8, 21}) {
        Operands<TypeParam> const operands(d, Kind::ordinary, Seed{1});
        EXPECT_TRUE(same(row_after_row(operands), interleaved(operands, 1)));
        EXPECT_FALSE(same(row_after_row(operands), interleaved(operands, 0))) << d << " parameters";
    }
}

// --- the filters -----------------------------------------------------------------------------------------------------

template <class F>
std::vector<double> reported(F const& f, Step<typename F::scalar> const& step) {
    using T = typename F::scalar;
    std::vector<double> out{double(step.innovation), double(step.residual), double(step.gamma),
                            double(int(step.health))};
    auto const add = [&](auto const& numbers) {
        for (auto const& x : numbers.reshaped()) out.push_back(double(x));
    };
    add(Vector<T>(f.theta()));
    add(Vector<T>(f.gain()));
    add(Matrix<T>(f.stored().F));
    return out;
}

template <class T>
struct Rows {
    Matrix<T> psi;
    Vector<T> y;

    Rows(Index d, Index count, Kind kind, Seed seed) : psi(d, count), y(count) {
        for (T& x : psi.reshaped()) x = number<T>(seed, kind);
        for (T& x : y) x = number<T>(seed, kind);
        if (kind != Kind::ordinary)
            for (Index k = 0; k < count; k += 5) psi.col(k).setZero();
    }
};

/// Blocks against single rows after each block, and single rows again after them: nothing of a block is left behind.
template <class F>
bool equal(Problem<typename F::scalar> const& problem, Rows<typename F::scalar> const& rows, Index block) {
    using T = typename F::scalar;
    F single(problem), at_once(problem);
    Index const d = problem.size;
    Index k = 0;
    for (; k + block < rows.y.size(); k += block) {
        Step<T> step{};
        for (Index n = k; n < k + block; ++n) step = single.update({rows.psi.col(n).data(), d}, rows.y[n]);
        Step<T> const last = rows_at_once(at_once, rows.psi.middleCols(k, block), rows.y.segment(k, block));
        if (!same(reported(single, step), reported(at_once, last))) return false;
    }
    Step<T> const step = single.update({rows.psi.col(k).data(), d}, rows.y[k]);
    return same(reported(single, step), reported(at_once, at_once.update({rows.psi.col(k).data(), d}, rows.y[k])));
}

template <class F>
void check_filter() {
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
TEST(RowsInFlight, LeaveQrTheBitsOfSingleRowsInDouble) { check_filter<Qr<double>>(); }
TEST(RowsInFlight, LeaveQrTheBitsOfSingleRowsInFloat) { check_filter<Qr<float>>(); }
TEST(RowsInFlight, LeaveExtendedQrTheBitsOfSingleRowsInDouble) { check_filter<ExtendedQr<double>>(); }
TEST(RowsInFlight, LeaveExtendedQrTheBitsOfSingleRowsInFloat) { check_filter<ExtendedQr<float>>(); }

TEST(RowsInFlight, LeaveTheBitsAtFixedSizesAndInOtherArithmetics) {
    auto const check = []<class F>(std::type_identity<F>, Index d) {
        using T = typename F::scalar;
        Seed seed{3};
        Rows<double> const rows(d, 27, Kind::zeros, seed);
        F single(Problem<T>{.size = d}), at_once(Problem<T>{.size = d});
        Matrix<T> const psi = rows.psi.unaryExpr([](double x) { return T(x); });
        Vector<T> const y = rows.y.unaryExpr([](double x) { return T(x); });
        Step<T> step{};
        for (Index k = 0; k < 27; ++k) step = single.update({psi.col(k).data(), d}, y[k]);
        EXPECT_TRUE(same(reported(single, step), reported(at_once, rows_at_once(at_once, psi, y))))
            << d << " parameters";
    };
    check(std::type_identity<Qr<double, 4>>{}, 4);
    check(std::type_identity<Qr<float, 8>>{}, 8);
    check(std::type_identity<Qr<double, 9>>{}, 9);
    check(std::type_identity<Qr<float, 20>>{}, 20);
    check(std::type_identity<ExtendedQr<double, 16>>{}, 16);
    check(std::type_identity<ExtendedQr<float, 3>>{}, 3);
    check(std::type_identity<Qr<long double>>{}, 20);
    check(std::type_identity<ExtendedQr<Chopped<binary16>>>{}, 20);
}

/// Rounding at random draws a number at each operation: another order of operations would draw others.
TEST(RowsInFlight, LeaveTheOrderOfRandomRoundings) {
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
        return reported(filter, step);
    };
    EXPECT_EQ(run(std::type_identity<Qr<T>>{}, 1), run(std::type_identity<Qr<T>>{}, 12));
    EXPECT_EQ(run(std::type_identity<ExtendedQr<T>>{}, 1), run(std::type_identity<ExtendedQr<T>>{}, 12));
}

/// One row of a block is not finite. The rows before it are as they were, and the health after it is that of single
/// rows.
TEST(RowsInFlight, ReportABreakdownInTheMiddleOfABlock) {
    Index const d = 20, count = 14;
    for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e308})
        for (Index at = 0; at < count; ++at) {
            Rows<double> rows(d, count, Kind::ordinary, Seed{4});
            rows.psi(at % d, at) = bad, rows.psi((at + 7) % d, at) = bad;
            Qr<double> single(Problem<double>{.size = d}), at_once = single;
            Step<double> step{};
            for (Index k = 0; k < count; ++k) step = single.update({rows.psi.col(k).data(), d}, rows.y[k]);
            Step<double> const last = rows_at_once(at_once, rows.psi, rows.y);
            EXPECT_TRUE(same(reported(single, step), reported(at_once, last))) << bad << " in row " << at;
            if (!std::isfinite(bad)) {
                EXPECT_EQ(last.health, Health::nonfinite) << bad << " in row " << at;
            }
        }
}

/// y is a view of theta or of the gain: a row changes the y of the rows behind it.
TEST(RowsInFlight, TakeOutputsThatAreViewsOfTheFilterAsSingleRowsDo) {
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
        EXPECT_TRUE(same(reported(single, step), reported(at_once, last)));
    };
    check([](auto const& f) { return f.theta(); });
    check([](auto const& f) { return f.gain(); });
}

TEST(RowsInFlight, AreWhatProcessGivesTheFilter) {
    Rows<double> const rows(30, 150, Kind::ordinary, Seed{1});
    Qr<double> single(Problem<double>{.size = 30}), processed = single;
    Step<double> step{};
    for (Index k = 0; k < 150; ++k) step = single.update({rows.psi.col(k).data(), 30}, rows.y[k]);
    EXPECT_TRUE(same(reported(single, step), reported(processed, process(processed, rows.psi, rows.y))));
    EXPECT_TRUE(TakesRowsAtOnce<Qr<double>> && TakesRowsAtOnce<ExtendedQr<float>>);
}

TEST(RowsInFlight, RefuseOtherShapesBeforeAnyRow) {
    auto const check = []<class F>(F filter) {
        std::vector<double> const before = reported(filter, {});
        EXPECT_THROW(rows_at_once(filter, Matrix<double>::Ones(19, 9), Vector<double>::Ones(9)), std::invalid_argument);
        EXPECT_THROW(rows_at_once(filter, Matrix<double>::Ones(20, 9), Vector<double>::Ones(8)), std::invalid_argument);
        EXPECT_THROW(rows_at_once(filter, Matrix<double>(20, 0), Vector<double>(0)), std::invalid_argument);
        EXPECT_TRUE(same(before, reported(filter, {})));
    };
    check(Qr<double>(Problem<double>{.size = 20}));
    check(ExtendedQr<double>(Problem<double>{.size = 20}));
}

}  // namespace
}  // namespace rlslab
