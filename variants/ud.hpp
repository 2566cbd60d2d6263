// Bierman's UD form: square-root accuracy without square roots.
#pragma once

#include <rlslab/concept.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates P = U D U', U unit upper triangular, column by column.
///
///   (1) f = U'psi, g = D f         s_0 = lambda, v = 0, and for j = 1 ... d, t = the old U_ij, i < j:
///   (2) s_j = s_{j-1} + f_j g_j    (3) D_j = D_j s_{j-1} / (s_j lambda)
///   (4) U_ij = t - v_i f_j / s_{j-1}, v_i += t g_j; v_j = g_j       then (5) K = v / s_d, theta += K e
///
/// Storage d^2 (half used); per update 1.5 d^2 + O(d) multiplications. P is definite exactly while every D_j > 0.
/// Source: Bierman, Factorization Methods for Discrete Sequential Estimation, 1977; Thornton 1976.
template <Field T, int N = Dynamic>
class Ud {
    T lambda_;
    Column<T, N> theta_, D_, v_, K_;
    Square<T, N> U_;

public:
    using scalar = T;
    static constexpr std::string_view name = "ud";

    explicit Ud(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), theta_(start_theta<T, N>(problem)), D_(problem.size),
          v_(problem.size), K_(problem.size), U_(problem.size) {
        start_ud(problem, U_, D_);
    }

    Step<T> update(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        T s = lambda_;
        for (Index j = 0; j < v_.size(); ++j) {
            T f = psi[j];
            if (j > 0) f += dot(U_.column(j), psi.data(), j);                                            // (1)
            T const g = D_[j] * f;
            T const before = s;
            s += f * g;                                                                                  // (2)
            D_[j] = D_[j] * (before / s) / lambda_;                                                      // (3)
            T const mu = f / before;
            for (Index i = 0; i < j; ++i) {
                T const t = U_(i, j);
                U_(i, j) = t - v_[i] * mu;                                                               // (4)
                v_[i] += t * g;
            }
            v_[j] = g;
        }
        divide(v_, s, K_);                                                                               // (5)
        add_scaled(theta_, e, K_);
        return report(e, lambda_, s);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return outer(U_, D_); }
    Stored<T> stored() const { return {Stored<T>::Of::covariance, Stored<T>::Kind::factor, U_.view(), D_.view()}; }
};
static_assert(ReportsCovariance<Ud<double>>);

}  // namespace rlslab
