// Numbers that a double holds: the exact result of every operation is rounded once, by a rule.
#pragma once

#include <rlslab/arithmetic/format.hpp>
#include <rlslab/arithmetic/storage_traits.hpp>
#include <rlslab/arithmetic/thread_state.hpp>
#include <rlslab/core/encoding.hpp>
#include <rlslab/core/misuse.hpp>
#include <rlslab/core/random.hpp>

#include <cmath>
#include <compare>

namespace rlslab {

/// Stochastic rounding in this thread draws from `seed` until this object is destroyed. Then the previous stream
/// continues. `seed` advances with each draw and belongs to the caller, who must keep it alive. An object that stores a
/// Seed beside its numbers can therefore be replayed and copied bit for bit.
class [[nodiscard]] StochasticStream : detail::ThreadScope<Seed*> {
public:
    explicit StochasticStream(Seed& seed) : ThreadScope(&seed) {}

    /// This thread's seed; null when no stream is installed.
    static Seed* installed() { return now(); }
    /// The same; throws std::invalid_argument when no stream is installed.
    static Seed& current() {
        expects(now(), "a StochasticStream in this thread: rounding is stochastic");
        return *now();
    }
    static double uniform() { return current().uniform(); }  ///< the next draw
};

/// A number of the rule's format. The rule is a class of static members:
///   round(head, tail)   an exact result as a number. head: the double nearest to it. tail(): the exact result minus
///                       head, as a double of its sign; called only if the rounding needs it
///   of(x), nearest(x)   a double as a number, and as data: to nearest, whatever operations do
///   format(), widest    the format of this thread now, and the one of which ArithmeticTraits and storage know
///   is_number(x)        whether a saved x is read again
///   name                as on the command line
///   may_draw            whether there are settings in which it rounds at random; then also draws(): whether it does
///                       now, Setting, setting(): what else it depends on in this thread, and Scope: sets that
template <class Rule>
class Rounded {
    double value_ = 0;

    struct AlreadyRounded {};
    Rounded(double x, AlreadyRounded) : value_(x) {}
    template <class Tail>
    static Rounded rounded(double head, Tail tail) {
        return {Rule::round(head, tail), AlreadyRounded{}};
    }

public:
    Rounded() = default;
    explicit Rounded(double x) : value_(Rule::of(x)) {}
    explicit operator double() const { return value_; }

    // by reference: g++ 12 ends with an internal error where a rounding may throw and these are values (pass sra)
    friend Rounded operator+(Rounded const& a, Rounded const& b) {
        double const x = a.value_, y = b.value_, sum = x + y;
        return rounded(sum, [=] {  // Knuth's TwoSum: exact
            double const of_y = sum - x, of_x = sum - of_y;
            return (x - of_x) + (y - of_y);
        });
    }
    friend Rounded operator-(Rounded const& a, Rounded const& b) { return a + -b; }
    friend Rounded operator*(Rounded const& a, Rounded const& b) {
        double const x = a.value_, y = b.value_, product = x * y;
        return rounded(product, [=] { return std::fma(x, y, -product); });
    }
    friend Rounded operator/(Rounded const& a, Rounded const& b) {
        double const x = a.value_, y = b.value_, quotient = x / y;
        return rounded(quotient, [=] {  // the remainder is exact; it is 0 for 0 / y and x / infinity
            return quotient == 0 ? 0.0 : std::fma(-quotient, y, x) / y;
        });
    }
    friend Rounded operator-(Rounded a) { return {-a.value_, AlreadyRounded{}}; }
    friend Rounded sqrt(Rounded a) {
        double const x = a.value_, root = std::sqrt(x);
        return rounded(root, [=] {  // x - root^2 = (sqrt(x) - root) (sqrt(x) + root), exact
            double const rest = std::fma(-root, root, x);
            return rest == 0 ? 0.0 : rest / (2 * root);
        });
    }
    Rounded& operator+=(Rounded b) { return *this = *this + b; }
    Rounded& operator-=(Rounded b) { return *this = *this - b; }
    Rounded& operator*=(Rounded b) { return *this = *this * b; }
    Rounded& operator/=(Rounded b) { return *this = *this / b; }

    friend Rounded abs(Rounded a) { return {detail::magnitude(a.value_), AlreadyRounded{}}; }
    friend bool isfinite(Rounded a) { return detail::is_number(a.value_); }
    friend bool operator==(Rounded const&, Rounded const&) = default;
    friend auto operator<=>(Rounded const&, Rounded const&) = default;
};

/// The parts have the thread's setting. Where they round at random each draws from its own seed, made from one draw of
/// the calling thread and the number of the part.
template <class Rule>
    requires Rule::may_draw
struct ThreadState<Rounded<Rule>> {
    typename Rule::Setting setting = Rule::setting();
    std::uint64_t drawn = Rule::draws() ? StochasticStream::current().next() : 0;
    class Part {
        typename Rule::Scope scope_;
        Seed seed_;
        StochasticStream stream_;

    public:
        Part(ThreadState const& state, std::uint64_t part)
            : scope_(state.setting), seed_{Seed{state.drawn + part}.next()}, stream_(seed_) {}
    };
};

/// Afterwards the stream continues from where it was before.
template <class Rule>
    requires Rule::may_draw
struct UncountedScope<Rounded<Rule>> {
    Seed* const stream = StochasticStream::installed();
    Seed const before = stream ? *stream : Seed{};
    UncountedScope() = default;
    ~UncountedScope() {
        if (stream) *stream = before;
    }
    UncountedScope(UncountedScope const&) = delete;
    UncountedScope& operator=(UncountedScope const&) = delete;
};

template <class Rule>
struct ArithmeticTraits<Rounded<Rule>> {
    static constexpr std::string_view name = Rule::name;
    static constexpr int digits = Rule::widest.digits, min_exp = Rule::widest.min_exp, max_exp = Rule::widest.max_exp;
};

namespace detail {
template <class Rule>
struct IsNumberOf {
    bool operator()(double x) const { return Rule::is_number(x); }
};
}  // namespace detail
template <class Rule>
struct Encoding<Rounded<Rule>> : EncodingInDouble<Rounded<Rule>, detail::IsNumberOf<Rule>> {};

}  // namespace rlslab

template <class Rule>
struct Eigen::NumTraits<rlslab::Rounded<Rule>> : rlslab::detail::StorageTraits<rlslab::Rounded<Rule>> {
    using Number = rlslab::Rounded<Rule>;
    static Number highest() { return Number(rlslab::largest(Rule::format())); }
    static Number lowest() { return -highest(); }
    static Number infinity() { return Number(std::numeric_limits<double>::infinity()); }
    static Number quiet_NaN() { return Number(std::numeric_limits<double>::quiet_NaN()); }
};
