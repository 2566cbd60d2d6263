// Filters of fixed size 1 to 8, whose kernels have a text without loops (kernels/small.hpp), leave the bits of those of
// dynamic size: steps, theta, gain and what is stored, for ordinary and hostile rows.
#include "tests/linalg/known_rows.hpp"

#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/carlson_delta.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/inverse_qr.hpp>
#include <rlslab/variants/inverse_qr_delta.hpp>
#include <rlslab/variants/potter.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>

#include <gtest/gtest.h>

namespace rlslab {
using namespace known_rows;
namespace {

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
template <template <class, int> class F>
void check() {
    check_sizes<F, double>(std::make_integer_sequence<int, 8>());
    check_sizes<F, float>(std::integer_sequence<int, 2, 5>());
}

TEST(SmallSizes, LeaveTheBitsOfDynamicSize) {
    check<Conventional>();
    check<Symmetric>();
    check<Ud>();
    check<UdDelta>();
    check<Potter>();
    check<Carlson>();
    check<CarlsonDelta>();
    check<InverseQr>();
    check<InverseQrDelta>();
}

}  // namespace
}  // namespace rlslab
