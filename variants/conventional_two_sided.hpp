// Conventional RLS with the row product computed on its own: Verhaegen's distinction.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates P in full storage. The column P psi and the row psi'P are computed separately, so the lemma holds for the
/// stored P even when it is not symmetric, and the antisymmetric part decays.
///
///   (1) f = P psi, h = P'psi       (2) s = lambda + psi'f           (3) K = f / s
///   (4) P = (P - K h') / lambda    (5) theta += K e
///
/// Storage d^2; per update 4 d^2 + O(d) multiplications. Source: Verhaegen 1989.
template <Scalar T, int N = Dynamic>
class ConventionalTwoSided {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_lambda_;
    StateVector<T, N> theta_, f_, h_, K_;
    StateMatrix<T, N> P_;

public:
    using scalar = T;
    static constexpr std::string_view name = "conventional_two_sided";
    static constexpr Family family{Family::conventional, 1};

    explicit ConventionalTwoSided(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_lambda_(lambda_), theta_(start_theta<T, N>(problem)),
          f_(problem.size), h_(problem.size), K_(problem.size), P_(start_covariance<T, N>(problem)) {}

    /// `perturb(K)` changes K between (3) and (4). Its error reaches P in first order: docs/theory.md 16.
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) { return commit(look(psi, y), perturb); }
    Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply(P_, psi.data(), f_);                                                                    // (1)
        multiply_transposed(P_, psi.data(), h_);
        return {e, lambda_ + real_part(dot(psi, f_))};                                                   // (2)
    }
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        auto const [e, s] = row;
        divide(f_, s, K_);                                                                               // (3)
        perturb(K_);
        subtract_rank_one(P_, K_, h_, by_lambda_);                                                       // (4)
        add_scaled(theta_, e, K_);                                                                       // (5)
        return step_of(e, lambda_, s, theta_);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return P_.view(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::plain, P_.view()}; }
    auto form() requires Field<T> { return PlainCovariance<T, N>{lambda_, by_lambda_, theta_, K_, f_, P_}; }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_lambda_, f.theta_, f.K_, f.P_); }
};
static_assert(GainPerturbable<ConventionalTwoSided<double>>);

}  // namespace rlslab
