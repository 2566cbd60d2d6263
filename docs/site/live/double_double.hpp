// A number of 106 bits as the unevaluated sum of two doubles: the page's reference, without a library. Not certified.
#pragma once

#include <rlslab/arithmetic/storage_traits.hpp>

#include <cmath>

namespace rlslab::live {

/// head + tail, |tail| <= ulp(head) / 2. Errors are a few units of 2^-104. Exponents are double's: a product is right
/// while its operands are below 2^996 and its tail does not underflow. Sums are Knuth's TwoSum, products Dekker's.
class DoubleDouble {
    double head_ = 0, tail_ = 0;
    DoubleDouble(double head, double tail) : head_(head), tail_(tail) {}

    static DoubleDouble ordered_sum(double a, double b) {  // |a| >= |b|
        double const sum = a + b;
        return {sum, b - (sum - a)};
    }
    static DoubleDouble exact_sum(double a, double b) {
        double const sum = a + b, of_b = sum - a;
        return {sum, (a - (sum - of_b)) + (b - of_b)};
    }
    /// 26 bits each.
    static void split(double a, double& high, double& low) {
        double const t = 134217729.0 * a;
        high = t - (t - a);
        low = a - high;
    }
    static DoubleDouble exact_product(double a, double b) {
        double ah, al, bh, bl;
        split(a, ah, al), split(b, bh, bl);
        double const p = a * b;
        return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
    }

public:
    DoubleDouble() = default;
    explicit DoubleDouble(int x) : head_(x) {}
    explicit DoubleDouble(double x) : head_(x) {}
    explicit operator double() const { return head_; }
    double tail() const { return tail_; }

    friend DoubleDouble operator+(DoubleDouble a, DoubleDouble b) {
        DoubleDouble sum = exact_sum(a.head_, b.head_), rest = exact_sum(a.tail_, b.tail_);
        sum = ordered_sum(sum.head_, sum.tail_ + rest.head_);
        return ordered_sum(sum.head_, sum.tail_ + rest.tail_);
    }
    friend DoubleDouble operator-(DoubleDouble a) { return {-a.head_, -a.tail_}; }
    friend DoubleDouble operator-(DoubleDouble a, DoubleDouble b) { return a + -b; }
    friend DoubleDouble operator*(DoubleDouble a, DoubleDouble b) {
        DoubleDouble const p = exact_product(a.head_, b.head_);
        return ordered_sum(p.head_, p.tail_ + (a.head_ * b.tail_ + a.tail_ * b.head_));
    }
    friend DoubleDouble operator/(DoubleDouble a, DoubleDouble b) {
        double const first = a.head_ / b.head_;
        DoubleDouble rest = a - DoubleDouble(first) * b;
        double const second = rest.head_ / b.head_;
        rest = rest - DoubleDouble(second) * b;
        return ordered_sum(first, second) + DoubleDouble(rest.head_ / b.head_);
    }
    friend DoubleDouble sqrt(DoubleDouble a) {
        if (!(a.head_ > 0)) return DoubleDouble(std::sqrt(a.head_));
        double const root = std::sqrt(a.head_);  // and one step of Newton's
        return DoubleDouble(root) + DoubleDouble((a - exact_product(root, root)).head_ / (2 * root));
    }
    DoubleDouble& operator+=(DoubleDouble b) { return *this = *this + b; }
    DoubleDouble& operator-=(DoubleDouble b) { return *this = *this - b; }
    DoubleDouble& operator*=(DoubleDouble b) { return *this = *this * b; }
    DoubleDouble& operator/=(DoubleDouble b) { return *this = *this / b; }

    friend bool operator==(DoubleDouble a, DoubleDouble b) { return a.head_ == b.head_ && a.tail_ == b.tail_; }
    friend bool operator<(DoubleDouble a, DoubleDouble b) {
        return a.head_ < b.head_ || (a.head_ == b.head_ && a.tail_ < b.tail_);
    }
    friend bool operator>(DoubleDouble a, DoubleDouble b) { return b < a; }
    friend bool operator<=(DoubleDouble a, DoubleDouble b) { return a < b || a == b; }
    friend bool operator>=(DoubleDouble a, DoubleDouble b) { return b <= a; }
    friend bool isfinite(DoubleDouble a) { return std::isfinite(a.head_); }
};

}  // namespace rlslab::live

template <>
struct rlslab::ArithmeticTraits<rlslab::live::DoubleDouble> {
    static constexpr std::string_view name = "double-double";
    static constexpr int digits = 106, min_exp = -916, max_exp = 1023;
};
template <>
struct Eigen::NumTraits<rlslab::live::DoubleDouble> : rlslab::detail::StorageTraits<rlslab::live::DoubleDouble> {};
