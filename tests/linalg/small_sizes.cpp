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

/// What a row left: the step, theta, gain, and P or its factor. The zeros of a triangle may differ in sign.
template <class F, class T = typename F::scalar>
std::vector<T> left_by(F const& f, Step<T> const& step) {
    std::vector<T> out{step.innovation, step.residual, step.gamma, T(int(step.health))};
    auto const stored = f.stored();
    for (auto const& numbers : {Matrix<T>(f.theta()), Matrix<T>(f.gain()), Matrix<T>(stored.F), Matrix<T>(stored.D)})
        for (T const& x : numbers.reshaped()) out.push_back(x);
    return out;
}

/// Both are fed until the first step that is not finite. There both report that; the numbers may differ, because blocks
/// of rows multiply the zeros beside a diagonal by infinities.
template <template <class, int> class F, class T, int N>
void check_size(Kind kind, Seed seed) {
    Problem<T> const problem{.size = N, .forgetting = T(0.984375)};
    F<T, Dynamic> dynamic(problem);
    F<T, N> fixed(problem);
    for (int k = 0; k < 200; ++k) {
        std::vector<T> psi(N);
        for (T& x : psi) x = number<T>(seed, kind);
        T const y = number<T>(seed, kind);
        Step<T> const expected = dynamic.update(psi, y), step = fixed.update(psi, y);
        ASSERT_EQ(step.health, expected.health) << F<T, N>::name << ' ' << N << ", row " << k;
        if (expected.health == Health::nonfinite) {
            dynamic = F<T, Dynamic>(problem);
            fixed = F<T, N>(problem);
        } else {
            ASSERT_TRUE(same(left_by(fixed, step), left_by(dynamic, expected)))
                << F<T, N>::name << ' ' << N << ", row " << k << ", numbers of kind " << int(kind);
        }
    }
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

TEST(SmallSizes, OfConventionalLeaveTheBitsOfDynamicSize) { check<Conventional>(); }
TEST(SmallSizes, OfSymmetricLeaveTheBitsOfDynamicSize) { check<Symmetric>(); }
TEST(SmallSizes, OfUdLeaveTheBitsOfDynamicSize) { check<Ud>(); }
TEST(SmallSizes, OfUdDeltaLeaveTheBitsOfDynamicSize) { check<UdDelta>(); }
TEST(SmallSizes, OfPotterLeaveTheBitsOfDynamicSize) { check<Potter>(); }
TEST(SmallSizes, OfCarlsonLeaveTheBitsOfDynamicSize) { check<Carlson>(); }
TEST(SmallSizes, OfCarlsonDeltaLeaveTheBitsOfDynamicSize) { check<CarlsonDelta>(); }
TEST(SmallSizes, OfInverseQrLeaveTheBitsOfDynamicSize) { check<InverseQr>(); }
TEST(SmallSizes, OfInverseQrDeltaLeaveTheBitsOfDynamicSize) { check<InverseQrDelta>(); }

}  // namespace
}  // namespace rlslab
