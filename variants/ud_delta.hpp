// Bierman's UD form with D changed by its difference.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/next_row.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates P = U D U', U unit upper triangular, as `ud` does, but for (3):
///
///   (1) f = U'psi, g = D f         (2) s_j = s_{j-1} + f_j'g_j, s_0 = lambda
///   (3) h_j = (f_j'g_j - s_{j-1} (1 - lambda) / lambda) / s_j,   D_j = D_j - D_j h_j
///   (4) mu_j = f_j / s_{j-1}, v = 0, and for j = 1 ... d, i <= j, t = the old U_ij:
///       U_ij = t - v_i mu_j',  v_i += t g_j
///   (5) K = v / s_d, theta += K e
///
/// 1 - h_j is s_{j-1} / (lambda s_j). Where h_j > 1/2, D_j is multiplied by that quotient instead, so that D_j > 0 for
/// any row. `ud` rounds the quotient, which is near 1 when lambda is: its error has a mean of order (1 - lambda)^2,
/// which adds up over 1 / (1 - lambda) rows; that of the difference is far smaller (docs/theory.md 91).
/// Storage d^2 (half used); per update 1.5 d^2 + O(d) multiplications.
/// Sources: Bierman 1977; Middleton & Goodwin 1986 (delta form); derived.
template <Scalar T, int N = Dynamic>
class UdDelta {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_lambda_;
    StateVector<T, N> theta_, f_, g_, mu_, K_;
    StateVector<RealOf<T>, N> D_, h_, before_, s_;
    StateMatrix<T, N> U_;
    [[no_unique_address]] NextRow<kernels::SweepUd<T>, N> next_;

public:
    using scalar = T;
    static constexpr std::string_view name = "ud_delta";
    static constexpr Family family{Family::ud, 2};

    explicit UdDelta(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_lambda_(lambda_), theta_(start_theta<T, N>(problem)),
          f_(problem.size), g_(problem.size), mu_(problem.size), K_(problem.size), D_(problem.size), h_(problem.size),
          before_(problem.size), s_(problem.size), U_(problem.size), next_(problem.size) {
        start_ud(problem, U_, D_);
    }

    /// `perturb(v_1 ... v_j, 1)` changes v after column j of (4). Its error reaches P in first order, P stays definite:
    /// docs/theory.md 33, 34.
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) { return commit(look(psi, y), perturb); }
    Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply_upper_transposed(U_, psi.data(), f_, next_);                                            // (1)
        scale(D_, f_, g_);
        scale_conjugated(f_, g_, h_);                                                                    // (2)
        return {e, prefix_sums(lambda_, h_, before_, s_)};
    }
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        auto const [e, s] = row;
        divide(f_, before_, mu_);
        shrinkages(lambda_, h_, before_, s_, h_);                                                        // (3)
        for (Index j = 0; j < h_.size(); ++j) {
            RealOf<T> const changed = D_[j] - D_[j] * h_[j], product = D_[j] * (before_[j] / s_[j]);
            D_[j] = select(RealOf<T>(1) / RealOf<T>(2) < h_[j], by_lambda_(product), changed);
        }
        sweep_ud(U_, g_, mu_, K_, perturb, next_);                                                       // (4)
        divide(K_, s, K_);                                                                               // (5)
        add_scaled(theta_, e, K_);
        return step_of(e, lambda_, s, theta_);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return outer(U_, D_); }
    Stored<T> stored() const {
        return {Stored<T>::Quantity::covariance, Stored<T>::Form::factor, U_.view(), D_.view()};
    }
    auto form() requires Field<T> {
        return UdCovariance<T, N>{lambda_, by_lambda_, theta_, K_, f_, g_, before_, s_, D_, U_};
    }
    friend Step<T> rows_at_once(UdDelta& f, RowsOf<T> psi, OutputsOf<T> y) {
        return update_rows(f, f.next_, psi, y);
    }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_lambda_, f.theta_, f.D_, f.K_, f.U_); }
};
static_assert(GainPerturbable<UdDelta<double>>);

}  // namespace rlslab
