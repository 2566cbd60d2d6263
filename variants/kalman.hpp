// The Kalman filter of parameters that are constant or follow a random walk: recursive least squares as state
// estimation.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// State theta_{k+1} = theta_k + w_k, measurement y_k = psi'theta_k + xi_k, var xi = sigma^2, cov w = sigma^2 Q;
/// forgetting inflates the covariance instead. Propagates P, in units of sigma^2, in full storage:
///
///   (1) P = P / lambda + Q         (2) f = P psi                    (3) s = 1 + psi'f
///   (4) K = f / s                  (5) P = P - K f'                 (6) theta += K e
///
/// Without a walk (Q = 0, as in the catalogue) K, P and theta are those of `conventional`: bit for bit where lambda =
/// 1, and exactly in exact arithmetic where less. A walk replaces forgetting: lambda = 1, Q > 0.
/// Storage 2 d^2; per update 4 d^2 + O(d) multiplications. Antisymmetric errors grow as in `conventional`.
/// Sources: Kalman 1960; Sayed & Kailath 1994.
template <Scalar T, int N = Dynamic>
class Kalman {
    DivisorNearOne<RealOf<T>> by_lambda_;
    StateVector<T, N> theta_, f_, K_;
    StateMatrix<T, N> P_, Q_;
    bool walks_;

public:
    using scalar = T;
    static constexpr std::string_view name = "kalman";
    static constexpr Family family{Family::symmetric, 1};

    explicit Kalman(Problem<T> const& problem)
        : by_lambda_(checked(problem, N).forgetting), theta_(start_theta<T, N>(problem)), f_(problem.size),
          K_(problem.size), P_(start_covariance<T, N>(problem)), Q_(problem.size), walks_(false) {}

    /// With a walk, Q d x d. Throws std::invalid_argument for a Q of another size or one that is not symmetric. Whether
    /// Q is positive semidefinite is not checked.
    Kalman(Problem<T> const& problem, Matrix<T> const& Q) : Kalman(problem) {
        expects(Q.rows() == f_.size() && Q.cols() == f_.size() && Q == Q.adjoint(), "a symmetric Q of size x size");
        for (Index j = 0; j < f_.size(); ++j)
            for (Index i = 0; i < f_.size(); ++i) Q_(i, j) = Q(i, j);
        walks_ = true;
    }

    /// `perturb(K)` changes K between (4) and (5). Its error reaches P in first order: docs/theory.md 16.
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) {
        T const e = innovation(y, psi, theta_);
        for (Index j = 0; j < f_.size(); ++j)                                                            // (1)
            for (Index i = 0; i < f_.size(); ++i) {
                P_(i, j) = by_lambda_(P_(i, j));
                if (walks_) P_(i, j) += Q_(i, j);    // + 0 would change the sign of -0
            }
        multiply(P_, psi.data(), f_);                                                                    // (2)
        RealOf<T> const s = RealOf<T>(1) + real_part(dot(psi, f_));                                      // (3)
        divide(f_, s, K_);                                                                               // (4)
        perturb(K_);
        subtract_rank_one(P_, K_, f_, DivisorNearOne<RealOf<T>>(RealOf<T>(1)));                               // (5)
        add_scaled(theta_, e, K_);                                                                       // (6)
        return step_of(e, RealOf<T>(1), s, theta_);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return P_.view(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::plain, P_.view()}; }
    static auto state(auto& f) { return std::tie(f.by_lambda_, f.theta_, f.K_, f.P_, f.Q_, f.walks_); }
};
static_assert(GainPerturbable<Kalman<double>>);

}  // namespace rlslab
