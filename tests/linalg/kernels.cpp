// One order of evaluation: every variant gives the same bits on each instruction set, at a fixed size, and in a scalar
// that the kernels' registers know nothing of (Counted: the hardware's arithmetic through the text for any arithmetic).
#include "tests/common/each_isa.hpp"
#include "tests/common/same.hpp"

#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

/// Every number that a filter reports on its way and at its end, over rows of noise with zeros of both signs among
/// them; from `exponents` > 0 on with an eighth of the numbers scaled by up to 2^exponents either way.
template <class F, class T>
std::vector<T> trace(Index d, Index steps, int exponents = 0) {
    using S = typename F::scalar;
    F filter(Problem<S>{.size = d, .forgetting = S(0.984375)});
    std::vector<T> out;
    auto const note = [&out](auto const& numbers) {
        for (Index j = 0; j < numbers.cols(); ++j)
            for (Index i = 0; i < numbers.rows(); ++i) out.push_back(T(double(numbers(i, j))));
    };
    Seed seed{std::uint64_t(d)};
    std::vector<S> psi(size_t(d), S(0));
    for (Index k = 0; k < steps; ++k) {
        for (S& x : psi) {
            double const number = seed.bell();
            x = S(number > 1 ? 0.0 : number < -1 ? -0.0 : number);
            if (exponents > 0 && seed.next() % 8 == 0)
                x = S(std::ldexp(number, int(seed.next() % std::uint64_t(2 * exponents)) - exponents));
        }
        Step<S> const step = filter.update(psi, S(seed.bell()));
        out.insert(out.end(),
                   {T(double(step.innovation)), T(double(step.residual)), T(double(step.gamma)), T(int(step.health))});
    }
    note(Vector<S>(filter.theta()));
    note(Vector<S>(filter.gain()));
    note(filter.stored().F);
    note(filter.stored().D);
    return out;
}

template <class T, template <class, int> class F>
void check(Index d, Index steps) {
    auto const plain = trace<F<Counted<T>, Dynamic>, T>(d, steps);
    on_each_isa([&] {
        EXPECT_EQ(difference(trace<F<T, Dynamic>, T>(d, steps), plain), -1)
            << F<T, Dynamic>::name << ' ' << d << " on " << name_of(kernels::isa);
    });
}
template <class T, template <class, int> class F, int N>
void check_fixed() {
    EXPECT_EQ(difference(trace<F<T, N>, T>(N, 60), trace<F<T, Dynamic>, T>(N, 60)), -1) << F<T, N>::name << ' ' << N;
}

template <class T, template <class, int> class F>
void check_all(Index cubic_up_to = 256) {
    for (Index d = 1; d <= 40; ++d) check<T, F>(d, 30);
    for (Index d : {64, 128, 129, 256})
        if (d <= cubic_up_to) check<T, F>(d, 6);
    for (Index d : {5, 10, 16}) check<T, F>(d, 300);
    if constexpr (std::same_as<T, double>) {  // what differs between float and double is tried above
        check_fixed<T, F, 3>();
        check_fixed<T, F, 8>();
        check_fixed<T, F, 20>();
    }
}

template <class T>
class Kernels : public testing::Test {};
using HardwareArithmetics = testing::Types<float, double>;
TYPED_TEST_SUITE(Kernels, HardwareArithmetics);

TYPED_TEST(Kernels, GiveConventionalOneResult) { check_all<TypeParam, Conventional>(); }
TYPED_TEST(Kernels, GiveConventionalTwoSidedOneResult) { check_all<TypeParam, ConventionalTwoSided>(); }
TYPED_TEST(Kernels, GiveSymmetricOneResult) { check_all<TypeParam, Symmetric>(); }
TYPED_TEST(Kernels, GiveJosephOneResult) { check_all<TypeParam, Joseph>(64); }
TYPED_TEST(Kernels, GiveJosephRankTwoOneResult) { check_all<TypeParam, JosephRankTwo>(); }
TYPED_TEST(Kernels, GivePotterOneResult) { check_all<TypeParam, Potter>(); }
TYPED_TEST(Kernels, GiveCarlsonOneResult) { check_all<TypeParam, Carlson>(); }
TYPED_TEST(Kernels, GiveCarlsonDeltaOneResult) { check_all<TypeParam, CarlsonDelta>(); }
TYPED_TEST(Kernels, GiveUdOneResult) { check_all<TypeParam, Ud>(); }
TYPED_TEST(Kernels, GiveUdDeltaOneResult) { check_all<TypeParam, UdDelta>(); }
TYPED_TEST(Kernels, GiveInverseQrOneResult) { check_all<TypeParam, InverseQr>(); }
TYPED_TEST(Kernels, GiveInverseQrDeltaOneResult) { check_all<TypeParam, InverseQrDelta>(); }
TYPED_TEST(Kernels, GiveKalmanOneResult) { check_all<TypeParam, Kalman>(); }
TYPED_TEST(Kernels, GiveInformationOneResult) { check_all<TypeParam, Information>(64); }
TYPED_TEST(Kernels, GiveQrOneResult) { check_all<TypeParam, Qr>(); }
TYPED_TEST(Kernels, GiveGentlemanOneResult) { check_all<TypeParam, Gentleman>(); }
TYPED_TEST(Kernels, GiveExtendedQrOneResult) { check_all<TypeParam, ExtendedQr>(); }

/// The one pass and the formulas of the page, where 1/w and squares come near an overflow and pass it.
TYPED_TEST(Kernels, GiveGentlemanOneResultNearOverflow) {
    using T = TypeParam;
    for (int exponents : {sizeof(T) == 8 ? 300 : 20, sizeof(T) == 8 ? 500 : 60})
        for (Index d = 1; d <= 33; ++d)
            for (Index steps : {2, 5, 40})
                EXPECT_EQ(difference(trace<Gentleman<T>, T>(d, steps, exponents),
                                     trace<Gentleman<Counted<T>>, T>(d, steps, exponents)),
                          -1)
                    << d << ' ' << steps << ' ' << exponents;
}

TEST(KernelsComparison, SeesOneBit) {
    auto const a = trace<Ud<double>, double>(5, 10);
    auto b = a;
    b[7] = std::nextafter(b[7], 1e300);
    EXPECT_EQ(difference(a, b), 7);
    EXPECT_EQ(difference(std::vector{0.0}, std::vector{-0.0}), 0);
}

// What the tables of dispatch.hpp choose on each instruction set, also on those that this machine lacks: nothing is
// run.
using namespace kernels;

template <class Pass>
Index one_pass_from_on(Isa isa) {
    Index d = 1;
    while (d < 4096 && !one_pass_is_faster<Pass>(isa, d)) ++d;
    return d;
}
template <class Kernel>
Index wide_from_on(Isa isa) {
    Index d = 1;
    while (d < 4096 && !uses_wide_registers<Kernel>(isa, d)) ++d;
    return d;
}

TEST(Dispatch, TakesRegistersOf64BytesWithAvx512Alone) {
    for (Isa isa : {Isa::baseline, Isa::avx2}) {
        EXPECT_EQ(wide_from_on<Multiply<double>>(isa), 4096) << name_of(isa);
        EXPECT_EQ(wide_from_on<ThenMultiply<SubtractRankOne<double>>>(isa), 4096) << name_of(isa);
    }
    EXPECT_EQ(wide_from_on<Multiply<double>>(Isa::avx512), 192);
    EXPECT_EQ(wide_from_on<ThenMultiply<SubtractRankOne<double>>>(Isa::avx512), 16);
    EXPECT_EQ(wide_from_on<Multiply<float>>(Isa::avx512), 4096);
}

TEST(Dispatch, OnePassIsFasterFromTheLesserOfTwoEntriesOn) {
    for (Isa isa : {Isa::baseline, Isa::avx2}) {
        EXPECT_EQ(one_pass_from_on<SubtractRankOne<double>>(isa), 128) << name_of(isa);
        EXPECT_EQ(one_pass_from_on<SweepUd<double>>(isa), 320) << name_of(isa);
    }
    EXPECT_EQ(one_pass_from_on<SubtractRankOne<double>>(Isa::avx512), 16);
    EXPECT_EQ(one_pass_from_on<SweepUd<double>>(Isa::avx512), 96);
    EXPECT_EQ(one_pass_from_on<SubtractRankOne<float>>(Isa::avx512), 128);
}

/// A wider set never turns one pass off.
template <class... Passes>
void check_monotonic() {
    for (Index d = 1; d < 2048; ++d)
        for (Isa isa : {Isa::baseline, Isa::avx2})
            EXPECT_TRUE(
                (... && (!one_pass_is_faster<Passes>(isa, d) || one_pass_is_faster<Passes>(Isa(int(isa) + 1), d))))
                << d;
}
TEST(Dispatch, OnePassStaysFasterOnAWiderSet) {
    check_monotonic<SubtractRankOne<double>, SubtractRankOne<float>, SweepUd<double>, SweepUd<float>,
                    SweepCarlson<double>, SweepCarlson<float>, SweepRotations<double>, SweepRotations<float>>();
}

/// The processor's best, or an earlier one that the environment names.
TEST(Dispatch, UsesNoSetThatTheMachineLacks) {
    EXPECT_LE(kernels::isa, best_isa());
    char const* const asked = std::getenv("RLSLAB_TEST_ISA");
    EXPECT_STREQ(name_of(kernels::isa), asked ? asked : name_of(best_isa()));
}

}  // namespace
}  // namespace rlslab
