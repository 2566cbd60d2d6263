// Conventional RLS with one triangle of P computed and mirrored: symmetric by construction.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/kernels.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates P; each number below the diagonal is the one above it (its conjugate), bit for bit. In float and double
/// the blocks of 8 x 8 (4 x 4 at fixed sizes up to 4) on and above the diagonal are stored (SymmetricMatrix), else P.
///
///   (1) f = P psi                           (2) s = lambda + psi'f           (3) K = f / s
///   (4) P_ij = P_ji' = (P_ij - K_i f_j') / lambda for i <= j                 (5) theta += K e
///
/// Storage d^2/2 + O(d) in float and double, else d^2; per update 2 d^2 + O(d) multiplications. Source: Haykin,
/// Adaptive Filter Theory (the Tri rule).
template <Scalar T, int N = Dynamic>
class Symmetric {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_lambda_;
    StateVector<T, N> theta_, f_, K_;
    SymmetricStorage<T, N> P_;

public:
    using scalar = T;
    static constexpr std::string_view name = "symmetric";
    static constexpr Family family{Family::symmetric};
    static constexpr bool mirrored = true;    // a guard need not look at P_ij - P_ji

    explicit Symmetric(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_lambda_(lambda_), theta_(start_theta<T, N>(problem)),
          f_(problem.size), K_(problem.size), P_(start_symmetric<T, N>(problem)) {}

    /// `perturb(K)` changes K between (3) and (4). Its error reaches P in first order: docs/theory.md 16.
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    [[gnu::always_inline]] Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) {
        return commit(look(psi, y), perturb);
    }
    [[gnu::always_inline]] Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply(P_, psi.data(), f_);                                                                    // (1)
        return {e, lambda_ + real_part(dot(psi, f_))};                                                   // (2)
    }
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    [[gnu::always_inline]] Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        auto const [e, s] = row;
        divide(f_, s, K_);                                                                               // (3)
        perturb(K_);
        subtract_rank_one_mirrored(P_, K_, f_, by_lambda_);                                              // (4)
        add_scaled(theta_, e, K_);                                                                       // (5)
        return step_of(e, lambda_, s, theta_);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return P_.view(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::plain, P_.view()}; }
    auto form() requires Field<T> {
        return PlainCovariance<T, N, SymmetricStorage<T, N>>{lambda_, by_lambda_, theta_, K_, f_, P_};
    }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_lambda_, f.theta_, f.K_, f.P_); }
};
static_assert(GainPerturbable<Symmetric<double>>);

}  // namespace rlslab
