// Conventional RLS with P replaced by (P + P')/2 after every update.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates P in full storage.
///
///   (1) f = P psi                  (2) s = lambda + psi'f           (3) K = f / s
///   (4) Q = (P - K f') / lambda    (5) P = (Q + Q') / 2             (6) theta += K e
///
/// Storage d^2; per update 3 d^2 + O(d) multiplications, d^2/2 divisions. Source: folklore.
template <Scalar T, int N = Dynamic>
class Averaged {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_lambda_;
    StateVector<T, N> theta_, f_, K_;
    StateMatrix<T, N> P_;

public:
    using scalar = T;
    static constexpr std::string_view name = "averaged";
    static constexpr Family family{Family::conventional, 2};  // its colour in figures; its mark: the next free place

    explicit Averaged(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_lambda_(lambda_), theta_(start_theta<T, N>(problem)),
          f_(problem.size), K_(problem.size), P_(start_covariance<T, N>(problem)) {}

    Step<T> update(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply(P_, psi.data(), f_);                           // (1)
        RealOf<T> const s = lambda_ + real_part(dot(psi, f_));  // (2)
        divide(f_, s, K_);                                      // (3)
        for (Index j = 0; j < f_.size(); ++j)
            for (Index i = 0; i < f_.size(); ++i) P_(i, j) = by_lambda_(P_(i, j) - K_[i] * conjugate(f_[j]));  // (4)
        for (Index j = 0; j < f_.size(); ++j)
            for (Index i = 0; i <= j; ++i) {
                P_(i, j) = (P_(i, j) + conjugate(P_(j, i))) / RealOf<T>(2);  // (5)
                P_(j, i) = conjugate(P_(i, j));
            }
        add_scaled(theta_, e, K_);  // (6)
        return step_of(e, lambda_, s, theta_);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return P_.view(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::plain, P_.view()}; }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_lambda_, f.theta_, f.K_, f.P_); }
};
static_assert(ReportsCovariance<Averaged<double>>);

}  // namespace rlslab
