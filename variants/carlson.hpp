// Carlson's triangular square-root form.
#pragma once

#include <rlslab/concept.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates the upper triangular square root S of the covariance, P = S S', column by column.
///
///   (1) f = S'psi                  s_0 = lambda, v = 0, and for j = 1 ... d, t = the old S_ij, i <= j:
///   (2) s_j = s_{j-1} + f_j^2      (3) S_ij = (t sqrt(s_{j-1}/s_j) - (v_i f_j / s_{j-1}) sqrt(s_{j-1}/s_j)) / sqrt(lambda)
///   (4) v_i += t f_j               then (5) K = v / s_d, theta += K e
///
/// Storage d^2 (half used); per update 2.5 d^2 + O(d) multiplications, d square roots.
/// Source: Carlson, AIAA J. 11(9), 1973.
template <Real T, int N = Dynamic>
class Carlson {
    T lambda_;
    DividedBy<T> by_root_lambda_;
    Column<T, N> theta_, v_, K_;
    Square<T, N> S_;

public:
    using scalar = T;
    static constexpr std::string_view name = "carlson";

    explicit Carlson(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_root_lambda_(square_root(lambda_)), theta_(start_theta<T, N>(problem)),
          v_(problem.size), K_(problem.size), S_(start_root<T, N>(problem)) {}

    Step<T> update(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        T s = lambda_;
        for (Index j = 0; j < v_.size(); ++j) {
            T const f = dot(S_.column(j), psi.data(), j + 1);                                            // (1)
            T const before = s;
            s += f * f;                                                                                  // (2)
            T const keep = square_root(before / s);
            T const mix = f / before * keep;    // not f / sqrt(before s): the product may overflow
            v_[j] = T(0);
            for (Index i = 0; i <= j; ++i) {
                T const t = S_(i, j);
                S_(i, j) = by_root_lambda_(t * keep - v_[i] * mix);                                      // (3)
                v_[i] += t * f;                                                                          // (4)
            }
        }
        divide(v_, s, K_);                                                                               // (5)
        add_scaled(theta_, e, K_);
        return report(e, lambda_, s);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return outer(S_); }
    Stored<T> stored() const { return {Stored<T>::Of::covariance, Stored<T>::Kind::factor, S_.view()}; }
};
static_assert(ReportsCovariance<Carlson<double>>);

}  // namespace rlslab
