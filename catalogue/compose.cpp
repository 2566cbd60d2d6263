// Compositions in one arithmetic. Compiled once for each RLSLAB_ARITHMETIC in which they exist.
#include <rlslab/catalogue/compose.hpp>
#include <rlslab/catalogue/erase.hpp>

#include <rlslab/adapt/rules.hpp>
#include <rlslab/arithmetic/arithmetics.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab {
namespace {
using T = ArithmeticAt<RLSLAB_ARITHMETIC>;
}

template <>
std::unique_ptr<AnyAdaptive<T>::Interface> AnyAdaptive<T>::named(std::string_view variant, Problem<T> const& problem) {
    std::unique_ptr<Interface> out;
    for_each(Variants<T>{}, [&]<class F>() {
        if constexpr (!TakesBlocks<F>)
            if (F::name == variant) out = std::make_unique<Around<F>>(F(problem));
    });
    expects(out != nullptr, "a variant that takes single rows");
    return out;
}

namespace {

/// Kalman's filter with a random walk of its own, Q = q I at every row, and the reports that intervals need.
struct Walking {
    using scalar = T;
    static constexpr std::string_view name = Kalman<T>::name;
    static constexpr bool departs = true;
    Kalman<T> kalman;

    explicit Walking(Problem<T> const& problem, T const& q = T(0))
        : kalman(problem, Matrix<T>(Matrix<T>::Identity(problem.size, problem.size) * q)) {}
    Step<T> update(Regressor<T> psi, T y) { return kalman.update(psi, y); }
    Vector<T> theta() const { return kalman.theta(); }
    Vector<T> gain() const { return kalman.gain(); }
    Stored<T> stored() const { return kalman.stored(); }
    bool follows_a_rule() const { return true; }
    friend T variance(Walking& w, Index j) { return w.kalman.stored().F(j, j); }
    friend T variance_along(Walking& w, Regressor<T> psi) {
        Matrix<T> const P = w.kalman.covariance();
        T sum = T(0);
        for (Index j = 0; j < P.cols(); ++j) {
            T const along = dot(P.col(j).data(), psi.data(), psi.size()), term = psi[j] * along;
            sum += term;
        }
        return sum;
    }
};

/// What a filter hands over to. Beyond 53 bits there is nothing.
template <class From>
struct SounderThan;
template <>
struct SounderThan<float> {
    using type = Ud<double>;
};
template <>
struct SounderThan<double> {
    using type = Ud<Quad>;
};

/// The variant by itself, or with the sounder one that it can hand over to.
AnyAdaptive<T> innermost(Composition const& c, std::string_view variant, Problem<T> const& problem) {
    std::optional<AnyAdaptive<T>> out;
    if (c.policy().hands_over())
        for_each(Variants<T>{}, [&]<class F>() {
            if constexpr (ReportsLeastShare<F> && Downdates<F> &&
                          requires { typename SounderThan<typename F::scalar>::type; })
                if (F::name == variant)
                    out = AnyAdaptive<T>::around(Relay<F, typename SounderThan<typename F::scalar>::type>(problem));
        });
    return out ? *out : AnyAdaptive<T>(problem, variant);
}

/// The rule with these numbers, in the order of its own that have a name on the command line.
template <class Rule>
Rule rule_of(std::vector<double> const& parameters) {
    Rule rule;
    [[maybe_unused]] size_t i = 0;
    detail::for_each_number<Rule>([&]<class X>(RuleNumber<Rule, X> const& n) {
        if (n.name.empty()) return;
        double const x = parameters.at(i++);
        if constexpr (std::same_as<X, T>) rule.*n.at = round_to<T>(x);
        else rule.*n.at = X(x);
    });
    return rule;
}

AnyAdaptive<T> with_control(Composition const& c, AnyAdaptive<T> const& filter, Problem<T> const& problem) {
    AnyAdaptive<T> out = filter;
    if (c.keeps_the_problem()) return out;
    for_each(Rules<T>{}, [&]<class Rule>() {
        if (Rule::name == c.control)
            out =
                AnyAdaptive<T>::around(Forgetting<AnyAdaptive<T>, Rule>(filter, problem, rule_of<Rule>(c.parameters)));
    });
    return out;
}

AnyAdaptive<T> with_guard(Composition const& c, AnyAdaptive<T> const& filter, Problem<T> const& problem) {
    AnyAdaptive<T> out = filter;
    [&]<size_t... I>(std::index_sequence<I...>) {
        ((guard_policies[I].name == c.guard
              ? void(out = AnyAdaptive<T>::around(Guarded<AnyAdaptive<T>, guard_policies[I].policy>(filter, problem)))
              : void()),
         ...);
    }(std::make_index_sequence<std::size(guard_policies)>());
    return out;
}

class Composed final : public ComposedFilter {
    Assessed<AnyAdaptive<T>> filter_;

    static Vector<T> rounded(Regressor<double> psi) {
        return Eigen::Map<Vector<double> const>(psi.data(), psi.size()).unaryExpr(&round_to<T>);
    }
    static Step<double> in_doubles(Step<T> const& s) {
        return {in_double(s.innovation), in_double(s.residual), in_double(s.gamma), s.health};
    }
    /// Of a variant that does not tell its variances.
    static Interval<double> alone(T const& value) {
        double const none = std::numeric_limits<double>::quiet_NaN();
        return {in_double(value), none, none, none};
    }
    static Interval<double> in_doubles(Interval<T> const& i) {
        return {in_double(i.value), in_double(i.deviation), in_double(i.low), in_double(i.high)};
    }

public:
    Composed(AnyAdaptive<T> const& filter, T const& forgetting) : filter_(filter, forgetting) {}

    Step<double> update(Regressor<double> psi, double y) override {
        return in_doubles(filter_.update(rounded(psi), round_to<T>(y)));
    }
    Step<double> update(Regressor<double>, double, Matrix<double> const&) override {
        throw std::invalid_argument("expected a variant alone: a composition takes no errors in its gain");
    }
    Step<double> update_block(Records const& records, Index first, Index last) override {
        double const none = std::numeric_limits<double>::quiet_NaN();
        Step<double> step{none, none, none};
        for (Index k = first; k < last; ++k) step = update(records.sample(k), records.y[k]);
        return step;
    }
    Vector<Reference> theta() const override { return filter_.theta().unaryExpr(&widened<T>); }
    Vector<Reference> gain() const override { return filter_.gain().unaryExpr(&widened<T>); }
    Stored<Reference> stored() const override { return filter_.stored().template mapped<Reference>(&widened<T>); }
    Stored<double> stored_in_double() const override { return in_double(filter_.stored()); }
    std::unique_ptr<AnyFilter> clone() const override { return std::make_unique<Composed>(*this); }
    std::vector<std::byte> saved() const override {
        throw std::invalid_argument(
            "expected a variant alone: save a composition by its type (<rlslab/state/state.hpp>)");
    }
    void load(std::span<std::byte const>) override {
        throw std::invalid_argument(
            "expected a variant alone: load a composition by its type (<rlslab/state/state.hpp>)");
    }
    CompositionCounts counts() const override { return filter_.filter().composition_counts(); }
    double noise_variance() const override {
        return filter_.degrees() > 0 ? in_double(filter_.noise_variance()) : std::nan("");
    }
    Interval<double> interval(Index j, double q) override {
        if (!filter_.filter().abilities().variances) return alone(filter_.theta()[j]);
        return in_doubles(filter_.interval(j, T(q)));
    }
    Interval<double> prediction(Regressor<double> psi, double q) override {
        Vector<T> const row = rounded(psi), theta = filter_.theta();
        if (!filter_.filter().abilities().variances) return alone(dot(row.data(), theta.data(), row.size()));
        return in_doubles(filter_.prediction(row, T(q)));
    }
};

}  // namespace

template <>
std::unique_ptr<ComposedFilter> compose<RLSLAB_ARITHMETIC>(Composition const& c, std::string_view variant,
                                                           Problem<double> const& given) {
    Problem<T> const problem = problem_as<T>(given);
    constexpr char const* in_range = "numbers of the control in the arithmetic's range";
    for (double const x : c.parameters)
        expects(is_finite(round_to<T>(x)) && (x == 0 || !(round_to<T>(x) == T(0))), in_range);
    for (size_t i = 0; i < c.parameters.size(); ++i)
        if (control_named(c.control).parameters.at(i).range.inverted)
            expects(is_finite(T(1) / round_to<T>(c.parameters[i])), in_range);
    if (is_its_own_rule(c, variant))
        return std::make_unique<Composed>(AnyAdaptive<T>::around(Walking(problem, round_to<T>(c.parameters.at(0)))),
                                          problem.forgetting);
    AnyAdaptive<T> filter = innermost(c, variant, problem);
    if (c.window > 0)
        filter = AnyAdaptive<T>::around(Windowed<AnyAdaptive<T>>(filter, problem.forgetting, {.rows = c.window}));
    filter = with_guard(c, with_control(c, filter, problem), problem);
    return std::make_unique<Composed>(filter, problem.forgetting);
}

}  // namespace rlslab
