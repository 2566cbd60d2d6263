// The text of compositions, compiled for each arithmetic in which they exist.
#pragma once

#include <rlslab/catalogue/native/compose.hpp>

#include <rlslab/adapt/rules.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab {

template <Real T>
std::unique_ptr<typename AnyAdaptive<T>::Interface> AnyAdaptive<T>::named(std::string_view variant,
                                                                          Problem<T> const& problem) {
    std::unique_ptr<Interface> out;
    for_each(Variants<T>{}, [&]<class F>() {
        if constexpr (std::same_as<typename F::scalar, T>)
            if (F::name == variant) out = interface_around(F(problem));
    });
    expects(out != nullptr, "the name of a variant");
    return out;
}

namespace detail {
/// Kalman's filter with a random walk of its own, Q = q I at every row, and the reports that intervals need.
template <Real T>
struct Walking {
    using scalar = T;
    static constexpr std::string_view name = Kalman<T>::name;
    static constexpr int edition = edition_of<Kalman<T>>();
    static constexpr bool departs = true;
    Kalman<T> kalman;

    explicit Walking(Problem<T> const& problem, T const& q = T(0))
        : kalman(problem, Matrix<T>(Matrix<T>::Identity(problem.size, problem.size) * q)) {}
    Step<T> update(Regressor<T> psi, T y) { return kalman.update(psi, y); }
    auto theta() const { return kalman.theta(); }
    auto gain() const { return kalman.gain(); }
    Stored<T> stored() const { return kalman.stored(); }
    Matrix<T> covariance() const { return kalman.covariance(); }
    static auto state(auto& w) { return Kalman<T>::state(w.kalman); }
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

/// The rule with these numbers, in the order of its own that have a name on the command line.
template <class T, class Rule>
Rule rule_of(std::vector<double> const& parameters) {
    Rule rule;
    [[maybe_unused]] size_t i = 0;
    detail::for_each_number<Rule>([&]<class X>(RuleNumber<Rule, X> const& n) {
        if (n.name.empty()) return;
        double const x = parameters.at(i++);
        if constexpr (std::same_as<X, T>) rule.*n.at = T(x);
        else rule.*n.at = X(x);
    });
    return rule;
}

template <Real T>
AnyAdaptive<T> with_probes(Index probes, AnyAdaptive<T> const& filter, Problem<T> const& problem) {
    AnyAdaptive<T> out = filter;
    expects(probes == 0 || std::floating_point<T>, "probes of a filter in float or double");
    if constexpr (std::floating_point<T>)
        [&]<int... below>(std::integer_sequence<int, below...>) {
            ((below + 1 == probes
                  ? void(out = AnyAdaptive<T>::around(Certified<AnyAdaptive<T>, below + 1>(filter, problem)))
                  : void()),
             ...);
        }(std::make_integer_sequence<int, most_probes>());
    return out;
}

template <Real T>
AnyAdaptive<T> with_control(Composition const& c, AnyAdaptive<T> const& filter, Problem<T> const& problem) {
    AnyAdaptive<T> out = filter;
    if (c.keeps_the_problem()) return out;
    for_each(Rules<T>{}, [&]<class Rule>() {
        if (Rule::name == c.control)
            out = AnyAdaptive<T>::around(
                Forgetting<AnyAdaptive<T>, Rule>(filter, problem, rule_of<T, Rule>(c.parameters)));
    });
    return out;
}

template <Real T>
AnyAdaptive<T> with_guard(Composition const& c, GuardOptions<double> const& given, AnyAdaptive<T> const& filter,
                          Problem<T> const& problem) {
    GuardOptions<T, true> const options{.largest_variance = T(given.largest_variance),
                                        .innovation = T(given.innovation),
                                        .least_noise = T(given.least_noise),
                                        .noise_memory = given.noise_memory,
                                        .asymmetry = T(given.asymmetry),
                                        .rebuild_rows = given.rebuild_rows,
                                        .digits = int(c.digits)};
    AnyAdaptive<T> out = filter;
    [&]<size_t... I>(std::index_sequence<I...>) {
        ((guard_policies[I].name == c.guard
              ? void(out = AnyAdaptive<T>::around(
                         Guarded<AnyAdaptive<T>, guard_policies[I].policy>(filter, problem, options)))
              : void()),
         ...);
    }(std::make_index_sequence<std::size(guard_policies)>());
    return out;
}

}  // namespace detail

template <Real T>
AnyAdaptive<T> composed_around(Composition const& c, GuardOptions<double> const& guard_options,
                               std::string_view variant, Problem<T> const& problem) {
    constexpr char const* in_range = "numbers of the control in the arithmetic's range";
    for (double const x : c.parameters) expects(is_finite(T(x)) && (x == 0 || !(T(x) == T(0))), in_range);
    for (size_t i = 0; i < c.parameters.size(); ++i)
        if (control_named(c.control).parameters.at(i).range.inverted)
            expects(is_finite(T(T(1) / T(c.parameters[i]))), in_range);
    if (is_its_own_rule(c, variant)) return AnyAdaptive<T>::around(detail::Walking<T>(problem, T(c.parameters.at(0))));
    AnyAdaptive<T> filter = detail::with_probes(c.certify, AnyAdaptive<T>(problem, variant), problem);
    if (c.window > 0)
        filter = AnyAdaptive<T>::around(Windowed<AnyAdaptive<T>>(filter, problem.forgetting, {.rows = c.window}));
    return detail::with_guard(c, guard_options, detail::with_control(c, filter, problem), problem);
}

}  // namespace rlslab
