// Gentleman's square-root-free rotations.
#pragma once

#include <rlslab/concept.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates P^-1 = R'D R, R unit upper triangular, and z = R theta. The new row carries a weight w, 1 at first:
///
///   (1) for i = 1 ... d:  D = lambda D_i + w x_i^2,  c = lambda D_i / D,  s = w x_i / D,  D_i = D,  w = c w,
///       and for each later column, t = the old R_ij:  R_ij = c t + s x_j,  x_j -= x_i t;   z_i and eta alike
///   (2) gamma = w,   e = eta
///
/// theta (R theta = z) and K are solved for when asked. Storage d^2 (half used); per update 1.5 d^2 + O(d)
/// multiplications, no square root. Starts without a prior: while D has a zero the innovation is NaN and health
/// undetermined. Sources: Gentleman, AS 75, 1974; Miller, AS 274, 1992.
template <Field T, int N = Dynamic>
class Gentleman {
    T lambda_;
    Column<T, N> D_, z_, psi_, x_;
    Square<T, N> L_;    // R'

public:
    using scalar = T;
    static constexpr std::string_view name = "gentleman";
    static constexpr bool starts_without_prior = true;

    explicit Gentleman(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), D_(problem.size), z_(problem.size), psi_(problem.size),
          x_(problem.size), L_(problem.size) {
        start_information(problem, L_, D_);
        multiply_lower_transposed(L_, start_theta<T, N>(problem), z_);
    }

    Step<T> update(Regressor<T> psi, T y) {
        keep_regressor(psi, psi_);
        x_ = psi_;
        Index const d = x_.size();
        T eta = y, w = T(1);
        bool determined = true;
        for (Index i = 0; i < d; ++i) {                                                                  // (1)
            T const before = lambda_ * D_[i];
            T const x = x_[i];
            determined = determined && before != T(0);
            D_[i] = before + w * x * x;
            if (x == T(0) || D_[i] == T(0)) continue;
            T const c = before / D_[i], s = w * x / D_[i];
            w *= c;
            for (Index j = i + 1; j < d; ++j) {
                T const t = L_(j, i);
                L_(j, i) = c * t + s * x_[j];
                x_[j] -= x * t;
            }
            T const t = z_[i];
            z_[i] = c * t + s * eta;
            eta -= x * t;
        }
        return determined ? report(eta, w) : report_undetermined(eta);                                   // (2)
    }

    Vector<T, N> theta() const {
        Vector<T, N> theta = z_.view();
        solve_lower_transposed(L_, theta);
        for (Index i = 0; i < theta.size(); ++i)
            if (D_[i] == T(0)) theta[i] = undefined<T>();
        return theta;
    }
    Vector<T, N> gain() const {
        Vector<T, N> K = psi_.view();
        solve_lower(L_, K);
        for (Index i = 0; i < K.size(); ++i) K[i] /= D_[i];
        solve_lower_transposed(L_, K);
        return K;
    }
    Matrix<T, N> information() const { return outer(L_, D_); }
    Stored<T> stored() const { return {Stored<T>::Of::information, Stored<T>::Kind::factor, L_.view(), D_.view()}; }
};
static_assert(ReportsInformation<Gentleman<double>> && StartsWithoutPrior<Gentleman<double>>);

}  // namespace rlslab
