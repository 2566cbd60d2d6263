// The wide scalars: widen loses nothing; and the traits of every scalar for Eigen and the catalogue
// are true.
#include <rlslab/arithmetic/arithmetics.hpp>
#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/core/problem.hpp>
#include <rlslab/core/random.hpp>

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace rlslab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// An integer of up to 113 random bits, long runs of zeros and of ones among them.
Quad random_integer(Seed& seed) {
    Quad m = 0;
    for (int word = 0; word < 4; ++word) {
        std::uint64_t const pick = seed.next();
        std::uint64_t const bits = pick % 3 == 0 ? 0 : pick % 3 == 1 ? 0xfffffff : (pick >> 8) & 0xfffffff;
        m = ldexp(m, 28) + Quad(bits);  // 4 x 28 = 112 bits, and one more below
    }
    return m * 2 + Quad(seed.next() % 2);
}

/// x = m 2^e widened is m 2^e built from m's 28-bit digits: no conversion of Quad's is trusted with more than a double.
using Widening = std::function<Reference(Quad const&)>;
Quad whole_part(Quad const& x) {
    Reference out;
    Quad::View const exact = x.mpfr();
    mpfr_floor(out.backend().data(), exact);
    return Quad(out.backend().data());
}
Reference by_digits(Quad m, int exponent) {
    Reference sum = 0;
    for (int shift = 0; m != 0; shift += 28) {
        Quad const high = whole_part(ldexp(m, -28));
        sum += ldexp(Reference(static_cast<double>(m - ldexp(high, 28))), shift);
        m = high;
    }
    return ldexp(sum, exponent);
}
bool loses_nothing(Widening const& f) {
    Seed seed{1};
    bool good = true;
    for (int k = 0; k < 3000; ++k) {
        Quad const m = random_integer(seed);
        int const any = int(seed.next() % 30000) - 15000;  // and from the smallest normals to just below 2^16384
        for (int const e : {any, -16382, -16000, -5000, -1130, -1074, -600, 0, 5, 900, 1000, 16271}) {
            Quad const x = ldexp(m, e);
            good = good && f(x) == by_digits(m, e) && f(-x) == -by_digits(m, e);
        }
    }
    for (int const e : {-16382, -16381, -1075, -1, 0, 1024, 16383})  // single bits
        good = good && f(ldexp(Quad(1), e)) == ldexp(Reference(1), e);
    return good && f(Quad(0)) == 0;
}
TEST(Widen, QuadLosesNothing) {
    EXPECT_TRUE(loses_nothing([](Quad const& x) { return widen(x); }));
    EXPECT_FALSE(loses_nothing([](Quad const& x) { return Reference(static_cast<double>(x)); }));
    EXPECT_FALSE(loses_nothing([](Quad const& x) {  // two pieces of 53 bits leave seven behind
        double const head = static_cast<double>(x);
        return Reference(head) + Reference(static_cast<double>(x - Quad(head)));
    }));
}
TEST(Widen, InfinitiesAndNaNStayThemselves) {
    for (double const x : {infinity, -infinity, nan}) {
        for (Reference const& wide : {widen(Quad(x)), widen(x), widen(float(x)), widen(static_cast<long double>(x))}) {
            EXPECT_EQ(isnan(wide), std::isnan(x));
            EXPECT_EQ(isinf(wide), std::isinf(x));
            EXPECT_EQ(static_cast<double>(wide) < 0, x < 0);
        }
        EXPECT_FALSE(is_finite(Quad(x)) || is_finite(Reference(x)));
    }
}
TEST(Widen, HardwareLosesNothing) {
    Seed seed{4};
    for (int k = 0; k < 10000; ++k) {
        std::uint64_t const bits = seed.next();
        int const e = int(seed.next() % 32000) - 16400;  // subnormal extended numbers among them
        long double const x = std::ldexp(static_cast<long double>(bits | 1), e - 63);
        if (std::isfinite(x) && e > -16382) {
            Reference const high(double(bits >> 32)), low(double((bits | 1) & 0xffffffff));
            ASSERT_EQ(widen(x), ldexp(ldexp(high, 32) + low, e - 63));
        }
        double const y = std::bit_cast<double>(bits);
        float const z = std::bit_cast<float>(std::uint32_t(bits));
        ASSERT_TRUE(std::isnan(y) || static_cast<double>(widen(y)) == y);
        ASSERT_TRUE(std::isnan(z) || widen(z) == Reference(double(z)));
    }
    EXPECT_EQ(widen(std::numeric_limits<long double>::denorm_min()), ldexp(Reference(1), -16445));
    EXPECT_EQ(widen(5e-324), ldexp(Reference(1), -1074));
    Reference const third = Reference(1) / 3;
    EXPECT_EQ(widen(third), third);
    for (Reference const& zero : {widen(-0.0), widen(-0.0f), widen(-0.0L), widen(Quad(-0.0)), widen(BFloat16(-0.0))})
        EXPECT_TRUE(zero == 0 && signbit(zero));
    EXPECT_FALSE(signbit(widen(Quad(0))));
}

TEST(Rational, IsExactAndAlwaysFinite) {
    static_assert(Field<Rational> && !Real<Rational>);
    EXPECT_TRUE(is_finite(Rational(1, 3)));
    EXPECT_EQ(Rational(1, 3) * 3, 1);
    EXPECT_EQ(Rational(0.1), Rational(3602879701896397) / Rational(36028797018963968));
    EXPECT_EQ(Eigen::NumTraits<Rational>::epsilon(), 0);
}

template <class T>
bool max_coefficient_of_negative_numbers_is_negative() {
    return Eigen::Matrix<T, 3, 1>(T(-3), T(-1), T(-2)).maxCoeff() == T(-1);
}
TEST(Storage, EigenFindsTheLargestOfNegativeNumbers) {
    EXPECT_TRUE(max_coefficient_of_negative_numbers_is_negative<Quad>());
    EXPECT_TRUE(max_coefficient_of_negative_numbers_is_negative<Reference>());
    EXPECT_TRUE(max_coefficient_of_negative_numbers_is_negative<Rational>());
}
TEST(Storage, RationalsHaveBoundsOfBothSigns) {
    using Storage = Eigen::NumTraits<Rational>;
    EXPECT_TRUE(Storage::lowest() < 0 && Storage::highest() > 0);
    EXPECT_TRUE(Eigen::NumTraits<Counted<Rational>>::lowest() < Counted<Rational>(0));
}

/// Of an arithmetic that rounds to nearest even: eps is the distance from 1 to the next number.
template <class T>
bool is_epsilon(double eps) {
    T const one(1);
    return one + T(eps) != one && T(one + T(eps)) - one == T(eps) && one + T(eps / 2) == one;
}
template <class T>
T power_of_two(int e) {
    if constexpr (requires { ldexp(T(1), e); }) return ldexp(T(1), e);
    else return T(std::ldexp(1.0, e));
}
/// 2^max_exp is finite and twice it is not; 2^min_exp has a neighbour at one epsilon and half of it has not.
template <class T>
bool are_exponents_of_normal_numbers(int min_exp, int max_exp) {
    T const big = power_of_two<T>(max_exp), small = power_of_two<T>(min_exp), half = small * T(0.5);
    T const more = T(1) + T(epsilon<T>());
    return is_finite(big) && !is_finite(T(big * T(2))) && small * more != small && half * more == half;
}
template <class T>
struct Traits : testing::Test {};
using Nearest = testing::Types<Half, BFloat16, Tf32, Chopped<Format{25, -400, 400}>, float, double, long double, Quad,
                               Reference, Counted<double>, Counted<Half>>;
TYPED_TEST_SUITE(Traits, Nearest);

TYPED_TEST(Traits, EpsilonIsTheDistanceToTheNextNumber) {
    double const eps = epsilon<TypeParam>();
    EXPECT_TRUE(is_epsilon<TypeParam>(eps));
    EXPECT_FALSE(is_epsilon<TypeParam>(2 * eps));
    EXPECT_FALSE(is_epsilon<TypeParam>(eps / 2));
    EXPECT_TRUE(Eigen::NumTraits<TypeParam>::epsilon() == TypeParam(eps));
}
TYPED_TEST(Traits, ExponentsAreThoseOfNormalNumbers) {
    using T = ArithmeticTraits<TypeParam>;
    EXPECT_TRUE(are_exponents_of_normal_numbers<TypeParam>(T::min_exp, T::max_exp));
    EXPECT_FALSE(are_exponents_of_normal_numbers<TypeParam>(T::min_exp + 1, T::max_exp));
    EXPECT_FALSE(are_exponents_of_normal_numbers<TypeParam>(T::min_exp - 1, T::max_exp));
    EXPECT_FALSE(are_exponents_of_normal_numbers<TypeParam>(T::min_exp, T::max_exp + 1));
    EXPECT_FALSE(are_exponents_of_normal_numbers<TypeParam>(T::min_exp, T::max_exp - 1));
}
/// lowest() is -highest(), the largest number there is: twice it is no number. Boost's own of the Reference is the
/// smallest positive.
template <class T, class Storage>
bool bounds_are_right() {
    return Storage::lowest() < T(0) && Storage::lowest() == -Storage::highest() && is_finite(Storage::highest()) &&
           !is_finite(T(Storage::highest() * T(2))) && !is_finite(Storage::infinity()) &&
           !is_finite(Storage::quiet_NaN());
}
struct TheSmallestPositive : Eigen::NumTraits<Quad> {
    static Quad lowest() { return (std::numeric_limits<Quad>::min)(); }
};
TYPED_TEST(Traits, BoundsSeenByEigen) {
    EXPECT_TRUE((bounds_are_right<TypeParam, Eigen::NumTraits<TypeParam>>()));
    EXPECT_FALSE((bounds_are_right<Quad, TheSmallestPositive>()));
}

template <class C>
bool has_traits(std::string_view name, Format f) {
    using Traits = ArithmeticTraits<C>;
    using Storage = Eigen::NumTraits<C>;
    return Traits::name == name && Format{Traits::digits, Traits::min_exp, Traits::max_exp} == f &&
           double(Storage::highest()) == largest(f) && double(Storage::lowest()) == -largest(f) &&
           double(Storage::epsilon()) == std::ldexp(1, 1 - f.digits) && Storage::dummy_precision() > C(0);
}
TEST(Chopped, TraitsAreTheFormat) {
    static_assert(Real<Half> && Real<BFloat16Zero> && Real<Tf32Stochastic>);
    EXPECT_TRUE(has_traits<Half>("binary16", binary16) && has_traits<BFloat16>("bfloat16", bfloat16));
    EXPECT_TRUE(has_traits<HalfZero>("binary16-zero", binary16) && has_traits<Tf32Zero>("tf32-zero", tf32));
    EXPECT_TRUE(has_traits<BFloat16Stochastic>("bfloat16-stochastic", bfloat16));
    EXPECT_FALSE(has_traits<BFloat16>("bfloat16", binary16));
    EXPECT_EQ(widen(BFloat16(-0x1.fep-126)), Reference(-0x1.fep-126));
    EXPECT_TRUE(isnan(widen(Half(nan))) && isinf(widen(Half(-infinity))) && widen(Half(-infinity)) < 0);
    EXPECT_TRUE(is_finite(Half(65504)) && !is_finite(Half(65520)) && !is_finite(Half(nan)));
    EXPECT_EQ((Matrix<Half>::Identity(3, 3) * Half(2)).trace(), Half(6));
}

template <class... T>
bool all_names_differ(std::tuple<T...>*) {
    return std::set<std::string_view>{ArithmeticTraits<T>::name...}.size() == sizeof...(T);
}
TEST(Names, AreUnique) {
    using Others =
        std::tuple<HalfZero, BFloat16Zero, Tf32, Tf32Zero, Tf32Stochastic, Counted<double>, Chopped<Format{4, -3, 4}>>;
    EXPECT_TRUE(all_names_differ(static_cast<Arithmetics*>(nullptr)));
    EXPECT_TRUE(all_names_differ(static_cast<decltype(std::tuple_cat(Arithmetics(), Others()))*>(nullptr)));
    EXPECT_FALSE(all_names_differ(static_cast<std::tuple<Half, BFloat16, Half>*>(nullptr)));
}

}  // namespace
}  // namespace rlslab
