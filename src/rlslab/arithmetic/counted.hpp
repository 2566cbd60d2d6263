// A scalar that counts its operations, so that the cost of an update is measured.
#pragma once

#include <rlslab/arithmetic/thread_state.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>

#include <concepts>
#include <functional>
#include <mutex>
#include <utility>

namespace rlslab {

/// Operations by kind. A subtraction is an addition. Changes of sign, comparisons, constructions and conversions are
/// not counted.
struct Tally {
    long additions = 0, multiplications = 0, divisions = 0, square_roots = 0;

    long total() const { return additions + multiplications + divisions + square_roots; }
    friend Tally operator-(Tally const& a, Tally const& b) {
        return {a.additions - b.additions, a.multiplications - b.multiplications, a.divisions - b.divisions,
                a.square_roots - b.square_roots};
    }
    friend Tally operator+(Tally const& a, Tally const& b) {
        return {a.additions + b.additions, a.multiplications + b.multiplications, a.divisions + b.divisions,
                a.square_roots + b.square_roots};
    }
    friend bool operator==(Tally const&, Tally const&) = default;
};

namespace detail {
inline constinit thread_local Tally operations_so_far{};
}

/// The operations of all Counted<T> in this thread during the call. Calls may be nested: the outer one counts those of
/// the inner one too.
template <std::invocable Work>
Tally counted(Work&& work) {
    Tally const before = detail::operations_so_far;
    std::invoke(std::forward<Work>(work));
    return detail::operations_so_far - before;
}

/// A T that counts each of its operations, whatever the values: a multiplication by 0 or 1 counts.
template <Field T>
class Counted {
    T value_ = T(0);

public:
    Counted() = default;
    template <class X>
        requires(!std::same_as<X, Counted> && std::constructible_from<T, X const&>)
    explicit Counted(X const& x) : value_(static_cast<T>(x)) {}
    T const& value() const { return value_; }
    explicit operator double() const { return static_cast<double>(value_); }

    Counted& operator+=(Counted const& b) {
        ++detail::operations_so_far.additions;
        value_ += b.value_;
        return *this;
    }
    Counted& operator-=(Counted const& b) {
        ++detail::operations_so_far.additions;
        value_ -= b.value_;
        return *this;
    }
    Counted& operator*=(Counted const& b) {
        ++detail::operations_so_far.multiplications;
        value_ *= b.value_;
        return *this;
    }
    Counted& operator/=(Counted const& b) {
        ++detail::operations_so_far.divisions;
        value_ /= b.value_;
        return *this;
    }
    friend Counted operator+(Counted a, Counted const& b) { return a += b; }
    friend Counted operator-(Counted a, Counted const& b) { return a -= b; }
    friend Counted operator*(Counted a, Counted const& b) { return a *= b; }
    friend Counted operator/(Counted a, Counted const& b) { return a /= b; }
    friend Counted operator-(Counted const& a) { return Counted(T(-a.value_)); }
    friend Counted sqrt(Counted const& a)
        requires Real<T>
    {
        ++detail::operations_so_far.square_roots;
        return Counted(square_root(a.value_));
    }

    friend Counted abs(Counted const& a) { return Counted(absolute(a.value_)); }
    friend bool isfinite(Counted const& a) { return is_finite(a.value_); }
    friend bool operator==(Counted const& a, Counted const& b) { return a.value_ == b.value_; }
    friend bool operator!=(Counted const& a, Counted const& b) { return a.value_ != b.value_; }
    friend bool operator<(Counted const& a, Counted const& b) { return a.value_ < b.value_; }
    friend bool operator<=(Counted const& a, Counted const& b) { return a.value_ <= b.value_; }
    friend bool operator>(Counted const& a, Counted const& b) { return a.value_ > b.value_; }
    friend bool operator>=(Counted const& a, Counted const& b) { return a.value_ >= b.value_; }
};

/// Afterwards the tally is what it was before.
template <class T>
struct UncountedScope<Counted<T>> {
    Tally const before = detail::operations_so_far;
    UncountedScope() = default;
    ~UncountedScope() { detail::operations_so_far = before; }
    UncountedScope(UncountedScope const&) = delete;
    UncountedScope& operator=(UncountedScope const&) = delete;
};

template <class T>
struct ArithmeticTraits<Counted<T>> : ArithmeticTraits<T> {
    static constexpr std::string_view name = "counted";
};

/// The operations of the other threads are added to the calling thread's tally when the ThreadState is destroyed.
template <class T>
class ThreadState<Counted<T>> : public ThreadState<T> {
    mutable std::mutex mutex_;
    mutable Tally parts_{};

public:
    ~ThreadState() { detail::operations_so_far = detail::operations_so_far + parts_; }
    class Part : ThreadState<T>::Part {
        ThreadState const& state_;
        Tally before_ = detail::operations_so_far;

    public:
        Part(ThreadState const& state, std::uint64_t part) : ThreadState<T>::Part(state, part), state_(state) {}
        ~Part() {
            std::lock_guard const lock(state_.mutex_);
            state_.parts_ = state_.parts_ + (detail::operations_so_far - before_);
            detail::operations_so_far = before_;
        }
    };
};

template <class T>
Reference widen(Counted<T> const& x) {
    return widen(x.value());
}

}  // namespace rlslab

/// Eigen's constants are those of T; none of them counts an operation.
template <class T>
struct Eigen::NumTraits<rlslab::Counted<T>> : rlslab::detail::StorageTraits<rlslab::Counted<T>> {
    using Number = rlslab::Counted<T>;
    static Number dummy_precision() { return Number(NumTraits<T>::dummy_precision()); }
    static Number highest() { return Number(NumTraits<T>::highest()); }
    static Number lowest() { return Number(NumTraits<T>::lowest()); }
    static Number infinity() { return Number(NumTraits<T>::infinity()); }
    static Number quiet_NaN() { return Number(NumTraits<T>::quiet_NaN()); }
};
