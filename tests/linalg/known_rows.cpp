// Rows rotated in several at a time leave the bits of the text for single rows; so do filters of fixed size.
#include "tests/linalg/known_rows.hpp"

#include <rlslab/linalg/sweeps.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {

using namespace known_rows;
namespace {

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
    kernels::RotateInRows<T> kernel() { return {d, ld, L.data(), x.data(), z.data(), eta, c.data(), s.data(), r}; }
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
    on_each_set<T>([&](char const* set, auto evaluate) {
        Operands<T> o = operands;
        evaluate(o.kernel());
        EXPECT_TRUE(same(expected, o.results())) << set << ", " << d << " parameters, kind " << int(kind);
    });
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

// Filters of fixed size 1 to 8, whose kernels have a text without loops (kernels/small.hpp), leave the bits of those of
// dynamic size: steps, theta, gain and what is stored, for ordinary and hostile rows.

/// Where a step is not finite both begin anew: blocks of rows multiply the zeros beside a diagonal by infinities, and
/// the numbers may differ.
template <template <class, int> class F, class T, int N>
void check_size(Kind kind, Seed seed) {
    Problem<T> const problem{.size = N, .forgetting = T(0.984375)};
    auto const act = [&problem]<class V>(V& f, twins::Row<T> const& row) {
        Step<T> const step = f.update(row.psi, row.y);
        if (step.health != Health::nonfinite) return step;
        f = V(problem);
        return Step<T>{T(0), T(0), T(0), Health::nonfinite};
    };
    twins::Rows const rows = rows_of<T>(N, 200, kind, seed);
    twins::expect_one(F<T, N>::name, twins::trace(F<T, N>(problem), rows, false, act),
                      twins::trace(F<T, Dynamic>(problem), rows, false, act));
}
template <template <class, int> class F, class T, int... N>
void check_sizes(std::integer_sequence<int, N...>) {
    for (Kind kind : kinds) (check_size<F, T, N + 1>(kind, Seed{std::uint64_t(8 * int(kind) + N)}), ...);
}
/// Sizes 1 to 8 of double; of float 3, none of whose rows fill a register, and 6.
template <template <class, int> class... F>
void check() {
    (check_sizes<F, double>(std::make_integer_sequence<int, 8>()), ...);
    (check_sizes<F, float>(std::integer_sequence<int, 2, 5>()), ...);
}

TEST(SmallSizes, LeaveTheBitsOfDynamicSize) {
    check<Conventional, Symmetric, Ud, UdDelta, Potter, Carlson, CarlsonDelta, InverseQr, InverseQrDelta>();
}

}  // namespace
}  // namespace rlslab
