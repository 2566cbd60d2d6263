// Joseph's stabilised form, evaluated as the matrix products of its formula.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates P in full storage as a sum of two semidefinite terms; an error in K alone enters P in second order, and
/// as a bias.
///
///   (1) f = P psi                  (2) s = lambda + psi'f           (3) K = f / s
///   (4) A = I - K psi'             (5) P = (A P) A' / lambda + K K'                  (6) theta += K e
///
/// Storage 3 d^2; per update 2 d^3 + O(d^2) multiplications. Source: Bucy & Joseph 1968. Nothing is symmetrised.
template <Scalar T, int N = Dynamic>
class Joseph {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_lambda_;
    StateVector<T, N> theta_, psi_, f_, K_;
    StateMatrix<T, N> P_, A_, AP_;

public:
    using scalar = T;
    static constexpr std::string_view name = "joseph";
    static constexpr Family family{Family::joseph};

    explicit Joseph(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_lambda_(lambda_), theta_(start_theta<T, N>(problem)),
          psi_(problem.size), f_(problem.size), K_(problem.size), P_(start_covariance<T, N>(problem)), A_(problem.size),
          AP_(problem.size) {}

    /// `perturb(K)` changes K between (3) and (4). Its error reaches P in second order: docs/theory.md 17.
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) { return commit(look(psi, y), perturb); }
    Innovation<T> look(Regressor<T> psi, T y) {
        keep_regressor(psi, psi_);    // which may be K's own numbers
        T const e = innovation(y, psi, theta_);
        multiply(P_, psi.data(), f_);                                                                    // (1)
        return {e, lambda_ + real_part(dot(psi, f_))};                                                   // (2)
    }
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        auto const [e, s] = row;
        divide(f_, s, K_);                                                                               // (3)
        perturb(K_);
        Index const d = f_.size();
        for (Index j = 0; j < d; ++j) {
            for (Index i = 0; i < d; ++i) A_(i, j) = -(K_[i] * conjugate(psi_[j]));                       // (4)
            A_(j, j) += T(1);
        }
        multiply(A_, P_, AP_);                                                                           // (5)
        multiply_by_transposed(AP_, A_, P_);
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i) {
                T const square = K_[i] * conjugate(K_[j]);
                P_(i, j) = by_lambda_(P_(i, j)) + square;
            }
        add_scaled(theta_, e, K_);                                                                       // (6)
        return step_of(e, lambda_, s, theta_);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return P_.view(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::plain, P_.view()}; }
    auto form() requires Field<T> { return PlainCovariance<T, N>{lambda_, by_lambda_, theta_, K_, f_, P_}; }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_lambda_, f.theta_, f.K_, f.P_); }
};
static_assert(GainPerturbable<Joseph<double>>);

}  // namespace rlslab
