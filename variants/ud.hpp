// Bierman's UD form: square-root accuracy without square roots.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/next_row.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates P = U D U', U unit upper triangular. All divisions that the sweep over U's columns needs come before it:
///
///   (1) f = U'psi, g = D f         (2) s_j = s_{j-1} + f_j'g_j, s_0 = lambda
///   (3) D_j = D_j (s_{j-1} / s_j) / lambda
///   (4) mu_j = f_j / s_{j-1}, v = 0, and for j = 1 ... d, i <= j, t = the old U_ij:
///       U_ij = t - v_i mu_j',  v_i += t g_j
///   (5) K = v / s_d, theta += K e
///
/// U_jj stays 1 in (4): v_j is 0 until it becomes g_j there. P is definite exactly while every D_j > 0.
/// Storage d^2 (half used); per update 1.5 d^2 + O(d) multiplications.
/// Source: Bierman 1977; Thornton 1976.
template <Scalar T, int N = Dynamic>
class Ud {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_lambda_;
    StateVector<T, N> theta_, f_, g_, mu_, K_;
    StateVector<RealOf<T>, N> D_, before_, s_;
    StateMatrix<T, N> U_;
    [[no_unique_address]] NextRow<kernels::SweepUd<T>, N> next_;

public:
    using scalar = T;
    static constexpr std::string_view name = "ud";
    static constexpr Family family{Family::ud};

    explicit Ud(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_lambda_(lambda_), theta_(start_theta<T, N>(problem)),
          f_(problem.size), g_(problem.size), mu_(problem.size), K_(problem.size), D_(problem.size),
          before_(problem.size),
          s_(problem.size), U_(problem.size), next_(problem.size) {
        start_ud(problem, U_, D_);
    }

    /// `perturb(v_1 ... v_j, 1)` changes v after column j of (4). Its error reaches P in first order, P stays definite:
    /// docs/theory.md 33, 34.
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    [[gnu::always_inline]] Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) {
        return commit(look(psi, y), perturb);
    }
    [[gnu::always_inline]] Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply_upper_transposed(U_, psi.data(), f_, next_);                                            // (1)
        scale(D_, f_, g_);
        return {e, prefix_sums(lambda_, f_, g_, before_, s_)};                                           // (2)
    }
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    [[gnu::always_inline]] Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        auto const [e, s] = row;
        divide(f_, before_, mu_);
        divide(before_, s_, before_);                                                                    // (3)
        scale(D_, before_, D_);
        divide(D_, by_lambda_, D_);
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
    friend Step<T> rows_at_once(Ud& f, RowsOf<T> psi, OutputsOf<T> y) { return update_rows(f, f.next_, psi, y); }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_lambda_, f.theta_, f.D_, f.K_, f.U_); }
};
static_assert(GainPerturbable<Ud<double>>);

}  // namespace rlslab
