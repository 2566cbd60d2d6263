// Coloured noise whose model is not estimated: instruments, which the noise does not reach.
#pragma once

#include <rlslab/adapt/outputs.hpp>

#include <array>
#include <tuple>
#include <utility>

namespace rlslab {

namespace detail {
/// Several outputs of one regressor through any variant: a filter each, where MultiOutput shares P.
template <class F, int M>
class FilterEach {
    using T = typename F::scalar;
    decltype(copies_of<M>(Index(1), std::declval<F const&>())) filters_;

public:
    explicit FilterEach(Problem<T> const& problem, Index outputs) : filters_(copies_of<M>(outputs, F(problem))) {}
    Step<T> update(Regressor<T> psi, Regressor<T> y) {
        Step<T> out = filters_[0].update(psi, y[0]);
        for (size_t j = 1; j < filters_.size(); ++j)
            out.health = worse(out.health, filters_[j].update(psi, y[Index(j)]).health);
        return out;
    }
    F const& filter() const { return filters_[0]; }
    void theta(Index j, StateVector<T, size_of<F>>& out) const { theta_of(filters_[size_t(j)], out); }
    static auto state(auto& f) { return std::tie(f.filters_); }
};
/// The same, where they share P.
template <class F, int M>
class SharedFilter {
    using T = typename F::scalar;
    MultiOutput<F, M> outputs_;

public:
    explicit SharedFilter(Problem<T> const& problem, Index outputs) : outputs_(problem, outputs) {}
    Step<T> update(Regressor<T> psi, Regressor<T> y) {
        auto const steps = outputs_.update(psi, y);
        Step<T> out = steps[0];
        for (Step<T> const& step : steps) out.health = worse(out.health, step.health);
        return out;
    }
    F const& filter() const { return outputs_.filter(); }
    void theta(Index j, StateVector<T, size_of<F>>& out) const { keep_regressor(outputs_.theta_of(j), out); }
    static auto state(auto& f) { return std::tie(f.outputs_); }
};
template <class F, int M>
struct OfOneRegressor {
    using type = FilterEach<F, M>;
};
template <class F, int M>
    requires(ReportsCovariance<F> && requires { typename MultiOutput<F, M>; })
struct OfOneRegressor<F, M> {
    using type = SharedFilter<F, M>;
};
}  // namespace detail

/// Instrumental variables in two stages, recursive: y = psi'theta + v, where v is coloured, so that the first q numbers
/// of psi (past outputs, or inputs with errors) depend on it. The m >= q instruments zeta (past inputs, and what else
/// of psi v does not reach) depend on psi and not on v.
///
///   (1) stage 1, a MultiOutput<G>, takes (zeta, psi_1 ... psi_q); w_i is its innovation if its gamma >= 3/4, else its
///       residual; 0 for i > q
///   (2) psihat = psi - w: for i <= q zeta'Theta_i, of before this row, or of after it
///   (3) stage 2, any variant F, takes psihat and the outputs y - psi'theta0, w_1 ... w_q: beta and Gamma
///   (4) (I + [Gamma 0]) (theta - theta0) = beta, a system of q equations
///
/// (4) makes theta that of the instruments psihat, whatever the prior of stage 1: with lambda = 1
///   (P0^-1 + sum psihat psi') theta = P0^-1 theta0 + sum psihat y,
/// though every matrix that is propagated is symmetric. beta alone has a larger variance for every N: stage 1 moves
/// while stage 2 sums, so that psihat and w are not orthogonal as in the batch. Theta of before the row does not depend
/// on the row's v: no bias of first order where v is white. But where the row's share 1 - gamma in its own fit is
/// large, psihat would be an extrapolation whose weight stays; Theta of after the row is safe there. docs/theory.md 90.
///
/// zeta        of (psi_{q+1} ... psi_d) and of lags at least q; any numbers. While stage 1 has had m rows or fewer
///             psihat is about psi, and the start that of least squares, if its prior is vague: P0 zeta^2 above 1
/// a row with a number that is not finite is missing: time passes in both stages, no theta changes
/// P           stored() is F's. sigma^2 P is the covariance of theta for many rows where v is white of variance sigma^2
/// step        innovation y - psi'theta_{k-1}, residual y - psi'theta_k, gamma of F, health the worst of all stages;
///             undetermined where (4) is singular: theta is then undefined() until the next row
///
/// F           a form of P that MultiOutput takes shares it; other variants are q + 1 filters
/// Allocates where it is made, and later as F does. Cost: G's row, F's with q more outputs, q^3/3 + d q for (4). Throws
/// std::invalid_argument unless 1 <= q <= d, m >= q, and for a psi or zeta of another size. Source: Söderström & Stoica
/// 1989, ch. 8 (cited, not read), for two stages in a batch; (3) and (4) derived, docs/theory.md 90.
template <OverOrderedField F, class G = F, int Q = Dynamic>
    requires(
        !requires { F::departs; } && ReportsCovariance<G> && requires { typename MultiOutput<G, Q>; } &&
        std::same_as<typename F::scalar, typename G::scalar>)
class InstrumentalVariables {
    using T = typename F::scalar;
    static constexpr int N = detail::size_of<F>, M = Q == Dynamic ? Dynamic : Q + 1;
    typename detail::OfOneRegressor<F, M>::type second_;
    MultiOutput<G, Q> first_;
    StateVector<T, N> theta0_, theta_, psihat_;
    StateVector<T, detail::size_of<G>> zeta_;
    StateVector<T, M> outputs_;                                                                   // y - psi'theta0, w
    decltype(detail::copies_of<M>(Index(1), std::declval<StateVector<T, N> const&>())) columns_;  // beta, Gamma

    static Index checked(Problem<T> const& problem, Index q) {
        Index const d = rlslab::checked(problem, N).size;
        expects(1 <= q && q <= (d > 0 ? d : N), "1 <= correlated regressors <= parameters");
        return q;
    }
    static Problem<T> from_zero(Problem<T> problem) {
        if (problem.prior) problem.prior->theta.reset();
        return problem;
    }

public:
    using scalar = T;
    static constexpr std::string_view name = F::name;

    /// `problem` of d parameters is stage 2's, `instruments` of m parameters stage 1's. Where both forget, at the same
    /// rate.
    explicit InstrumentalVariables(Problem<T> const& problem, Problem<T> const& instruments, Index correlated = Q)
        : second_(from_zero(problem), checked(problem, correlated) + 1), first_(instruments, correlated),
          theta0_(second_.filter().theta().size()), theta_(theta0_.size()), psihat_(theta0_.size()),
          zeta_(first_.filter().theta().size()), outputs_(correlated + 1),
          columns_(detail::copies_of<M>(correlated + 1, theta_)) {
        expects(zeta_.size() >= correlated, "as many instruments as correlated regressors, or more");
        if (problem.prior && problem.prior->theta) keep_regressor(Regressor<T>(*problem.prior->theta), theta0_, theta_);
    }

    /// psi, zeta may be any numbers of this filter.
    Step<T> update(Regressor<T> psi, Regressor<T> zeta, T y) {
        expects(psi.size() == theta_.size() && zeta.size() == zeta_.size() && psi.size() > 0,
                "as many regressors as parameters, as many instruments as stage 1 has");
        keep_regressor(zeta, zeta_);
        keep_regressor(psi, psihat_);
        if (!is_finite(y) || !all_finite(zeta_) || !all_finite(psihat_)) return pass_time();
        T const e = innovation(y, psihat(), theta_), shifted = innovation(y, psihat(), theta0_);
        auto const fitted = first_.update({zeta_.data(), zeta_.size()}, {psihat_.data(), correlated()});  // (1)
        outputs_[0] = shifted;
        Health health = Health::sound;
        for (Index i = 0; i < correlated(); ++i) {
            Step<T> const& of = fitted[size_t(i)];
            outputs_[i + 1] = T(3) <= T(4) * of.gamma ? of.innovation : of.residual;
            health = worse(health, of.health);
            psihat_[i] -= outputs_[i + 1];  // (2)
        }
        Step<T> step = second_.update(psihat(), outputs());  // (3)
        bool const determined = step.health != Health::undetermined;
        bool const regular = solve();
        T left = innovation(y, psihat(), theta_);
        for (Index i = 0; i < correlated(); ++i) left -= outputs_[i + 1] * theta_[i];
        step.innovation = determined ? e : undefined<T>();
        step.residual = determined ? left : undefined<T>();
        step.health = worse(worse(health, step.health), regular ? Health::sound : Health::undetermined);
        if (step.health == Health::sound) step = if_finite<T>(is_finite(left), step);
        return step;
    }
    /// A row that is missing. Its step has no innovation and no residual.
    Step<T> pass_time() {
        for (Index i = 0; i < zeta_.size(); ++i) zeta_[i] = T(0);
        for (Index i = 0; i < psihat_.size(); ++i) psihat_[i] = T(0);
        for (Index i = 0; i < outputs_.size(); ++i) outputs_[i] = T(0);
        Health health = Health::sound;
        for (Step<T> const& step : first_.update({zeta_.data(), zeta_.size()}, {psihat_.data(), correlated()}))
            health = worse(health, step.health);
        Step<T> const step = second_.update(psihat(), outputs());
        return {undefined<T>(), undefined<T>(), step.gamma, worse(health, step.health)};
    }

    Index correlated() const { return outputs_.size() - 1; }  ///< q
    auto theta() const { return theta_.view(); }
    auto gain() const { return filter().gain(); }
    Stored<T> stored() const { return filter().stored(); }
    F const& filter() const { return second_.filter(); }                         ///< of y: its theta() is beta
    MultiOutput<G, Q> const& first() const { return first_; }                    ///< stage 1
    Regressor<T> psihat() const { return {psihat_.data(), psihat_.size()}; }     ///< of the last row
    Regressor<T> outputs() const { return {outputs_.data(), outputs_.size()}; }  ///< y - psi'theta0, w of the last row

    static constexpr std::string_view layer = "instruments";
    static std::array<StateOption, 1> options(auto const& f) { return {{{"correlated", double(f.correlated())}}}; }
    static auto state(auto& f) { return std::tie(f.second_, f.first_, f.theta0_, f.theta_); }

private:
    /// (4), by elimination with pivots. False where a pivot is 0.
    bool solve() {
        Index const q = correlated(), d = theta_.size();
        for (Index j = 0; j <= q; ++j) second_.theta(j, columns_[size_t(j)]);
        StateVector<T, N>& beta = columns_[0];
        auto const at = [this](Index i, Index j) -> T& { return columns_[size_t(j) + 1][i]; };
        for (Index j = 0; j < q; ++j) at(j, j) += T(1);
        for (Index j = 0; j < q; ++j) {
            Index best = j;
            for (Index i = j + 1; i < q; ++i)
                if (absolute(at(best, j)) < absolute(at(i, j))) best = i;
            for (Index l = j; l < q; ++l) std::swap(at(j, l), at(best, l));
            std::swap(beta[j], beta[best]);
            if (at(j, j) == T(0)) {
                for (Index i = 0; i < d; ++i) theta_[i] = undefined<T>();
                return false;
            }
            for (Index i = j + 1; i < q; ++i) {
                T const times = at(i, j) / at(j, j);
                for (Index l = j + 1; l < q; ++l) at(i, l) -= times * at(j, l);
                beta[i] -= times * beta[j];
            }
        }
        for (Index j = q - 1; j >= 0; --j) {
            T x = beta[j];
            for (Index l = j + 1; l < q; ++l) x -= at(j, l) * theta_[l];
            theta_[j] = x / at(j, j);
        }
        for (Index i = q; i < d; ++i) {
            T x = beta[i];
            for (Index l = 0; l < q; ++l) x -= at(i, l) * theta_[l];
            theta_[i] = x;
        }
        for (Index i = 0; i < d; ++i) theta_[i] += theta0_[i];
        return true;
    }
};

}  // namespace rlslab
