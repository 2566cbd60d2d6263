// binary64 with another evaluation of the same text: products fused into the sums they enter.
#pragma once

#include <rlslab/arithmetic/storage_traits.hpp>
#include <rlslab/core/encoding.hpp>

#include <cmath>
#include <compare>
#include <limits>

namespace rlslab::studies {

/// A double. A product is kept as its two factors until it is used: in a sum it is fused, c + a b = fma(a, b, c),
/// wherever else it is rounded. Of two products the second is fused: a b + c d = fma(c, d, a b). That is what
/// -ffp-contract=fast allows a compiler on the text as it stands; the text of a variant does not change.
class FusedDouble {
    double value_ = 0;

public:
    /// a b, not yet rounded.
    struct Product {
        double a, b;
        operator FusedDouble() const { return FusedDouble(a * b); }
        explicit operator double() const { return a * b; }
        friend Product operator-(Product const& p) { return {-p.a, p.b}; }
        friend FusedDouble square_root(Product const& p) { return sqrt(FusedDouble(p)); }
    };

    FusedDouble() = default;
    explicit FusedDouble(double x) : value_(x) {}
    explicit operator double() const { return value_; }

    friend FusedDouble operator+(FusedDouble a, FusedDouble b) { return FusedDouble(a.value_ + b.value_); }
    friend FusedDouble operator-(FusedDouble a, FusedDouble b) { return FusedDouble(a.value_ - b.value_); }
    friend FusedDouble operator+(FusedDouble c, Product p) { return FusedDouble(std::fma(p.a, p.b, c.value_)); }
    friend FusedDouble operator+(Product p, FusedDouble c) { return c + p; }
    friend FusedDouble operator+(Product p, Product q) { return FusedDouble(p) + q; }
    friend FusedDouble operator-(FusedDouble c, Product p) { return c + -p; }
    friend FusedDouble operator-(Product p, FusedDouble c) { return -c + p; }
    friend FusedDouble operator-(Product p, Product q) { return FusedDouble(p) + -q; }
    friend Product operator*(FusedDouble a, FusedDouble b) { return {a.value_, b.value_}; }
    friend FusedDouble operator/(FusedDouble a, FusedDouble b) { return FusedDouble(a.value_ / b.value_); }
    friend FusedDouble operator-(FusedDouble a) { return FusedDouble(-a.value_); }
    friend FusedDouble sqrt(FusedDouble a) { return FusedDouble(std::sqrt(a.value_)); }
    FusedDouble& operator+=(FusedDouble b) { return *this = *this + b; }
    FusedDouble& operator-=(FusedDouble b) { return *this = *this - b; }
    FusedDouble& operator+=(Product p) { return *this = *this + p; }
    FusedDouble& operator-=(Product p) { return *this = *this - p; }
    FusedDouble& operator*=(FusedDouble b) { return *this = FusedDouble(value_ * b.value_); }
    FusedDouble& operator/=(FusedDouble b) { return *this = *this / b; }

    friend FusedDouble abs(FusedDouble a) { return FusedDouble(std::abs(a.value_)); }
    friend bool isfinite(FusedDouble a) { return std::isfinite(a.value_); }
    friend bool operator==(FusedDouble a, FusedDouble b) { return a.value_ == b.value_; }
    friend auto operator<=>(FusedDouble a, FusedDouble b) { return a.value_ <=> b.value_; }
};

}  // namespace rlslab::studies

namespace rlslab {

template <>
struct ArithmeticTraits<studies::FusedDouble> : ArithmeticTraits<double> {
    static constexpr std::string_view name = "fused";
};
namespace detail {
struct EveryDouble {
    bool operator()(double) const { return true; }
};
}  // namespace detail
template <>
struct Encoding<studies::FusedDouble> : EncodingInDouble<studies::FusedDouble, detail::EveryDouble> {};

}  // namespace rlslab

template <>
struct Eigen::NumTraits<rlslab::studies::FusedDouble> : rlslab::detail::StorageTraits<rlslab::studies::FusedDouble> {
    using Number = rlslab::studies::FusedDouble;
    static Number highest() { return Number(std::numeric_limits<double>::max()); }
    static Number lowest() { return -highest(); }
    static Number infinity() { return Number(std::numeric_limits<double>::infinity()); }
    static Number quiet_NaN() { return Number(std::numeric_limits<double>::quiet_NaN()); }
};
