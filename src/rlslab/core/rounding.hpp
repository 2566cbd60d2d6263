// Tests whether this program, in this thread, rounds as rlslab defines it. Call it once at start-up, or in a test of an
// application.
#pragma once

#include <rlslab/core/scalar.hpp>

#include <cfloat>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

namespace rlslab {

namespace detail {
// The value, hidden from the compiler: the processor computes with it, not the compiler. The functions below are
// static, so that each translation unit tests the options with which it was compiled itself.
template <class T>
[[maybe_unused]] static T unknown(T value) {
    T volatile stored = value;
    return stored;
}
/// a b - 1, where the rounded product is 1: a result other than 0 shows that the product was not rounded.
template <class T>
[[gnu::noinline, maybe_unused]] static bool fuses(T half_ulp) {
    T const a = unknown(T(1) + half_ulp), b = unknown(T(1) - half_ulp), c = unknown(T(-1));
    return a * b + c != T(0);
}
/// (1 + t) - 1, where the rounded sum is 1: a result other than 0 shows that the compiler cancelled 1 - 1.
template <class T>
[[gnu::noinline, maybe_unused]] static bool reorders(T tiny) {
    T const a = unknown(T(1)), t = unknown(tiny);
    return (a + t) - a != T(0);
}
/// 1 / 49, 3 / 49, 5 / 49 ...: products with the rounded 1 / 49 instead of quotients change some of them.
template <class T>
[[gnu::noinline, maybe_unused]] static bool multiplies_by_reciprocals() {
    T const by = unknown(T(49));
    T numerators[8], at_once[8];
    for (int i = 0; i < 8; ++i) numerators[i] = unknown(T(2 * i + 1));
    for (int i = 0; i < 8; ++i) at_once[i] = numerators[i] / by;
    for (int i = 0; i < 8; ++i)
        if (at_once[i] != unknown(numerators[i]) / unknown(by)) return true;
    return false;
}
template <class T>
[[gnu::noinline, maybe_unused]] static bool rounds_to_nearest(T quarter_ulp) {
    T const one = unknown(T(1)), t = unknown(quarter_ulp);
    return one + t == one && one - t / T(2) == one && -one - t == -one && -one + t / T(2) == -one;
}
template <class T>
[[gnu::noinline, maybe_unused]] static bool loses_subnormal_results() {
    T const half = unknown(std::numeric_limits<T>::min()) * unknown(T(0.5));
    std::uint64_t bits = 0;  // a comparison of numbers might take a subnormal as zero
    std::memcpy(&bits, &half, sizeof half);
    return bits == 0;
}
template <class T>
[[gnu::noinline, maybe_unused]] static bool loses_subnormal_operands() {
    T const subnormal = unknown(std::numeric_limits<T>::denorm_min());
    T const large = unknown(T(1) / std::numeric_limits<T>::epsilon());
    return !(subnormal * large > T(0)) || subnormal == T(0);
}
}  // namespace detail

/// One line for each way in which this translation unit, run by this thread, departs from the definition: every
/// operation on float and double is rounded once, to nearest, and subnormal numbers are kept. If the result is empty,
/// the same data give the same bits as on any other machine.
[[maybe_unused]] static std::vector<std::string_view> rounding_faults() {
    using namespace detail;
    std::vector<std::string_view> out;
    auto const note = [&out](bool fault, std::string_view text) {
        if (fault) out.push_back(text);
    };
    if (!rounds_to_nearest(0x1p-54) || !rounds_to_nearest(0x1p-25f)) {
        note(true, "the rounding mode is not to nearest: fesetround(FE_TONEAREST)");  // the other tests rely on it
    } else {
        note(fuses(0x1p-30) || fuses(0x1p-13f),
             "products and sums are contracted into one rounding: compile with -ffp-contract=off (rlslab::headers "
             "brings it)");
        note(multiplies_by_reciprocals<double>() || multiplies_by_reciprocals<float>(),
             "quotients are products with a reciprocal: compile without -freciprocal-math and -ffast-math");
        note(reorders(0x1p-60) || reorders(0x1p-30f),
             "sums are reordered: compile without -ffast-math and -funsafe-math-optimizations");
    }
    note(loses_subnormal_results<double>() || loses_subnormal_results<float>(),
         "subnormal results are flushed to zero: clear FTZ (a library linked with -ffast-math may have set it)");
    note(loses_subnormal_operands<double>() || loses_subnormal_operands<float>(),
         "subnormal operands are taken as zero: clear DAZ (a library linked with -ffast-math may have set it)");
    note(FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16,
         "intermediate results are kept in a longer format (x87): compile with -msse2 -mfpmath=sse");
    return out;
}

}  // namespace rlslab
