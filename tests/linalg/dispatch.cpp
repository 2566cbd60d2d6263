// What the tables of dispatch.hpp choose on each instruction set, also on those that this machine lacks: nothing is
// run.
#include "tests/common/each_isa.hpp"

#include <gtest/gtest.h>

namespace rlslab {
namespace {

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
