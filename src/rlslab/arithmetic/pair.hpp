// Pair: a number as the unevaluated sum of two doubles, for what a longer word than double must carry in every row.
#pragma once

#include <rlslab/arithmetic/storage_traits.hpp>
#include <rlslab/core/encoding.hpp>

#include <cmath>

namespace rlslab {

/// high + low, |low| <= half an ulp of high: 106 bits or more, double's exponents. With u = 2^-53, and away from the
/// ends of the exponents, the relative error of a sum is at most 3 u^2, of a product 5 u^2, of a quotient 15 u^2, of a
/// root 4 u^2. An infinity or a NaN of `high` is the number, whatever `low` is. No product is fused: the same bits on
/// every processor. 20, 25, 140 and 70 operations of double. Source: Joldes, Muller & Popescu 2017 (algorithms 6 and
/// 10); the split: Dekker 1971; the quotient by long division, the root by a Newton step of double's: their bounds are
/// those of a search (tests/arithmetic/quad.cpp).
class Pair {
    double high_ = 0, low_ = 0;

    Pair(double high, double low) : high_(high), low_(low) {}
    static Pair fast_two_sum(double a, double b) {  // |a| >= |b|
        double const s = a + b;
        return {s, b - (s - a)};
    }
    static Pair two_sum(double a, double b) {
        double const s = a + b, of_b = s - a, of_a = s - of_b;
        return {s, (a - of_a) + (b - of_b)};
    }
    static Pair two_product(double a, double b) {
        double const p = a * b, ta = 0x1.0000002p27 * a, tb = 0x1.0000002p27 * b, ah = ta - (ta - a), al = a - ah,
                     bh = tb - (tb - b), bl = b - bh;
        return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
    }
    /// Where the high part is no number, the low one tells nothing.
    static Pair finished(double high, double low) {
        if (!std::isfinite(high)) return {high, 0};
        return fast_two_sum(high, low);
    }

public:
    Pair() = default;
    explicit(false) Pair(double x) : high_(x) {}
    explicit(false) Pair(int x) : high_(x) {}
    explicit operator double() const { return high_; }
    double high() const { return high_; }
    double low() const { return low_; }

    friend Pair operator+(Pair const& a, Pair const& b) {
        Pair const s = two_sum(a.high_, b.high_), t = two_sum(a.low_, b.low_);
        if (!std::isfinite(s.high_)) return {s.high_, 0};
        Pair const v = fast_two_sum(s.high_, s.low_ + t.high_);
        return fast_two_sum(v.high_, t.low_ + v.low_);
    }
    friend Pair operator-(Pair const& a) { return {-a.high_, -a.low_}; }
    friend Pair operator-(Pair const& a, Pair const& b) { return a + -b; }
    friend Pair operator*(Pair const& a, Pair const& b) {
        Pair const p = two_product(a.high_, b.high_);
        return finished(p.high_, p.low_ + (a.high_ * b.low_ + a.low_ * b.high_));
    }
    friend Pair operator/(Pair const& a, Pair const& b) {
        double const q = a.high_ / b.high_;
        if (!std::isfinite(q) || q == 0) return q;
        Pair left = a - Pair(q) * b;
        double const second = left.high_ / b.high_;
        left = left - Pair(second) * b;
        return fast_two_sum(q, second) + Pair(left.high_ / b.high_);
    }
    friend Pair sqrt(Pair const& a) {
        double const root = std::sqrt(a.high_);
        if (!std::isfinite(root) || root == 0) return root;
        Pair const left = a - two_product(root, root);
        return finished(root, left.high_ / (2 * root));
    }
    Pair& operator+=(Pair const& b) { return *this = *this + b; }
    Pair& operator-=(Pair const& b) { return *this = *this - b; }
    Pair& operator*=(Pair const& b) { return *this = *this * b; }
    Pair& operator/=(Pair const& b) { return *this = *this / b; }
    friend bool operator==(Pair const& a, Pair const& b) { return a.high_ == b.high_ && a.low_ == b.low_; }
    friend bool operator<(Pair const& a, Pair const& b) {
        return a.high_ < b.high_ || (a.high_ == b.high_ && a.low_ < b.low_);
    }
    friend bool operator>(Pair const& a, Pair const& b) { return b < a; }
    friend bool operator<=(Pair const& a, Pair const& b) { return a < b || a == b; }
    friend bool operator>=(Pair const& a, Pair const& b) { return b <= a; }
    friend bool isfinite(Pair const& a) { return std::isfinite(a.high_); }
    friend Pair abs(Pair const& a) { return a.high_ < 0 || (a.high_ == 0 && std::signbit(a.high_)) ? -a : a; }
};

template <>
struct ArithmeticTraits<Pair> {
    static constexpr std::string_view name = "pair";
    static constexpr int digits = 106, min_exp = -1022 + 53, max_exp = 1023;
};
template <>
struct Encoding<Pair> {
    static constexpr std::size_t size = 2 * Encoding<double>::size;
    static void write(Pair const& x, std::byte* to) {
        Encoding<double>::write(x.high(), to);
        Encoding<double>::write(x.low(), to + Encoding<double>::size);
    }
    static bool read(std::byte const* from, Pair& x) {
        double high, low;
        if (!Encoding<double>::read(from, high) || !Encoding<double>::read(from + Encoding<double>::size, low))
            return false;
        x = Pair(high) + Pair(low);
        return true;
    }
};

}  // namespace rlslab

template <>
struct Eigen::NumTraits<rlslab::Pair> : rlslab::detail::StorageTraits<rlslab::Pair> {};
