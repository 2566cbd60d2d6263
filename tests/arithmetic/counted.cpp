// Scalars that watch operations. Counted does T's arithmetic bit for bit, and tallies what was done and nothing else.
#include "tests/compilers/everything.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/arithmetic/storage_traits.hpp>
#include <rlslab/linalg/kernels.hpp>

#include <gtest/gtest.h>

#include <functional>
#include <thread>

namespace rlslab {
namespace {

template <class T>
struct CountedOf : testing::Test {};
using Inner = testing::Types<float, double, long double, Half, Quad, Reference>;
TYPED_TEST_SUITE(CountedOf, Inner);

/// One of each: 2 additions (one a subtraction), 1 multiplication, 1 division, 1 square root.
template <class C>
C mixed(C const& a, C const& b) {
    return sqrt((a + b) * a - b / a);
}
TYPED_TEST(CountedOf, TalliesAKnownExpressionAndKeepsItsValue) {
    using T = TypeParam;
    using C = Counted<T>;
    static_assert(Real<C>);
    using std::sqrt;
    T const a(1.75), b(0.625);
    C result;
    Tally const tally = counted([&] { result = mixed(C(a), C(b)); });
    EXPECT_EQ(tally, (Tally{2, 1, 1, 1}));
    EXPECT_EQ(tally.total(), 5);
    EXPECT_EQ(result.value(), T(sqrt(T(T(T(a + b) * a) - T(b / a)))));
    EXPECT_EQ(double(result), double(result.value()));
    EXPECT_EQ(widen(result), widen(result.value()));
}
TYPED_TEST(CountedOf, CompoundOperationsCountOnce) {
    using C = Counted<TypeParam>;
    C x(3), y(2);
    EXPECT_EQ(counted([&] { x += y; }), (Tally{1, 0, 0, 0}));
    EXPECT_EQ(counted([&] { x -= y; }), (Tally{1, 0, 0, 0}));
    EXPECT_EQ(counted([&] { x *= y; }), (Tally{0, 1, 0, 0}));
    EXPECT_EQ(counted([&] { x /= y; }), (Tally{0, 0, 1, 0}));
    EXPECT_EQ(x, C(3));
}
TYPED_TEST(CountedOf, SignsComparisonsConstructionAndConstantsAreFree) {
    using C = Counted<TypeParam>;
    using Storage = Eigen::NumTraits<C>;
    EXPECT_EQ(counted([] {
                  C const x(2), y = -x, z = abs(y);
                  EXPECT_TRUE(x == z && x != y && y < x && y <= x && x > y && x >= z && isfinite(x) && is_finite(y));
                  EXPECT_EQ(absolute(y), x);
                  EXPECT_EQ(double(y), -2);
                  EXPECT_TRUE(Storage::lowest() < C(0) && C(0) < Storage::highest() && C(0) < Storage::epsilon());
                  EXPECT_TRUE(C(0) < Storage::dummy_precision());
              }),
              Tally{});
}
TYPED_TEST(CountedOf, TraitsAreTheInnerOnesUnderAnotherName) {
    using Traits = ArithmeticTraits<Counted<TypeParam>>;
    using InnerTraits = ArithmeticTraits<TypeParam>;
    EXPECT_EQ(Traits::name, "counted");
    EXPECT_EQ(Traits::digits, InnerTraits::digits);
    EXPECT_EQ(Traits::min_exp, InnerTraits::min_exp);
    EXPECT_EQ(Traits::max_exp, InnerTraits::max_exp);
}

TEST(Counted, RationalsHaveNoRoot) {
    static_assert(Field<Counted<Rational>> && !Real<Counted<Rational>>);
    Counted<Rational> third;
    EXPECT_EQ(counted([&] { third = Counted<Rational>(1) / Counted<Rational>(3); }), (Tally{0, 0, 1, 0}));
    EXPECT_EQ(third.value(), Rational(1, 3));
}
TEST(Counted, ValuesDoNotMatter) {
    Counted<double> const zero(0), one(1), nan(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(counted([&] { (void)(zero * one + zero - nan / one); }), (Tally{2, 1, 1, 0}));
    EXPECT_FALSE(nan == nan || nan < nan || nan >= nan || isfinite(nan));
    EXPECT_TRUE(nan != nan);
}
TEST(Counted, NestsAndSurvivesExceptions) {
    Counted<double> const x(1);
    Tally inner;
    Tally const outer = counted([&] {
        (void)(x + x);
        inner = counted([&] { (void)(x * x); });
        EXPECT_THROW(counted([&] {
                         (void)sqrt(x);
                         throw 1;
                     }),
                     int);
    });
    EXPECT_EQ(inner, (Tally{0, 1, 0, 0}));
    EXPECT_EQ(outer, (Tally{1, 1, 0, 1}));
}
TEST(Counted, ThreadsCountForThemselves) {
    Counted<double> const x(1);
    Tally elsewhere;
    EXPECT_EQ(counted([&] { std::thread([&] { elsewhere = counted([&] { (void)(x + x); }); }).join(); }), Tally{});
    EXPECT_EQ(elsewhere, (Tally{1, 0, 0, 0}));
}

/// n multiplications, n - 1 additions.
using Product = std::function<void(Counted<double> const* x, Counted<double> const* y, Index n)>;
bool costs_what_a_dot_product_costs(Product const& product) {
    std::vector<Counted<double>> const x(40), y(40);
    bool good = true;
    for (Index n = 1; n <= 40; ++n)
        good = good && counted([&] { product(x.data(), y.data(), n); }) == Tally{n - 1, n, 0, 0};
    return good;
}
TEST(Counted, DotProducts) {
    using C = Counted<double>;
    EXPECT_TRUE(costs_what_a_dot_product_costs([](C const* x, C const* y, Index n) { (void)dot(x, y, n); }));
    EXPECT_FALSE(costs_what_a_dot_product_costs([](C const* x, C const* y, Index n) {  // from zero: one addition more
        C sum(0);
        for (Index i = 0; i < n; ++i) sum += x[i] * y[i];
    }));
    EXPECT_FALSE(costs_what_a_dot_product_costs([](C const* x, C const* y, Index n) {  // T's, uncounted
        (void)(x->value() * y->value() * double(n));
    }));
}
TEST(Counted, LivesInEigen) {
    using M = Matrix<Counted<double>, 3>;
    M const a = M::Identity(), b = M::Constant(Counted<double>(2));
    M sum;
    EXPECT_EQ(counted([&] { sum = a + b; }), (Tally{9, 0, 0, 0}));
    EXPECT_EQ(sum(0, 0), Counted<double>(3));
}

/// A double that knows whether an operation made it, and operators that distinguish a temporary from a variable.
class Ordered {
    double value_ = 0;
    bool rounded_ = false;
    Ordered(double value, bool rounded) : value_(value), rounded_(rounded) {}
    static Ordered both(Ordered const& a, Ordered const& b, double value) {
        unordered += a.rounded_ && b.rounded_;
        return {value, true};
    }

public:
    static inline long unordered = 0;
    Ordered() = default;
    explicit Ordered(double x) : value_(x) {}
    Ordered(Ordered const& other) : value_(other.value_) {}  // a copy of a variable: nothing was rounded for it
    Ordered(Ordered&&) = default;
    Ordered& operator=(Ordered const&) = default;
    Ordered& operator=(Ordered&&) = default;
    explicit operator double() const { return value_; }

    friend Ordered operator+(Ordered const& a, Ordered const& b) { return {a.value_ + b.value_, true}; }
    friend Ordered operator-(Ordered const& a, Ordered const& b) { return {a.value_ - b.value_, true}; }
    friend Ordered operator*(Ordered const& a, Ordered const& b) { return {a.value_ * b.value_, true}; }
    friend Ordered operator/(Ordered const& a, Ordered const& b) { return {a.value_ / b.value_, true}; }
    friend Ordered operator+(Ordered&& a, Ordered&& b) { return both(a, b, a.value_ + b.value_); }
    [[maybe_unused]] friend Ordered operator-(Ordered&& a, Ordered&& b) { return both(a, b, a.value_ - b.value_); }
    friend Ordered operator*(Ordered&& a, Ordered&& b) { return both(a, b, a.value_ * b.value_); }
    friend Ordered operator/(Ordered&& a, Ordered&& b) { return both(a, b, a.value_ / b.value_); }
    friend Ordered operator-(Ordered const& a) { return {-a.value_, a.rounded_}; }
    friend Ordered sqrt(Ordered const& a) { return {std::sqrt(a.value_), true}; }
    Ordered& operator+=(Ordered const& b) { return *this = *this + b; }
    Ordered& operator-=(Ordered const& b) { return *this = *this - b; }
    Ordered& operator*=(Ordered const& b) { return *this = *this * b; }
    Ordered& operator/=(Ordered const& b) { return *this = *this / b; }
    friend bool isfinite(Ordered const& a) { return std::isfinite(a.value_); }
    friend bool operator==(Ordered const& a, Ordered const& b) { return a.value_ == b.value_; }
    friend auto operator<=>(Ordered const& a, Ordered const& b) { return a.value_ <=> b.value_; }
};

}  // namespace

template <>
struct ArithmeticTraits<Ordered> : ArithmeticTraits<Chopped<binary16>> {};

}  // namespace rlslab

template <>
struct Eigen::NumTraits<rlslab::Ordered> : rlslab::detail::StorageTraits<rlslab::Ordered> {};

namespace rlslab {
namespace {

TEST(EvaluationOrder, NoOperatorHasTwoOperandsThatRound) {
    for_each(Variants<Ordered>{}, [&]<class F>() {
        Ordered::unordered = 0;
        everything::digest_of<F>();
        EXPECT_EQ(Ordered::unordered, 0) << F::name;
    });
    Ordered const x(0.5);
    Ordered::unordered = 0;
    EXPECT_EQ(double(x * x + x * x), 0.5);
    EXPECT_EQ(Ordered::unordered, 1) << "the count works";
}

}  // namespace
}  // namespace rlslab
