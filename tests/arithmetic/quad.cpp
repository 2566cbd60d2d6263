// Quad against MPFR at 113 bits used as its manual says for IEEE formats, and against the compiler's own binary128;
// Pair against 257 bits.
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/arithmetic/pair.hpp>
#include <rlslab/core/random.hpp>

#include <gtest/gtest.h>

#include <cstring>

namespace rlslab {
namespace {

/// MPFR at 113 bits with binary128's exponents; subnormal results as in section "Emulating IEEE 754" of its manual.
class Binary128 {
    mpfr_t x_;
    mpfr_exp_t min_ = mpfr_get_emin(), max_ = mpfr_get_emax();

public:
    template <class Operation>
    explicit Binary128(Operation operation) {
        mpfr_init2(x_, 113);
        mpfr_set_emin(-16493);
        mpfr_set_emax(16384);
        int const ternary = operation(x_);
        mpfr_subnormalize(x_, mpfr_check_range(x_, ternary, MPFR_RNDN), MPFR_RNDN);
        mpfr_set_emin(min_);
        mpfr_set_emax(max_);
    }
    ~Binary128() { mpfr_clear(x_); }
    Binary128(Binary128 const&) = delete;
    Binary128& operator=(Binary128 const&) = delete;
    bool is(Quad const& q) const {
        Reference const wide = widen(q);
        mpfr_srcptr const y = wide.backend().data();
        return (mpfr_nan_p(x_) && mpfr_nan_p(y)) || (mpfr_equal_p(x_, y) && mpfr_signbit(x_) == mpfr_signbit(y));
    }
};

/// A number of up to 113 bits by its parts: (-1)^negative (high 2^57 + low) 2^exponent; high < 2^56, low < 2^57.
struct Parts {
    std::uint64_t high, low;
    int exponent;
    bool negative;
    Quad quad() const {
        Quad const size = ldexp(ldexp(Quad(high), 57) + Quad(low), exponent);
        return negative ? -size : size;
    }
};
/// Long runs of zeros and of ones, few bits at either end, and plain random ones.
std::uint64_t random_word(Seed& seed, int bits) {
    std::uint64_t const all = (std::uint64_t{1} << bits) - 1, r = seed.next();
    int const at = int(seed.next() % std::uint64_t(bits));
    switch (r % 6) {
        case 0: return 0;
        case 1: return all;
        case 2: return std::uint64_t{1} << at;
        case 3: return all ^ (std::uint64_t{1} << at);
        case 4: return (all >> at) << at;
        default: return seed.next() & all;
    }
}
Parts random_parts(Seed& seed, int exponent) {
    return {random_word(seed, 55) + (std::uint64_t{1} << 55), random_word(seed, 57), exponent, seed.next() % 2 == 0};
}

using One = Quad(Quad const&, Quad const&);
using Theirs = int(mpfr_ptr, mpfr_srcptr, mpfr_srcptr, mpfr_rnd_t);
int root_of_first(mpfr_ptr x, mpfr_srcptr a, mpfr_srcptr, mpfr_rnd_t mode) { return mpfr_sqrt(x, a, mode); }

/// Exponents apart by 0 ... 3, by 110 ... 118, where a false tie would be, or by anything up to 300.
int distance(Seed& seed) {
    std::uint64_t const r = seed.next();
    int const away = r % 3 == 0 ? int(r / 3 % 4) : r % 3 == 1 ? 110 + int(r / 3 % 9) : int(r / 3 % 300);
    return seed.next() % 2 == 0 ? away : -away;
}
int differences(One* ours, Theirs* theirs, int cases, int around, int spread) {
    Seed seed{77};
    int wrong = 0;
    for (int k = 0; k < cases; ++k) {
        int const e = around + int(seed.next() % std::uint64_t(2 * spread + 1)) - spread;
        Quad const a = random_parts(seed, e).quad(), b = random_parts(seed, e + distance(seed)).quad();
        Reference const wide_a = widen(a), wide_b = widen(b);
        Binary128 const right(
            [&](mpfr_ptr x) { return theirs(x, wide_a.backend().data(), wide_b.backend().data(), MPFR_RNDN); });
        wrong += !right.is(ours(a, b));
    }
    return wrong;
}
Quad plus(Quad const& a, Quad const& b) { return a + b; }
Quad minus(Quad const& a, Quad const& b) { return a - b; }
Quad times(Quad const& a, Quad const& b) { return a * b; }
Quad over(Quad const& a, Quad const& b) { return a / b; }
Quad root(Quad const& a, Quad const&) { return sqrt(a); }

TEST(Quad, RoundsEveryOperationOnceAlsoAtTheEndsOfItsRange) {
    EXPECT_EQ(differences(plus, &mpfr_add, 200000, 0, 3), 0);
    EXPECT_EQ(differences(minus, &mpfr_sub, 200000, 0, 3), 0);
    EXPECT_EQ(differences(times, &mpfr_mul, 150000, 0, 100), 0);
    EXPECT_EQ(differences(over, &mpfr_div, 150000, 0, 100), 0);
    EXPECT_EQ(differences(root, &root_of_first, 100000, 0, 5000), 0);
    for (int const around : {-16382 - 112, -16382 - 112 - 60, -16382 - 112 - 112, 16383 - 112}) {
        EXPECT_EQ(differences(plus, &mpfr_add, 20000, around, 4), 0) << around;
        EXPECT_EQ(differences(minus, &mpfr_sub, 20000, around, 4), 0) << around;
        EXPECT_EQ(differences(root, &root_of_first, 5000, around, 4), 0) << around;
    }
    for (int const half : {-8191 - 112, -8247 - 112, -8300 - 112, 8191 - 112})
        EXPECT_EQ(differences(times, &mpfr_mul, 20000, half, 40), 0) << half;
    EXPECT_EQ(differences([](Quad const& a, Quad const& b) { return ldexp(a, -8000) / ldexp(b, 8300); },
                          [](mpfr_ptr x, mpfr_srcptr a, mpfr_srcptr b, mpfr_rnd_t mode) {
                              Reference const small = ldexp(Reference(a), -8000), big = ldexp(Reference(b), 8300);
                              return mpfr_div(x, small.backend().data(), big.backend().data(), mode);
                          },
                          20000, 0, 100),
              0);
    EXPECT_GT(
        differences([](Quad const& a, Quad const& b) { return a + (b + Quad(0x1p-120) * a); }, &mpfr_add, 2000, 0, 3),
        0);
}
TEST(Quad, SpecialValues) {
    double const inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    double const values[] = {0.0, -0.0, 1, -1, inf, -inf, nan, 0x1p-1074, -3.5};
    for (double const a : values)
        for (double const b : values) {
            EXPECT_TRUE(Binary128([&](mpfr_ptr x) { return mpfr_set_d(x, a + b, MPFR_RNDN); }).is(Quad(a) + Quad(b)) ||
                        std::abs(a) == 0x1p-1074 || std::abs(b) == 0x1p-1074);
            EXPECT_TRUE(Binary128([&](mpfr_ptr x) { return mpfr_set_d(x, a * b, MPFR_RNDN); }).is(Quad(a) * Quad(b)) ||
                        std::abs(a) == 0x1p-1074 || std::abs(b) == 0x1p-1074);
            EXPECT_EQ(Quad(a) == Quad(b), a == b);
            EXPECT_EQ(Quad(a) < Quad(b), a < b);
            EXPECT_EQ(Quad(a) <= Quad(b), a <= b);
            EXPECT_EQ(Quad(a) > Quad(b), a > b);
        }
    for (double const a : values) {
        EXPECT_EQ(isfinite(Quad(a)), std::isfinite(a));
        EXPECT_EQ(isnan(Quad(a)), std::isnan(a));
        EXPECT_EQ(isinf(Quad(a)), std::isinf(a));
        EXPECT_TRUE(std::isnan(a) || (static_cast<double>(Quad(a)) == a && signbit(Quad(a)) == std::signbit(a)));
        EXPECT_TRUE(std::isnan(a) || (static_cast<double>(-Quad(a)) == -a && signbit(-Quad(a)) != std::signbit(a)));
        EXPECT_TRUE(std::isnan(a) || static_cast<double>(abs(Quad(a))) == std::abs(a));
    }
    EXPECT_TRUE(isnan(sqrt(Quad(-1))) && isinf(Quad(1) / Quad(0)) && isnan(Quad(0) / Quad(0)));
}
TEST(Quad, TakesIntegersWhole) {
    for (std::int64_t const n : {std::int64_t{0}, std::int64_t{-1}, INT64_MAX, INT64_MIN, std::int64_t{-4294967297}}) {
        EXPECT_EQ(widen(Quad(n)), Reference(n));
    }
    EXPECT_EQ(widen(Quad(UINT64_MAX)), Reference(UINT64_MAX));
    EXPECT_EQ(Quad(3), 3);
    EXPECT_EQ(1 / Quad(4), Quad(0.25));
}
TEST(Quad, LimitsAreThoseOfBinary128) {
    using Limits = std::numeric_limits<Quad>;
    mpfr_exp_t const emin = mpfr_get_emin();
    EXPECT_EQ(widen(Limits::denorm_min()), ldexp(Reference(1), -16494));
    EXPECT_EQ(widen(Limits::min()), ldexp(Reference(1), -16382));
    EXPECT_EQ(widen(Limits::max()), ldexp(2 - ldexp(Reference(1), -112), 16383));
    EXPECT_EQ(Limits::lowest(), -Limits::max());
    EXPECT_EQ(widen(Quad(1) + Limits::epsilon()), 1 + ldexp(Reference(1), -112));
    EXPECT_EQ(Limits::denorm_min() / Quad(2), 0);
    EXPECT_GT(Limits::denorm_min() * Quad(0.75), 0);
    EXPECT_EQ(widen(Limits::min() / Quad(2)), ldexp(Reference(1), -16383));
    EXPECT_TRUE(isfinite(Limits::max()) && isinf(Limits::max() * (Quad(1) + Limits::epsilon())));
    EXPECT_EQ(Limits::max() + ldexp(Quad(1), 16384 - 115), Limits::max()) << "a quarter of an ulp";
    EXPECT_TRUE(isinf(Limits::max() + ldexp(Quad(1), 16384 - 114))) << "half of one";
    EXPECT_EQ(mpfr_get_emin(), emin) << "what MPFR's other users see is as before";
}

#ifdef __SIZEOF_FLOAT128__
/// The compiler's binary128, of which libgcc does the arithmetic in integers.
__extension__ typedef __float128 Theirs128;
Quad quad_of(Theirs128 x) {
    std::uint64_t word[2];
    std::memcpy(word, &x, 16);
    int const exponent = int(word[1] >> 48 & 0x7fff);
    std::uint64_t const top = (word[1] & 0xffffffffffff) | (exponent > 0 ? std::uint64_t{1} << 48 : 0);
    Quad const size = ldexp(ldexp(Quad(top), 64) + Quad(word[0]), std::max(exponent, 1) - 16383 - 112);
    return word[1] >> 63 ? -size : size;
}
Theirs128 theirs_of(Parts const& p) {  // normal numbers
    std::uint64_t const mantissa_high = p.high >> 7, mantissa_low = p.high << 57 | p.low;
    std::uint64_t const word[2] = {mantissa_low, (std::uint64_t(p.negative) << 63) |
                                                     (std::uint64_t(p.exponent + 112 + 16383) << 48) |
                                                     (mantissa_high & 0xffffffffffff)};
    Theirs128 x;
    std::memcpy(&x, word, 16);
    return x;
}
TEST(Quad, AgreesWithTheCompilersBinary128) {
    Seed seed{5};
    int wrong = 0;
    for (int k = 0; k < 100000; ++k) {
        int const e = -112 + (k % 2 == 0 ? int(seed.next() % 20) : -16300 + int(seed.next() % 30));
        Parts const p = random_parts(seed, e), q = random_parts(seed, std::max(e + distance(seed), -16382 - 112));
        Quad const a = p.quad(), b = q.quad();
        Theirs128 const x = theirs_of(p), y = theirs_of(q);
        if (!(quad_of(x) == a && quad_of(y) == b)) FAIL() << "the test's own conversion";
        wrong += !(a + b == quad_of(x + y)) + !(a - b == quad_of(x - y));
        if (e > -200) wrong += !(a * b == quad_of(x * y)) + !(a / b == quad_of(x / y));
    }
    EXPECT_EQ(wrong, 0);
}
#endif

// Pairs of doubles against 257 bits: the errors that the page states, searched for; and what is no number.

using R = Reference;
R exact(Pair const& x) { return R(x.high()) + R(x.low()); }

TEST(Pair, ErrsByNoMoreThanItSays) {
    Seed seed{1};
    auto const number = [&seed](double near, int bits) {  // near: half of them cancel
        double const high = seed.next() % 2 == 0 ? -near + near * std::ldexp(seed.bell(), -bits)
                                                 : std::ldexp(seed.bell(), int(seed.next() % 40) - 20);
        return Pair(high) + Pair(high * std::ldexp(seed.bell(), -53 - int(seed.next() % 4)));
    };
    double sum = 0, product = 0, quotient = 0, root = 0;
    auto const look = [](double& worst, Pair const& found, R const& wanted) {
        R const off = abs(R(exact(found) - wanted));
        worst = std::max(worst, wanted == 0 ? double(off != 0) : static_cast<double>(R(off / abs(wanted))));
    };
    for (int i = 0; i < 100000; ++i) {
        Pair const a = number(1, 0), b = number(double(a), int(seed.next() % 60));
        R const x = exact(a), y = exact(b);
        look(sum, a + b, R(x + y)), look(product, a * b, R(x * y)), look(root, sqrt(abs(a)), R(sqrt(R(abs(x)))));
        if (y != 0) look(quotient, a / b, R(x / y));
        EXPECT_EQ(a < b, x < y);
        EXPECT_EQ(a == b, x == y);
    }
    double const u2 = 0x1p-106;
    EXPECT_LE(sum, 3 * u2);
    EXPECT_LE(product, 5 * u2);
    EXPECT_LE(quotient, 15 * u2);
    EXPECT_LE(root, 4 * u2);
    EXPECT_GE(sum, 1.5 * u2) << "the search reaches half of it";
    EXPECT_GE(product, 2.5 * u2) << "the search reaches half of it";
}
TEST(Pair, KeepsWhatIsNoNumber) {
    Pair const infinite(std::numeric_limits<double>::infinity()), zero(0);
    for (Pair const& x : {infinite + Pair(1), infinite * Pair(2), Pair(1) / zero, sqrt(infinite), infinite - Pair(1),
                          Pair(1e308) * Pair(1e308)})
        EXPECT_TRUE(std::isinf(double(x)) || std::isnan(double(x)));
    EXPECT_TRUE(std::isnan(double(infinite - infinite)) && std::isnan(double(zero / zero)) &&
                std::isnan(double(sqrt(Pair(-1)))));
    EXPECT_EQ(double(Pair(1) / infinite), 0);
    EXPECT_TRUE(std::signbit(double(-zero)));
}

}  // namespace
}  // namespace rlslab
