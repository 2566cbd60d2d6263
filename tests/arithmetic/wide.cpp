// The wide scalars: widen loses nothing; the traits of every scalar for Eigen and the catalogue are true; a sum of no
// terms is zero in every arithmetic. Elementary functions are the nearest doubles, as 257 bits show it.
#include <rlslab/arithmetic/arithmetics.hpp>
#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/core/problem.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/model/order_recursive_qr.hpp>

#include <gtest/gtest.h>

#include <cmath>
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

// --- sums of no terms, whatever was in memory before -----------------------------------------------------------------

/// Leaves 4 KB of ones where the next call has its variables.
[[gnu::noinline]] void litter() {
    unsigned char volatile bytes[4096];
    for (auto& b : bytes) b = 0x3f;
}

template <class T>
[[gnu::noinline]] T dot_of_nothing(Index n) {
    T const x[1] = {T(3)};
    return dot(x, x, n);
}

template <class T>
struct EmptySum : testing::Test {};
using Scalars = testing::Types<BFloat16, BFloat16Stochastic, VariablePrecision, float, double, long double, Quad,
                               Reference, Rational, Counted<double>>;
TYPED_TEST_SUITE(EmptySum, Scalars);
TYPED_TEST(EmptySum, IsZero) {
    litter();
    EXPECT_TRUE(dot_of_nothing<TypeParam>(0) == TypeParam(0));
}
TEST(EmptySumOfPacks, IsZeroInEveryLane) {
    litter();
    EXPECT_TRUE(all(dot_of_nothing<Pack<double, 8>>(0) == Pack<double, 8>(0.0)));
}

template <class T>
[[gnu::noinline]] T J_of_as_many_columns_as_rows() {
    OrderRecursiveQr<T> f((Vector<T>(2) << T(5), T(7)).finished(), 2);
    f.append((Vector<T>(2) << T(1), T(2)).finished());
    f.append((Vector<T>(2) << T(3), T(-1)).finished());
    litter();
    return f.J();
}
TEST(OrderRecursiveQr, NothingIsLeftByAsManyColumnsAsRows) {
    EXPECT_EQ(J_of_as_many_columns_as_rows<double>(), 0);
    EXPECT_EQ(J_of_as_many_columns_as_rows<float>(), 0);
    EXPECT_EQ(J_of_as_many_columns_as_rows<Quad>(), 0);
}
TEST(OrderRecursive, OfNoRows) {
    OrderRecursive<double> const f(Vector<double>(0), 1);
    EXPECT_EQ(f.J(), 0);
}

// --- elementary functions --------------------------------------------------------------------------------------------

using R = Reference;
/// A function as it is computed, the same in 257 bits, and where it is asked.
struct Row {
    std::function<double(double)> ours;
    std::function<R(R const&)> theirs;
    double from, to;
};
/// How many of so many arguments in [from, to) give another double than the wide result rounded once.
int wrong(Row const& row) {
    Seed seed{3};
    int out = 0;
    for (int k = 0; k < 3000; ++k) {
        double const x = row.from + (row.to - row.from) * seed.uniform();
        out += row.ours(x) != static_cast<double>(row.theirs(R(x)));
    }
    return out;
}

TEST(Elementary, ResultsAreTheNearestDoubles) {
    Row const rows[] = {
        {correctly::exp, [](R const& x) -> R { return exp(x); }, -745, 709},
        {correctly::exp, [](R const& x) -> R { return exp(x); }, -746, -708},  // subnormal
        {correctly::exp2, [](R const& x) -> R { return pow(R(2), x); }, -1075, 1024},
        {correctly::log, [](R const& x) -> R { return log(x); }, 0, 1e6},
        {correctly::log, [](R const& x) -> R { return log(x); }, 0.9, 1.1},
        {correctly::log2, [](R const& x) -> R { return log(x) / log(R(2)); }, 0, 1e6},
        {correctly::log10, [](R const& x) -> R { return log10(x); }, 0, 1e6},
        {correctly::cos, [](R const& x) -> R { return cos(x); }, -1e4, 1e4},
        {correctly::sin, [](R const& x) -> R { return sin(x); }, -1e4, 1e4},
        {[](double x) { return correctly::pow(10, x); }, [](R const& x) -> R { return pow(R(10), x); }, -320, 308},
        {[](double x) { return correctly::pow(x, 7.5); }, [](R const& x) -> R { return pow(x, R(7.5)); }, 0, 1e3},
        {[](double x) { return correctly::hypot(x, 3); }, [](R const& x) -> R { return sqrt(x * x + 9); }, -20, 20},
        {[](double x) { return correctly::atan2(x, 3); }, [](R const& x) -> R { return atan(x / 3); }, -20, 20}};
    for (Row const& row : rows) EXPECT_EQ(wrong(row), 0) << &row - rows;
    EXPECT_GT(wrong({[](double x) { return correctly::exp2(x * 3.3219280948873623); },
                     [](R const& x) -> R { return pow(R(10), x); }, -320, 308}),
              0);
}
TEST(Elementary, EndsAndSpecialValues) {
    EXPECT_EQ(correctly::exp(-746), 0);
    EXPECT_EQ(correctly::exp(-745.1), 5e-324);
    EXPECT_EQ(correctly::exp(710), infinity);
    EXPECT_EQ(correctly::log(0), -infinity);
    EXPECT_TRUE(std::isnan(correctly::log(-1)) && std::isnan(correctly::log(nan)) &&
                std::isnan(correctly::pow(nan, 1)));
    EXPECT_EQ(correctly::atan2(0.0, -1), 3.141592653589793);
    EXPECT_EQ(correctly::atan2(-0.0, -1), -3.141592653589793);
    EXPECT_EQ(correctly::atan2(0, 0), 0);
    EXPECT_EQ(correctly::pow(nan, 0), 1);
    EXPECT_EQ(correctly::pow(10, -324), 0);
    EXPECT_EQ(correctly::pow(10, -323), 1e-323);
    EXPECT_EQ(correctly::pow(10, 309), infinity);
    EXPECT_EQ(correctly::pow(10, 22), 1e22);
    EXPECT_EQ(correctly::pow(-2, 3), -8);
    EXPECT_EQ(correctly::log10(1e22), 22);
    EXPECT_EQ(correctly::log10(infinity), infinity);
    EXPECT_EQ(correctly::hypot(0x3p700, 0x4p700), 0x5p700);
    EXPECT_EQ(correctly::hypot(infinity, nan), infinity);
}

}  // namespace
}  // namespace rlslab
