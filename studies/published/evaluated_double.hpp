// binary64 with another evaluation of the same text: products fused into the sums they enter, or dot products in
// another order.
#pragma once

#include <rlslab/arithmetic/storage_traits.hpp>
#include <rlslab/core/encoding.hpp>
#include <rlslab/linalg/dot.hpp>

#include <cmath>
#include <compare>
#include <concepts>

namespace rlslab::studies {

/// lanes: as the library has it, eight running lanes and a tree (linalg/dot.hpp). forward, backward: one running sum.
enum class DotOrder { lanes, forward, backward };

/// A double. With fused, a product is kept as its two factors until it is used: in a sum it is fused, c + a b = fma(a,
/// b, c), wherever else it is rounded. Of two products the second is fused: a b + c d = fma(c, d, a b). That is what
/// -ffp-contract=fast allows a compiler on the text as it stands; the text of a variant does not change.
template <bool fused, DotOrder order>
class EvaluatedDouble {
    double value_ = 0;

public:
    /// a b, not yet rounded.
    struct Product {
        double a, b;
        operator EvaluatedDouble() const { return EvaluatedDouble(a * b); }
        explicit operator double() const { return a * b; }
        friend Product operator-(Product const& p) { return {-p.a, p.b}; }
        friend EvaluatedDouble square_root(Product const& p) { return sqrt(EvaluatedDouble(p)); }
    };
    using Times = std::conditional_t<fused, Product, EvaluatedDouble>;

    EvaluatedDouble() = default;
    explicit EvaluatedDouble(double x) : value_(x) {}
    explicit operator double() const { return value_; }

    friend EvaluatedDouble operator+(EvaluatedDouble a, EvaluatedDouble b) {
        return EvaluatedDouble(a.value_ + b.value_);
    }
    friend EvaluatedDouble operator-(EvaluatedDouble a, EvaluatedDouble b) {
        return EvaluatedDouble(a.value_ - b.value_);
    }
    friend EvaluatedDouble operator+(EvaluatedDouble c, Product p) {
        return EvaluatedDouble(std::fma(p.a, p.b, c.value_));
    }
    friend EvaluatedDouble operator+(Product p, EvaluatedDouble c) { return c + p; }
    friend EvaluatedDouble operator+(Product p, Product q) { return EvaluatedDouble(p) + q; }
    friend EvaluatedDouble operator-(EvaluatedDouble c, Product p) { return c + -p; }
    friend EvaluatedDouble operator-(Product p, EvaluatedDouble c) { return -c + p; }
    friend EvaluatedDouble operator-(Product p, Product q) { return EvaluatedDouble(p) + -q; }
    friend Times operator*(EvaluatedDouble a, EvaluatedDouble b) {
        if constexpr (fused) return {a.value_, b.value_};
        else return EvaluatedDouble(a.value_ * b.value_);
    }
    friend EvaluatedDouble operator/(EvaluatedDouble a, EvaluatedDouble b) {
        return EvaluatedDouble(a.value_ / b.value_);
    }
    friend EvaluatedDouble operator-(EvaluatedDouble a) { return EvaluatedDouble(-a.value_); }
    friend EvaluatedDouble sqrt(EvaluatedDouble a) { return EvaluatedDouble(std::sqrt(a.value_)); }
    EvaluatedDouble& operator+=(EvaluatedDouble b) { return *this = *this + b; }
    EvaluatedDouble& operator-=(EvaluatedDouble b) { return *this = *this - b; }
    EvaluatedDouble& operator+=(Product p) { return *this = *this + p; }
    EvaluatedDouble& operator-=(Product p) { return *this = *this - p; }
    EvaluatedDouble& operator*=(EvaluatedDouble b) { return *this = EvaluatedDouble(value_ * b.value_); }
    EvaluatedDouble& operator/=(EvaluatedDouble b) { return *this = *this / b; }

    friend EvaluatedDouble abs(EvaluatedDouble a) { return EvaluatedDouble(std::abs(a.value_)); }
    friend bool isfinite(EvaluatedDouble a) { return std::isfinite(a.value_); }
    friend bool operator==(EvaluatedDouble a, EvaluatedDouble b) { return a.value_ == b.value_; }
    friend auto operator<=>(EvaluatedDouble a, EvaluatedDouble b) { return a.value_ <=> b.value_; }
};
using FusedDouble = EvaluatedDouble<true, DotOrder::lanes>;
using ForwardDouble = EvaluatedDouble<false, DotOrder::forward>;
using BackwardDouble = EvaluatedDouble<false, DotOrder::backward>;

/// x'y in that order; 0 for n <= 0.
template <bool fused, DotOrder order>
    requires(order != DotOrder::lanes)
EvaluatedDouble<fused, order> dot(EvaluatedDouble<fused, order> const* x, EvaluatedDouble<fused, order> const* y,
                                  Index n) {
    using T = EvaluatedDouble<fused, order>;
    if (n <= 0) return T(0.0);
    bool const up = order == DotOrder::forward;
    T sum = x[up ? 0 : n - 1] * y[up ? 0 : n - 1];
    for (Index k = 1; k < n; ++k) {
        Index const i = up ? k : n - 1 - k;
        sum += x[i] * y[i];
    }
    return sum;
}

}  // namespace rlslab::studies

namespace rlslab {

template <bool fused, studies::DotOrder order>
struct ArithmeticTraits<studies::EvaluatedDouble<fused, order>> : ArithmeticTraits<double> {
    static constexpr std::string_view name = fused                                  ? "fused"
                                             : order == studies::DotOrder::forward  ? "forward"
                                             : order == studies::DotOrder::backward ? "backward"
                                                                                    : "double";
};
namespace detail {
struct EveryDouble {
    bool operator()(double) const { return true; }
};
}  // namespace detail
template <bool fused, studies::DotOrder order>
struct Encoding<studies::EvaluatedDouble<fused, order>>
    : EncodingInDouble<studies::EvaluatedDouble<fused, order>, detail::EveryDouble> {};

}  // namespace rlslab

template <bool fused, rlslab::studies::DotOrder order>
struct Eigen::NumTraits<rlslab::studies::EvaluatedDouble<fused, order>>
    : rlslab::detail::StorageTraits<rlslab::studies::EvaluatedDouble<fused, order>> {
    using Number = rlslab::studies::EvaluatedDouble<fused, order>;
    static Number highest() { return Number(std::numeric_limits<double>::max()); }
    static Number lowest() { return -highest(); }
    static Number infinity() { return Number(std::numeric_limits<double>::infinity()); }
    static Number quiet_NaN() { return Number(std::numeric_limits<double>::quiet_NaN()); }
};
