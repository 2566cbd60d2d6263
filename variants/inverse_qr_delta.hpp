// Inverse QR with S changed by its difference.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/start.hpp>
#include <rlslab/linalg/sweeps.hpp>

namespace rlslab {

/// Propagates the upper triangular square root S of the covariance, P = S S'; rotations make a zero against b:
///
///   (1) f = S'psi,   b_j^2 = b_{j-1}^2 + |f_j|^2,  b_0^2 = lambda
///   (2) [ b_0  0' ]  ->  [ b_d  g'              ]      one rotation for each j = 1 ... d, on (b, f_j) and
///       [ f    S' ]      [ 0    sqrt(lambda) S' ]      (g, column j of S):  c_j = b_{j-1} / b_j,  s_j = f_j / b_j
///   (3) k_j = c_j / sqrt(lambda),   m_j = s_j / sqrt(lambda)
///       h_j = 1 - k_j = (|f_j|^2 - b_{j-1}^2 (1 - lambda) / lambda) / (b_j^2 (1 + k_j))
///   (4) g = 0, and for j = 1 ... d, i <= j, t = the old S_ij:  S_ij = t - (t h_j + g_i m_j'),  g_i = c_j g_i + s_j t
///   (5) b_d^2 = s = lambda + psi'P psi,  K = g / b_d,  theta += K e
///
/// Where k_j < 1/2, S_ij = t k_j - g_i m_j', so that S_jj > 0 for any row. `inverse_qr` multiplies S by the rounded
/// cosines and divides it by the rounded root of lambda: errors of one sign, which add up over 1 / (1 - lambda) rows.
/// Here neither is applied to S where k_j >= 1/2 (docs/theory.md 39, 45, 91).
/// Storage d^2 (half used); per update 3 d^2 + O(d) multiplications, 2 d square roots.
/// Sources: Alexander & Ghirnikar 1993; Middleton & Goodwin 1986 (delta form); derived.
template <RootedScalar T, int N = Dynamic>
class InverseQrDelta {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_root_lambda_;
    StateVector<T, N> theta_, f_, s_, m_, g_, K_;
    StateVector<RealOf<T>, N> h_, before_, b_, c_, k_, keep_;
    StateMatrix<T, N> S_;

public:
    using scalar = T;
    static constexpr std::string_view name = "inverse_qr_delta";
    static constexpr Family family{Family::ud, 3};

    explicit InverseQrDelta(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_root_lambda_(square_root(lambda_)),
          theta_(start_theta<T, N>(problem)), f_(problem.size), s_(problem.size), m_(problem.size), g_(problem.size),
          K_(problem.size), h_(problem.size), before_(problem.size), b_(problem.size), c_(problem.size),
          k_(problem.size), keep_(problem.size), S_(start_root<T, N>(problem)) {}

    /// `perturb(g_1 ... g_j, c_j)` changes g after rotation j of (4). Its error reaches P in first order, P stays
    /// definite: docs/theory.md 33, 34.
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) { return commit(look(psi, y), perturb); }
    Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply_upper_transposed(S_, psi.data(), f_);                                                   // (1)
        scale_conjugated(f_, f_, h_);
        return {e, prefix_sums(lambda_, h_, before_, b_)};
    }
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        shrinkages(lambda_, h_, before_, b_, h_);                                                        // (3)
        square_roots(before_, before_);
        square_roots(b_, b_);
        divide(before_, b_, c_);                                                                         // (2)
        divide(f_, b_, s_);
        divide(c_, by_root_lambda_, k_);                                                                 // (3)
        divide(s_, by_root_lambda_, m_);
        root_shrinkages(k_, keep_, h_);
        sweep_rotations_delta(S_, c_, s_, keep_, h_, m_, g_, perturb);                                   // (4)
        divide(g_, b_[b_.size() - 1], K_);                                                               // (5)
        add_scaled(theta_, row.e, K_);
        return step_of(row.e, lambda_, row.s, theta_);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return outer(S_); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::factor, S_.view()}; }
    auto form() requires Field<T> {
        return RootCovariance<T, N, true>{lambda_, by_root_lambda_, theta_, K_, f_, before_, b_, g_, S_};
    }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_root_lambda_, f.theta_, f.K_, f.S_); }
};
static_assert(GainPerturbable<InverseQrDelta<double>>);

}  // namespace rlslab
