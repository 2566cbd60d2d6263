// Joseph's form expanded to a symmetric rank-two update: of second order in an error of K alone, at O(d^2).
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/block_gain.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates P in full storage; for any K, optimal or not, (4)-(5) is ((I - K psi')P(I - K psi')' + lambda K K') /
/// lambda. That takes f and s as in (1) and (2): an error in one of them enters P in first order (docs/theory.md 31).
///
///   (1) f = P psi                  (2) s = lambda + psi'f           (3) K = f / s
///   (4) g = f - (s/2) K            (5) P = (P - (K g' + g K')) / lambda              (6) theta += K e
///
/// K_i g_j' + g_i K_j' is the same number with i and j exchanged: P stays symmetric (why not always: docs/theory.md
/// 79). Storage d^2; per update 4 d^2 + O(d) multiplications. Source: De Vries' evaluation, in Grewal & Andrews.
template <Scalar T, int N = Dynamic>
class JosephRankTwo {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_lambda_;
    StateVector<T, N> theta_, f_, g_, K_;
    StateMatrix<T, N> P_;

public:
    using scalar = T;
    static constexpr std::string_view name = "joseph_rank_two";
    static constexpr Family family{Family::joseph, 1};

    explicit JosephRankTwo(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_lambda_(lambda_), theta_(start_theta<T, N>(problem)),
          f_(problem.size), g_(problem.size), K_(problem.size), P_(start_covariance<T, N>(problem)) {}

    /// `perturb(K)` changes K between (3) and (4). Its error reaches P in second order: docs/theory.md 17.
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) { return commit(look(psi, y), perturb); }
    Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply(P_, psi.data(), f_);                                                                    // (1)
        return {e, lambda_ + real_part(dot(psi, f_))};                                                   // (2)
    }
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        auto const [e, s] = row;
        divide(f_, s, K_);                                                                               // (3)
        perturb(K_);
        RealOf<T> const half = s / RealOf<T>(2);
        for (Index i = 0; i < f_.size(); ++i) g_[i] = f_[i] - half * K_[i];                              // (4)
        subtract_rank_two(P_, K_, g_, by_lambda_);                                                       // (5)
        add_scaled(theta_, e, K_);                                                                       // (6)
        return step_of(e, lambda_, s, theta_);
    }

    /// k >= 1 rows at once, the oldest first, psi of d x k: (1) to (7) of `block` (linalg/block_gain.hpp), which has K
    /// then; K's errors enter P in second order, k at a time. A number in psi or y that is not finite: all k rows are
    /// refused, nothing changes. Returns the worst health of the rows and of P's diagonal: `sound` does not prove P
    /// definite. P errs by u / lambda^k.
    template <class Perturb = NoPerturbation>
    Health update_block(RowsOf<T> psi, OutputsOf<T> y, BlockGain<T>& block, Perturb perturb = {})
        requires(Field<T> && std::same_as<Truth<T>, bool>)
    {
        Index const d = theta_.size(), k = y.size();
        expects(psi.rows() == d && psi.cols() == k && k >= 1, "a block of d x k regressors and k outputs, k >= 1");
        Strided<T> const P = strided(P_), theta{theta_.data(), 1, d};
        Health health = block.look(P, {psi.data(), 1, psi.outerStride()}, theta, {y.data(), 1, k}, d, k, 1, lambda_);
        if (health == Health::nonfinite) return health;
        T weight = T(1);
        for (Index j = 0; j < k; ++j) weight *= lambda_;
        block.commit(P, theta, DivisorNearOne<T>(weight), perturb);
        for (Index i = 0; i < d; ++i) {
            K_[i] = block.K()(i, k - 1);
            if (!(T(0) < P_(i, i))) health = Health::indefinite;
        }
        return all_finite(theta_) && all_finite<T>(P_.view().diagonal()) ? health : Health::nonfinite;
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return P_.view(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::plain, P_.view()}; }
    auto form() requires Field<T> { return PlainCovariance<T, N>{lambda_, by_lambda_, theta_, K_, f_, P_}; }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_lambda_, f.theta_, f.K_, f.P_); }
};
static_assert(GainPerturbable<JosephRankTwo<double>>);

}  // namespace rlslab
