// Significands of any length: a double that holds p bits, every operation's exact result rounded once to nearest.
#pragma once

#include <rlslab/arithmetic/carried.hpp>
#include <rlslab/arithmetic/format.hpp>
#include <rlslab/arithmetic/storage_traits.hpp>

#include <cmath>
#include <compare>
#include <stdexcept>

namespace rlslab {

/// While one is alive, this thread's Bits have so many bits, 2 to 53; then as many as before. Outside of any: 53.
class [[nodiscard]] Precision {
    static inline constinit thread_local int current_ = 53;
    int previous_;

public:
    explicit Precision(int bits) : previous_(current_) {
        if (bits < 2 || bits > 53) throw std::invalid_argument("expected 2 to 53 bits of precision");
        current_ = bits;
    }
    ~Precision() { current_ = previous_; }
    Precision(Precision const&) = delete;
    Precision& operator=(Precision const&) = delete;
    static int bits() { return current_; }
};

/// head + tail to p bits, ties to even, where head is the double nearest to the exact value and tail has the sign of what is
/// missing: where head is a midpoint of the p-bit numbers the exact value need not be one. Exponents are double's.
inline double round_to_bits(double head, double tail, int p) {
    using namespace detail;
    if (p == 53 || !is_number(head)) return head;
    std::uint64_t const ulp = std::uint64_t{1} << (53 - p), bits = bits_of(head), rest = bits & (ulp - 1), below = bits - rest;
    double const out = outward(head, tail);
    bool const up = rest > ulp / 2 || (rest == ulp / 2 && (out > 0 || (out == 0 && (below & ulp) != 0)));
    return from_bits(below + (up ? ulp : 0));
}

/// How many bits it takes, asked as one run after another: what Precision says when an operation is done.
class Bits {
    double value_ = 0;
    struct Exact {};
    Bits(double x, Exact) : value_(x) {}
    static Bits rounded(double head, double tail) { return {round_to_bits(head, tail, Precision::bits()), Exact{}}; }

public:
    Bits() = default;
    explicit Bits(double x) : value_(round_to_bits(x, 0, Precision::bits())) {}
    explicit operator double() const { return value_; }

    friend Bits operator+(Bits a, Bits b) {    // Knuth's TwoSum: the tail is exact
        double const x = a.value_, y = b.value_, sum = x + y, of_y = sum - x, of_x = sum - of_y;
        return rounded(sum, (x - of_x) + (y - of_y));
    }
    friend Bits operator-(Bits a, Bits b) { return a + -b; }
    friend Bits operator*(Bits a, Bits b) {
        double const product = a.value_ * b.value_;
        return rounded(product, std::fma(a.value_, b.value_, -product));
    }
    friend Bits operator/(Bits a, Bits b) {    // the remainder is exact
        double const quotient = a.value_ / b.value_;
        return rounded(quotient, quotient == 0 ? 0.0 : std::fma(-quotient, b.value_, a.value_) / b.value_);
    }
    friend Bits operator-(Bits a) { return {-a.value_, Exact{}}; }
    friend Bits sqrt(Bits a) {
        double const root = std::sqrt(a.value_);
        return rounded(root, std::fma(-root, root, a.value_));
    }
    Bits& operator+=(Bits b) { return *this = *this + b; }
    Bits& operator-=(Bits b) { return *this = *this - b; }
    Bits& operator*=(Bits b) { return *this = *this * b; }
    Bits& operator/=(Bits b) { return *this = *this / b; }

    friend Bits abs(Bits a) { return {detail::magnitude(a.value_), Exact{}}; }
    friend bool isfinite(Bits a) { return detail::is_number(a.value_); }
    friend bool operator==(Bits const&, Bits const&) = default;
    friend auto operator<=>(Bits const&, Bits const&) = default;
};

template <>
struct Carried<Bits> {
    int bits = Precision::bits();
    struct Part : Precision {
        Part(Carried const& carried, std::uint64_t) : Precision(carried.bits) {}
    };
};

template <>
struct ArithmeticTraits<Bits> {
    static constexpr std::string_view name = "bits";
    static constexpr int digits = 53, min_exp = -1022, max_exp = 1023;
};
template <>
inline int significand_bits<Bits>() {
    return Precision::bits();
}

}  // namespace rlslab

template <>
struct Eigen::NumTraits<rlslab::Bits> : rlslab::detail::StorageTraits<rlslab::Bits> {
    using Number = rlslab::Bits;
    static Number highest() { return Number(std::numeric_limits<double>::max()); }
    static Number lowest() { return -highest(); }
    static Number infinity() { return Number(std::numeric_limits<double>::infinity()); }
    static Number quiet_NaN() { return Number(std::numeric_limits<double>::quiet_NaN()); }
};
