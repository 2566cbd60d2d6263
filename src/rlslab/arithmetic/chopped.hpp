// Short formats, emulated: a double holds a number of the Format, and the exact result of every operation is rounded
// once to it.
#pragma once

#include <rlslab/arithmetic/thread_state.hpp>
#include <rlslab/arithmetic/format.hpp>
#include <rlslab/arithmetic/storage_traits.hpp>
#include <rlslab/core/encoding.hpp>
#include <rlslab/core/misuse.hpp>
#include <rlslab/core/random.hpp>

#include <cmath>
#include <compare>

namespace rlslab {

/// Stochastic rounding in this thread draws from `seed` until this object is destroyed. Then the previous stream
/// continues. `seed` advances with each draw and belongs to the caller, who must keep it alive. An object that stores a
/// Seed beside its numbers can therefore be replayed and copied bit for bit.
class [[nodiscard]] StochasticStream {
    static inline constinit thread_local Seed* current_ = nullptr;
    Seed* previous_;

public:
    explicit StochasticStream(Seed& seed) : previous_(current_) { current_ = &seed; }
    ~StochasticStream() { current_ = previous_; }
    StochasticStream(StochasticStream const&) = delete;
    StochasticStream& operator=(StochasticStream const&) = delete;

    /// This thread's seed; null when no stream is installed.
    static Seed* installed() { return current_; }
    /// The same; throws std::invalid_argument when no stream is installed.
    static Seed& current() {
        expects(current_, "a StochasticStream in this thread: rounding is stochastic");
        return *current_;
    }
    static double uniform() { return current().uniform(); }  ///< the next draw
};

/// A number of the format F. Rounding to nearest needs only double's result (see round_to_nearest). The other roundings
/// also need the tail: the exact result minus double's.
template <Format F, Rounding R = Rounding::nearest>
class Chopped {
    static_assert(fits_in_double(F));
    double value_ = 0;

    struct AlreadyRounded {};
    Chopped(double x, AlreadyRounded) : value_(x) {}

    /// `tail` is called only if the rounding needs it.
    template <class Tail>
    static Chopped rounded(double head, Tail&& tail) {
        if constexpr (R == Rounding::nearest) return {round_to_nearest(head, F), AlreadyRounded{}};
        else if constexpr (R == Rounding::toward_zero) return {round_toward_zero(head, tail(), F), AlreadyRounded{}};
        else return {round_stochastically(head, tail(), F, &StochasticStream::uniform), AlreadyRounded{}};
    }
    static double none() { return 0; }

public:
    Chopped() = default;
    explicit Chopped(double x) : value_(rounded(x, none).value_) {}
    explicit operator double() const { return value_; }

    friend Chopped operator+(Chopped a, Chopped b) {
        double const x = a.value_, y = b.value_, sum = x + y;
        return rounded(sum, [=] {  // Knuth's TwoSum: exact
            double const of_y = sum - x, of_x = sum - of_y;
            return (x - of_x) + (y - of_y);
        });
    }
    friend Chopped operator-(Chopped a, Chopped b) { return a + -b; }
    friend Chopped operator*(Chopped a, Chopped b) { return rounded(a.value_ * b.value_, none); }
    friend Chopped operator/(Chopped a, Chopped b) {
        double const x = a.value_, y = b.value_, quotient = x / y;
        return rounded(quotient, [=] {  // the remainder is exact; it is 0 for 0 / y and x / infinity
            return quotient == 0 ? 0.0 : std::fma(-quotient, y, x) / y;
        });
    }
    friend Chopped operator-(Chopped a) { return {-a.value_, AlreadyRounded{}}; }
    friend Chopped sqrt(Chopped a) {
        double const x = a.value_, root = std::sqrt(x);
        return rounded(root, [=] {  // x - root^2 = (sqrt(x) - root) (sqrt(x) + root), exact
            double const rest = std::fma(-root, root, x);
            return rest == 0 ? 0.0 : rest / (2 * root);
        });
    }
    Chopped& operator+=(Chopped b) { return *this = *this + b; }
    Chopped& operator-=(Chopped b) { return *this = *this - b; }
    Chopped& operator*=(Chopped b) { return *this = *this * b; }
    Chopped& operator/=(Chopped b) { return *this = *this / b; }

    friend Chopped abs(Chopped a) { return {detail::magnitude(a.value_), AlreadyRounded{}}; }
    friend bool isfinite(Chopped a) { return detail::is_number(a.value_); }
    friend bool operator==(Chopped const&, Chopped const&) = default;
    friend auto operator<=>(Chopped const&, Chopped const&) = default;
};

/// Each part of the work draws from its own seed, made from one draw of the calling thread and the number of the part.
template <Format F>
struct ThreadState<Chopped<F, Rounding::stochastic>> {
    std::uint64_t drawn = StochasticStream::current().next();
    class Part {
        Seed seed_;
        StochasticStream stream_;

    public:
        Part(ThreadState const& state, std::uint64_t part) : seed_{Seed{state.drawn + part}.next()}, stream_(seed_) {}
    };
};

/// Afterwards the stream continues from where it was before.
template <Format F>
struct UncountedScope<Chopped<F, Rounding::stochastic>> {
    Seed* const stream = StochasticStream::installed();
    Seed const before = stream ? *stream : Seed{};
    UncountedScope() = default;
    ~UncountedScope() {
        if (stream) *stream = before;
    }
    UncountedScope(UncountedScope const&) = delete;
    UncountedScope& operator=(UncountedScope const&) = delete;
};

using Half = Chopped<binary16>;
using HalfZero = Chopped<binary16, Rounding::toward_zero>;
using HalfStochastic = Chopped<binary16, Rounding::stochastic>;
using BFloat16 = Chopped<bfloat16>;
using BFloat16Zero = Chopped<bfloat16, Rounding::toward_zero>;
using BFloat16Stochastic = Chopped<bfloat16, Rounding::stochastic>;
using Tf32 = Chopped<tf32>;
using Tf32Zero = Chopped<tf32, Rounding::toward_zero>;
using Tf32Stochastic = Chopped<tf32, Rounding::stochastic>;

/// The name as on the command line. A format without a name is "chopped".
constexpr std::string_view name_of(Format format, Rounding rounding) {
    constexpr std::string_view names[][3] = {{"binary16", "binary16-zero", "binary16-stochastic"},
                                             {"bfloat16", "bfloat16-zero", "bfloat16-stochastic"},
                                             {"tf32", "tf32-zero", "tf32-stochastic"},
                                             {"chopped", "chopped-zero", "chopped-stochastic"}};
    int const row = format == binary16 ? 0 : format == bfloat16 ? 1 : format == tf32 ? 2 : 3;
    return names[row][static_cast<int>(rounding)];
}

template <Format F, Rounding R>
struct ArithmeticTraits<Chopped<F, R>> {
    static constexpr std::string_view name = name_of(F, R);
    static constexpr int digits = F.digits, min_exp = F.min_exp, max_exp = F.max_exp;
};

namespace detail {
template <Format F>
struct IsOfFormat {
    bool operator()(double x) const { return x != x || round_to_nearest(x, F) == x; }
};
}  // namespace detail
template <Format F, Rounding R>
struct Encoding<Chopped<F, R>> : EncodingInDouble<Chopped<F, R>, detail::IsOfFormat<F>> {};

}  // namespace rlslab

template <rlslab::Format F, rlslab::Rounding R>
struct Eigen::NumTraits<rlslab::Chopped<F, R>> : rlslab::detail::StorageTraits<rlslab::Chopped<F, R>> {
    using Number = rlslab::Chopped<F, R>;
    static Number highest() { return Number(rlslab::largest(F)); }
    static Number lowest() { return -highest(); }
    static Number infinity() { return Number(std::numeric_limits<double>::infinity()); }
    static Number quiet_NaN() { return Number(std::numeric_limits<double>::quiet_NaN()); }
};
