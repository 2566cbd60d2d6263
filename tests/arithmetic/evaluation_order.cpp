// No operator has two operands that both round: C++ does not define which comes first, and with stochastic rounding the
// result depends on it. (Arguments of one call are seen by tests/compilers/ alone.)
#include "tests/compilers/everything.hpp"

#include <rlslab/arithmetic/storage_traits.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

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
    friend Ordered operator-(Ordered&& a, Ordered&& b) { return both(a, b, a.value_ - b.value_); }
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
