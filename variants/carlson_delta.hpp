// Carlson's triangular square-root form with S changed by its difference.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/start.hpp>
#include <rlslab/linalg/sweeps.hpp>

namespace rlslab {

/// Propagates the upper triangular square root S of the covariance, P = S S':
///
///   (1) f = S'psi        (2) s_j = s_{j-1} + |f_j|^2, s_0 = lambda
///   (3) k_j = sqrt(s_{j-1} / s_j) / sqrt(lambda),   m_j = (f_j / s_{j-1}) k_j
///       h_j = 1 - k_j = (|f_j|^2 - s_{j-1} (1 - lambda) / lambda) / (s_j (1 + k_j))
///   (4) v = 0, and for j = 1 ... d, i <= j, t = the old S_ij:  S_ij = t - (t h_j + v_i m_j'),  v_i += t f_j
///   (5) K = v / s_d, theta += K e
///
/// Where k_j < 1/2, S_ij = t k_j - v_i m_j', so that S_jj > 0 for any row. `carlson` multiplies S by the rounded root
/// of s_{j-1} / s_j and divides it by the rounded root of lambda: errors of one sign, which add up over
/// 1 / (1 - lambda) rows. Here neither is applied to S where k_j >= 1/2 (docs/theory.md 39, 45, 91).
/// Storage d^2 (half used); per update 2.5 d^2 + O(d) multiplications, d square roots.
/// Sources: Carlson 1973; Middleton & Goodwin 1986 (delta form); derived.
template <RootedScalar T, int N = Dynamic>
class CarlsonDelta {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_root_lambda_;
    StateVector<T, N> theta_, f_, m_, K_;
    StateVector<RealOf<T>, N> h_, before_, s_, k_, keep_;
    StateMatrix<T, N> S_;

public:
    using scalar = T;
    static constexpr std::string_view name = "carlson_delta";
    static constexpr Family family{Family::root, 2};

    explicit CarlsonDelta(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_root_lambda_(square_root(lambda_)),
          theta_(start_theta<T, N>(problem)), f_(problem.size), m_(problem.size), K_(problem.size), h_(problem.size),
          before_(problem.size), s_(problem.size), k_(problem.size), keep_(problem.size),
          S_(start_root<T, N>(problem)) {}

    /// `perturb(v_1 ... v_j, 1)` changes v after column j of (4). Its error reaches P in first order, P stays definite:
    /// docs/theory.md 33, 34.
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) { return commit(look(psi, y), perturb); }
    Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply_upper_transposed(S_, psi.data(), f_);                                                   // (1)
        scale_conjugated(f_, f_, h_);                                                                    // (2)
        return {e, prefix_sums(lambda_, h_, before_, s_)};
    }
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        auto const [e, s] = row;
        divide(before_, s_, k_);                                                                         // (3)
        square_roots(k_, k_);
        divide(k_, by_root_lambda_, k_);
        divide(f_, before_, m_);
        scale(m_, k_, m_);
        shrinkages(lambda_, h_, before_, s_, h_);
        root_shrinkages(k_, keep_, h_);
        sweep_carlson_delta(S_, f_, keep_, h_, m_, K_, perturb);                                         // (4)
        divide(K_, s, K_);                                                                               // (5)
        add_scaled(theta_, e, K_);
        return step_of(e, lambda_, s, theta_);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return outer(S_); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::factor, S_.view()}; }
    auto form() requires Field<T> {
        return RootCovariance<T, N, true>{lambda_, by_root_lambda_, theta_, K_, f_, before_, s_, k_, S_};
    }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_root_lambda_, f.theta_, f.K_, f.S_); }
};
static_assert(GainPerturbable<CarlsonDelta<double>>);

}  // namespace rlslab
