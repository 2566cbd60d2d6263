// The fused multiply-add of the page's module. WebAssembly has no such instruction, and musl computes one in integers,
// which takes half the time of a filter.
#include <rlslab/arithmetic/format.hpp>

#include <cmath>

extern "C" {
double __real_fma(double x, double y, double z);  // NOLINT: the linker's names (--wrap=fma)
double __wrap_fma(double x, double y, double z);
}

/// x y + z, rounded once. The library calls it for the tail of a result that it has: z is near -x y. Where it is within
/// a factor of two of -x y, Dekker's product of exponents far from double's ends is exact, and so is its sum with z
///; everything else is musl's.
double __wrap_fma(double x, double y, double z) {
    using namespace rlslab::detail;
    auto const exponent = [](double v) { return int(bits_of(v) >> 52 & 2047) - 1023; };
    double const p = x * y;
    int const ex = exponent(x), ey = exponent(y);
    bool const moderate = ex > -400 && ex < 400 && ey > -400 && ey < 400,
               opposite = ((bits_of(p) ^ bits_of(z)) & sign_bit) != 0;
    if (!moderate || !opposite || std::fabs(z) > 2 * std::fabs(p) || std::fabs(p) > 2 * std::fabs(z))
        return __real_fma(x, y, z);
    double const tx = 134217729.0 * x, xh = tx - (tx - x), xl = x - xh;
    double const ty = 134217729.0 * y, yh = ty - (ty - y), yl = y - yh;
    return (p + z) + (((xh * yh - p) + xh * yl + xl * yh) + xl * yl);
}
