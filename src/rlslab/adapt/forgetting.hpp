// Forgetting as a value: a filter and the rule by which its memory is shortened, apart.
#pragma once

#include <rlslab/adapt/around.hpp>
#include <rlslab/adapt/look.hpp>
#include <rlslab/adapt/rule_number.hpp>
#include <rlslab/state/lanes.hpp>

#include <limits>
#include <tuple>

namespace rlslab {

/// What a rule may keep from row to row.
template <Field T, int N>
struct RuleMemory {
    T lambda;           ///< Problem::forgetting, which the filter applies at every row besides the rule
    T strength = T(0);  ///< what the rule computed from its options and the problem
    BoundedCountOf<PerLane<T, Index>> rows{0, std::numeric_limits<Index>::max() / 2};  ///< taken so far
    StateVector<T, N> a;                                                               ///< workspace
};

/// A rule is an aggregate of options with
///   start(problem, memory)                     throws std::invalid_argument on misuse; the memory's type has F
///   update(filter, memory, psi, y) -> Step<T>  the filter's update, and before or after it what the rule does
/// and for states a `name` (or `layer`) and its `numbers()` (RuleNumber), without which two rules look alike there.
/// Those that the program knows by name are listed in rules.hpp.
/// F follows its problem: from a row that a guard skips, a rule would forget all the same.
template <class Rule, class F>
concept ForgettingRule =
    OverOrderedField<F> && KeepsItsRows<F> && std::copyable<Rule> &&
    !requires { F::departs; } &&  // a guard goes around the rule: Guarded<Forgetting<F, Rule>>
    requires(Rule const rule, F& f, Problem<typename F::scalar> problem,
             RuleMemory<typename F::scalar, detail::size_of<F>>& memory, Regressor<typename F::scalar> psi) {
        rule.start(problem, memory);
        { rule.update(f, memory, psi, typename F::scalar(0)) } -> std::same_as<Step<typename F::scalar>>;
    };

namespace detail {
template <class Rule>
constexpr std::string_view rule_name() {
    if constexpr (requires { Rule::layer; }) return Rule::layer;
    else if constexpr (requires { Rule::name; }) return Rule::name;
    else return "rule";
}
/// c a a' more in P, in these lanes where c > 0.
template <class T, Inflates F>
void inflate_lanes(F& f, Truth<T> const& lanes, T const& c, Regressor<T> a) {
    if (Truth<T> const some = lanes && T(0) < c; any(some)) on_lanes<T>(f, some, [&] { inflate(f, c, a); });
}
/// a = x e_j, where the row's number is j mod d: one for each lane, returned.
template <class T, int N>
PerLane<T, Index> turn(RuleMemory<T, N>& m, T const& x) {
    Index const d = m.a.size();
    PerLane<T, Index> const j = in_each_lane<T>(m.rows.n, [d](Index n) { return n % d; });
    for (Index i = 0; i < d; ++i) m.a[i] = select(equal_to<T>(j, i), x, T(0));
    return j;
}
}  // namespace detail

/// A filter whose forgetting follows a rule. Problem::forgetting is what the filter itself applies at every row, as
/// without a rule; most rules want it to be 1, which is the default. Allocates where F does, and not in updates; where
/// F solves for theta or K on request, a rule that asks for them does allocate at dynamic size. gain() is of the last
/// row that F took, which may be one of the rule's. Of packs: each lane has the bits of the scalar composition on its
/// own rows; the options are one for all lanes; where the rule acts in some lanes alone, a thread allocates at its
/// first such row.
template <OverOrderedField F, ForgettingRule<F> Rule>
class Forgetting : public detail::AroundFilter<F, true> {
    using T = typename F::scalar;
    using detail::AroundFilter<F, true>::filter_;
    Rule rule_;
    RuleMemory<T, detail::size_of<F>> memory_;

public:
    static constexpr bool departs = true;  ///< from the problem's J

    explicit Forgetting(Problem<T> const& problem, Rule const& rule = {}) : Forgetting(F(problem), problem, rule) {}
    /// Around a filter that was made of this problem, with options of its own.
    Forgetting(F const& filter, Problem<T> const& problem, Rule const& rule = {})
        : detail::AroundFilter<F, true>(filter), rule_(rule),
          memory_{.lambda = checked(problem, int(filter.theta().size())).forgetting,
                  .a = StateVector<T, detail::size_of<F>>(filter.theta().size())} {
        detail::for_each_number<Rule>([&](auto const& n) {
            if constexpr (requires { (rule_.*n.at)[0]; })
                expects(all(rule_.*n.at == T((rule_.*n.at)[0])), "a rule's numbers that are alike in all lanes");
        });
        rule_.start(problem, memory_);
    }

    Step<T> update(Regressor<T> psi, T y) {
        expects(psi.size() == memory_.a.size() && psi.size() > 0, "a regressor of the problem's size");
        Step<T> const step = rule_.update(filter_, memory_, psi, y);
        ++memory_.rows.n;
        return step;
    }
    /// e and s of the filter inside, before the rule has done anything.
    Innovation<T> look_inside(Regressor<T> psi, T const& y) { return detail::look_at(filter_, psi, y); }
    static constexpr std::string_view layer = detail::rule_name<Rule>();
    static auto options(auto const& f) {
        std::array<StateOption, std::tuple_size_v<decltype(detail::numbers_of<Rule>())> + 1> out;
        [[maybe_unused]] std::size_t i = 0;
        detail::for_each_number<Rule>([&](auto const& n) {
            out[i++] = {n.member, static_cast<double>(detail::of_lane(f.rule_.*n.at, 0))};
        });
        out.back() = {"rows", double(detail::of_lane(f.memory_.rows.n, 0)), true};
        return out;
    }
    static auto state(auto& f) { return std::tie(f.filter_, f.memory_.lambda, f.memory_.strength, f.memory_.rows); }
    Rule const& rule() const { return rule_; }
};

namespace detail {
template <HasOneLane F, template <class> class Rule, class T, int L>
struct OneLane<Forgetting<F, Rule<Pack<T, L>>>> {
    using type = Forgetting<OneLaneOf<F>, Rule<T>>;
};
}  // namespace detail

// --- rules -----------------------------------------------------------------------------------------------------------

/// The filter's own constant forgetting: the same bits as without a rule.
template <Field T>
struct ConstantForgetting {
    static constexpr std::string_view name = "constant", type = "ConstantForgetting";
    static constexpr std::string_view what = "the constant lambda at every row, as without a control";
    void start(Problem<T> const&, auto&) const {}
    Step<T> update(auto& f, auto&, Regressor<T> psi, T y) const { return f.update(psi, y); }
};

/// Variable forgetting that holds J, the sum of squares, at Sigma0 = sigma^2 N0:
///
///   (1) one row, without discount                      (2) lambda = Sigma0 / (Sigma0 + gamma e^2)
///   (3) least <= lambda                                (4) lambda = 1 where tr P / lambda > largest_trace
///   (5) P = P / lambda
///
/// (2) is exact: where J = Sigma0 before the row, it is after (5); Fortescue, Kershenbaum & Ydstie's 1 - gamma e^2 /
/// Sigma0 is its first order. A silent input with noise in y winds P up at 1/N0 a row: hence (4), d^2/2 multiplications
/// a row, only if a bound is given. Sources: Fortescue, Kershenbaum & Ydstie 1981; Cordero & Mayne 1981 (cited, not
/// read); (2) derived (docs/theory.md 57).
template <Field T>
struct Fortescue {
    T noise_variance = T(1);  ///< sigma^2 > 0
    T memory = T(100);        ///< N0 >= 1, in rows
    T least = T(0.5);         ///< of lambda, in (0, 1]
    T largest_trace = T(0);   ///< of P; 0: none
    static constexpr std::string_view name = "fortescue", type = "Fortescue";
    static constexpr std::string_view what =
        "lambda chosen at every row so that the sum of squares stays at VARIANCE times MEMORY rows, and not below "
        "LEAST; VARIANCE is that of the noise, without it estimated from the residuals";
    static constexpr auto numbers() {
        return std::tuple{RuleNumber{"noise_variance",
                                     &Fortescue::noise_variance,
                                     "VARIANCE",
                                     {.positive = true, .otherwise = RuleDefault::noise_variance}},
                          RuleNumber{"memory", &Fortescue::memory, "MEMORY", {.least = 1}},
                          RuleNumber{"least", &Fortescue::least, "LEAST", {.most = 1, .positive = true}},
                          RuleNumber{"largest_trace", &Fortescue::largest_trace}};
    }

    template <int N>
    void start(Problem<T> const&, RuleMemory<T, N>& m) const {
        expects(all(T(0) < noise_variance && T(1) <= memory), "a noise variance > 0 and a memory >= 1");
        expects(all(T(0) < least && least <= T(1)), "0 < least forgetting <= 1");
        expects(all(T(0) <= largest_trace), "a bound of the trace >= 0");
        m.strength = noise_variance * memory;
    }
    template <TimeUpdates F, int N>
        requires ReportsVariances<F>
    Step<T> update(F& f, RuleMemory<T, N>& m, Regressor<T> psi, T y) const {
        Step<T> const step = f.update(psi, y);  // (1)
        T const loss = step.innovation * step.residual, sum = m.strength + loss;
        Truth<T> const lost = T(0) < loss, finite = is_finite(loss);
        T lambda(1);
        if (Truth<T> const known = lost && finite; any(known))  // (2)
            lambda = select(known, T(m.strength / select(known, sum, T(1))), lambda);
        lambda = select((lost && !finite) || lambda < least, least, lambda);  // (3)
        if (any(T(0) < largest_trace))                                        // (4)
            lambda = select(trace(f) <= lambda * largest_trace, lambda, T(1));
        if (Truth<T> const forgets = lambda < T(1); any(forgets))  // (5)
            detail::on_lanes<T>(f, forgets, [&] { discount(f, lambda); });
        return step;
    }
};

/// Directional forgetting: after a row, the information along it is multiplied by phi, and along no other direction
/// (psi'u = 0) changed:
///
///   (1) one row: K = P psi, xi = psi'P psi, of the new P
///   (2) P += (1 - phi) / (phi xi) K K', where |psi|^2 >= least_excitation
///
/// P along a direction that no row excites stays as it is. Rows of noise alone wind P up: least_excitation is what to
/// regard as noise. Sources: Kulhavý & Kárný 1984, Kulhavý 1987 (cited, not read); the form that forgets after the row:
/// Bobál et al. 2005 (listing read).
template <Field T>
struct Kulhavy {
    T forgetting = T(0.98);     ///< phi, in (0, 1]
    T least_excitation = T(0);  ///< of psi'psi, >= 0
    static constexpr std::string_view name = "kulhavy", type = "Kulhavy";
    static constexpr std::string_view what =
        "forgets along the gain alone, after the row; rows of |psi|^2 < EXCITATION forget nothing";
    static constexpr auto numbers() {
        return std::tuple{
            RuleNumber{"forgetting", &Kulhavy::forgetting, "LAMBDA", {.most = 1, .positive = true, .inverted = true}},
            RuleNumber{"least_excitation", &Kulhavy::least_excitation, "EXCITATION"}};
    }

    template <int N>
    void start(Problem<T> const&, RuleMemory<T, N>&) const {
        expects(all(T(0) < forgetting && forgetting <= T(1)), "0 < directional forgetting <= 1");
        expects(all(T(0) <= least_excitation), "a least excitation >= 0");
    }
    template <Inflates F, int N>
    Step<T> update(F& f, RuleMemory<T, N>& m, Regressor<T> psi, T y) const {
        keep_regressor(psi, m.a);
        Step<T> const step = f.update(psi, y);  // (1)
        auto const K = f.gain();
        T const xi = dot(m.a.data(), K.data(), m.a.size()), c = (T(1) - forgetting) / (forgetting * xi);
        Truth<T> const excited = least_excitation <= dot(m.a, m.a) && T(0) < xi && is_finite(c);
        detail::inflate_lanes(f, excited, c, Regressor<T>(K));  // (2)
        return step;
    }
};

/// Directional forgetting along psi itself, before the row:
///
///   (1) P += (1 - phi) / (phi psi'P^-1 psi) psi psi', where |psi|^2 >= least_excitation         (2) one row
///
/// multiplies psi'P^-1 psi by phi. With eps = least_excitation, X = P^-1 and X0 the first, whatever the rows,
///   min(eps / (1 - phi), least eigenvalue of X0) <= eigenvalues of X <= max(max |psi|^2 / (1 - phi), largest of X0)
/// after each row. For forms that hold a factor, or P^-1.
/// Sources: Cao & Schwartz 2000; Lai & Bernstein 2024 (abstract read).
template <Field T>
struct CaoSchwartz {
    T forgetting = T(0.98);     ///< phi, in (0, 1]
    T least_excitation = T(0);  ///< of psi'psi, >= 0
    static constexpr std::string_view name = "cao_schwartz", type = "CaoSchwartz";
    static constexpr std::string_view what =
        "forgets along the regressor alone, before the row; rows of |psi|^2 < EXCITATION forget nothing";
    static constexpr auto numbers() {
        return std::tuple{
            RuleNumber{
                "forgetting", &CaoSchwartz::forgetting, "LAMBDA", {.most = 1, .positive = true, .inverted = true}},
            RuleNumber{"least_excitation", &CaoSchwartz::least_excitation, "EXCITATION"}};
    }

    template <int N>
    void start(Problem<T> const&, RuleMemory<T, N>&) const {
        expects(all(T(0) < forgetting && forgetting <= T(1)), "0 < directional forgetting <= 1");
        expects(all(T(0) <= least_excitation), "a least excitation >= 0");
    }
    template <Inflates F, int N>
        requires ReportsInformationAlong<F>
    Step<T> update(F& f, RuleMemory<T, N>& m, Regressor<T> psi, T y) const {
        keep_regressor(psi, m.a);
        Regressor<T> const row(m.a.data(), m.a.size());
        if (Truth<T> const excited = least_excitation <= dot(m.a, m.a); any(excited)) {
            T const c = (T(1) - forgetting) / (forgetting * information_along(f, psi));
            detail::inflate_lanes(f, excited && is_finite(c), c, row);  // (1)
        }
        return f.update(row, y);  // (2)
    }
};

/// A ridge that forgetting does not wear down, one coordinate a row:
///
///   (1) the filter's row, with lambda    (2) j = k mod d
///   (3) the row sqrt(r) e_j, r = ridge (1 - lambda^d), without discount
///
/// whose output is sqrt(r) theta_j as it is (`toward_zero` false: theta_j does not move, bit for bit where theta is
/// stored), or 0. Then P^-1 >= ridge lambda^(d-1) I and tr P <= d lambda^(1-d) / ridge whatever the regressors, if P0
/// <= I / ridge; from a larger P0 these are approached as lambda^k. Without a prior, (3) waits until the rows determine
/// theta. Cost of (3): one row. Sources: Gay 1996 (abstract read); derived (docs/theory.md 58). Toward zero, theta is
/// biased as by that ridge / (d (1 - lambda)).
template <Real T>
struct RotatingRidge {
    T ridge = T(0.001);  ///< rho > 0, in units of P^-1
    bool toward_zero = false;
    static constexpr std::string_view name = "ridge", type = "RotatingRidge";
    static constexpr std::string_view what =
        "information that a lambda below 1 does not wear down: P^-1 >= about RIDGE I";
    static constexpr bool below_one = true;
    static constexpr auto numbers() {
        return std::tuple{RuleNumber{"ridge", &RotatingRidge::ridge, "RIDGE", {.positive = true}},
                          RuleNumber{"toward_zero", &RotatingRidge::toward_zero}};
    }

    template <int N>
    void start(Problem<T> const& problem, RuleMemory<T, N>& m) const {
        expects(all(T(0) < ridge), "a ridge > 0");
        T worn = T(1);
        for (Index i = 0; i < m.a.size(); ++i) worn *= problem.forgetting;
        m.strength = square_root(T(ridge * (T(1) - worn)));
    }
    template <TimeUpdates F, int N>
    Step<T> update(F& f, RuleMemory<T, N>& m, Regressor<T> psi, T y) const {
        Step<T> const step = f.update(psi, y);                       // (1)
        PerLane<T, Index> const j = detail::turn<T>(m, m.strength);  // (2)
        T output(0);
        Truth<T> goes = true;
        if (!toward_zero) {
            auto const theta = f.theta();
            for (Index i = 0; i < m.a.size(); ++i) output = select(detail::equal_to<T>(j, i), T(theta[i]), output);
            output = T(m.strength * output);
            goes = !detail::equal_to<T>(step.health, Health::undetermined) && is_finite(output);
        }
        if (any(goes))
            detail::on_lanes<T>(f, goes, [&] {
                measure(f, Regressor<T>(m.a.data(), m.a.size()), output, T(1), m.lambda);  // (3)
            });
        return step;
    }
};

/// P = variance I every `period` rows; theta is kept. Left out while the rows do not determine theta.
/// Source: Goodwin, Elliott & Teoh 1983 (cited, not read).
template <Field T>
struct CovarianceReset {
    Index period = 1000;    ///< >= 1, in rows
    T variance = T(16384);  ///< k > 0
    static constexpr std::string_view name = "reset", type = "CovarianceReset";
    static constexpr std::string_view what = "P = VARIANCE I every PERIOD rows; without VARIANCE, the largest of P0";
    static constexpr auto numbers() {
        return std::tuple{RuleNumber{"period", &CovarianceReset::period, "PERIOD", {.least = 1, .most = 1e7}},
                          RuleNumber{"variance",
                                     &CovarianceReset::variance,
                                     "VARIANCE",
                                     {.positive = true, .otherwise = RuleDefault::prior_variance}}};
    }

    template <int N>
    void start(Problem<T> const&, RuleMemory<T, N>&) const {
        expects(period >= 1, "a period >= 1");
        expects(all(T(0) < variance), "a variance > 0");
    }
    template <TimeUpdates F, int N>
    Step<T> update(F& f, RuleMemory<T, N>& m, Regressor<T> psi, T y) const {
        Step<T> const step = f.update(psi, y);
        Truth<T> const due(detail::in_each_lane<T>(m.rows.n, [this](Index n) { return (n + 1) % period == 0; }));
        if (any(due)) {
            auto const theta = f.theta();
            Truth<T> const resets =
                due && !detail::equal_to<T>(step.health, Health::undetermined) && all_finite<T>(theta);
            if (any(resets)) detail::on_lanes<T>(f, resets, [&] { reset(f, variance, Regressor<T>(theta)); });
        }
        return step;
    }
};

/// A random walk of theta, Q = q I, one coordinate a row: before row k, P += d q e_j e_j', j = k mod d. The mean rate
/// is Q's; what was added is never more than (d - 1) q off in any coordinate. d^2 multiplications besides the row; a
/// full Q takes d^3/3 in a factored form. Source: derived (docs/theory.md 56); Kalman 1960 for Q.
template <Field T>
struct RandomWalk {
    T variance = T(0);  ///< q >= 0, a row, in units of the noise's
    static constexpr std::string_view name = "random_walk", type = "RandomWalk";
    static constexpr std::string_view what =
        "theta walks at random: Q = VARIANCE I per row on average, in units of the noise variance; each row adds to "
        "one coordinate in turn (kalman: to all)";
    static constexpr std::string_view layer = "walk";  ///< in saved states
    static constexpr auto numbers() {
        return std::tuple{RuleNumber{"variance", &RandomWalk::variance, "VARIANCE", {.otherwise = RuleDefault::none}}};
    }

    template <int N>
    void start(Problem<T> const&, RuleMemory<T, N>& m) const {
        expects(all(T(0) <= variance), "a variance of the walk >= 0");
        m.strength = T(int(m.a.size())) * variance;
    }
    template <Inflates F, int N>
    Step<T> update(F& f, RuleMemory<T, N>& m, Regressor<T> psi, T y) const {
        detail::turn<T>(m, T(1));
        detail::inflate_lanes<T>(f, true, m.strength, Regressor<T>(m.a.data(), m.a.size()));
        return f.update(psi, y);
    }
};

}  // namespace rlslab
