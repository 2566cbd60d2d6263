// Gentleman's square-root-free rotations.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/start.hpp>
#include <rlslab/linalg/sweeps.hpp>

namespace rlslab {

/// Propagates P^-1 = R'D R, R unit upper triangular, and z = R theta. The new row is eliminated before any division;
/// its weight is w, 1 at first:
///
///   (1) x = psi, and for i = 1 ... d, j > i:  x_j' -= x_i' R_ij       (2) 1/w_{i+1} = 1/w_i + |x_i|^2 / (lambda D_i)
///   (3) q = lambda D_i + w_i |x_i|^2,  c_i = lambda D_i / q,  s_i = w_i x_i / q,  D_i = q
///   (4) x = psi, and for i = 1 ... d, j > i, t = the old R_ij:  R_ij = c_i t + s_i x_j',  x_j' -= x_i' t;
///       z_i and eta alike              (5) gamma = w_{d+1},  e = eta
///
/// Where 1/w is not finite (a zero D_i, an overflow) (2) is w_{i+1} = w_i c_i. theta (R theta = z) and K are solved for
/// on request. Storage d^2 (half used); per update 2 d^2 + O(d) multiplications (1.5 d^2 where float and double take
/// one pass), no square root. Starts without a prior: the innovation is NaN and health undetermined until each pivot
/// stands above its own rounding (linalg/triangles.hpp). Sources: Gentleman 1974 (AS 75); Miller 1992 (AS 274).
template <Scalar T, int N = Dynamic>
class Gentleman {
    RealOf<T> lambda_;
    StateVector<T, N> z_, psi_, x_, rest_, s_;
    StateVector<RealOf<T>, N> D_, before_, c_;
    StateMatrix<T, N> L_;    // R'
    ColumnLengths<T, N> lengths_;

public:
    using scalar = T;
    static constexpr std::string_view name = "gentleman";
    static constexpr Family family{Family::qr, 1};
    static constexpr bool starts_without_prior = true;

    explicit Gentleman(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), z_(problem.size), psi_(problem.size), x_(problem.size),
          rest_(problem.size), s_(problem.size), D_(problem.size), before_(problem.size), c_(problem.size),
          L_(problem.size), lengths_(problem.size) {
        start_information(problem, L_, D_);
        multiply_lower_transposed(L_, start_theta<T, N>(problem), z_);
        lengths_.start(L_, D_, z_);
    }

    Step<T> update(Regressor<T> psi, T y) {
        keep_regressor(psi, psi_, x_, rest_);
        T eta = y;
        Truth<T> const determined = lengths_.determined(L_, D_);
        bool const in_range = lengths_.begin_row(lambda_, psi_, y, D_);
        if constexpr (Hardware<T>)
            if (in_range)    // the same bits
                return if_determined(determined, step_of(eta, fold_gentleman(L_, x_, z_, eta, D_, c_, s_, lambda_)));
        eliminate(L_, x_);                                                                               // (1)
        scale(D_, lambda_, before_);
        Truth<T> const regular = nonsingular(before_);
        RealOf<T> const w = gentleman_weights(x_, before_, s_, c_, D_);                                  // (2)
        add_product(before_, s_, x_, D_);                                                                // (3)
        divide(before_, D_, c_);
        divide(s_, D_, s_);
        if (!all(regular))
            for (Index i = 0; i < x_.size(); ++i) {    // D_i is zero before and after this row
                c_[i] = select(D_[i] == RealOf<T>(0), RealOf<T>(1), c_[i]);
                s_[i] = select(D_[i] == RealOf<T>(0), T(0), s_[i]);
            }
        sweep_gentleman(L_, c_, s_, x_, rest_);                                                          // (4)
        for (Index i = 0; i < x_.size(); ++i) {
            T const t = z_[i], turned = s_[i] * eta;
            z_[i] = c_[i] * t + turned;
            eta -= conjugate(x_[i]) * t;
        }
        Step<T> const step = if_determined(determined && regular, step_of(eta, w));                      // (5)
        return if_finite(lengths_.end_row(psi_, L_, D_, z_, rest_) || !(determined && regular), step);
    }

    Vector<T, N> theta() const {
        Vector<T, N> theta = z_.view();
        solve(theta);
        return theta;
    }
    Vector<T, N> gain() const { return solved_outer(L_, D_, psi_); }
    void theta(StateVector<T, N>& out) const { out = z_; solve(out); }    // without the heap
    void gain(StateVector<T, N>& out) const { out = psi_; solve_outer(L_, D_, out); }
    Matrix<T, N> information() const { return outer(L_, D_); }
    Stored<T> stored() const {
        return {Stored<T>::Quantity::information, Stored<T>::Form::factor, L_.view(), D_.view()};
    }
    auto form() requires Field<T> {
        return UnitInformation<T, N>{lambda_, z_, x_, c_, s_, rest_, before_, D_, L_, lengths_};
    }
    static auto state(auto& f) { return std::tie(f.lambda_, f.D_, f.z_, f.psi_, f.L_, f.lengths_); }

private:
    void solve(auto& z) const {
        solve_lower_transposed(L_, z);
        for (Index i = 0; i < z.size(); ++i) z[i] = select(D_[i] == RealOf<T>(0), undefined<T>(), z[i]);
    }
};
static_assert(ReportsInformation<Gentleman<double>> && StartsWithoutPrior<Gentleman<double>>);

}  // namespace rlslab
