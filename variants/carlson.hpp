// Carlson's triangular square-root form.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/next_row.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates the upper triangular square root S of the covariance, P = S S':
///
///   (1) f = S'psi        (2) s_j = s_{j-1} + |f_j|^2, s_0 = lambda
///   (3) r_j = sqrt(s_{j-1}/s_j), m_j = (f_j / s_{j-1}) r_j
///   (4) v = 0, and for j = 1 ... d, i <= j, t = the old S_ij:  S_ij = (t r_j - v_i m_j') / sqrt(lambda),  v_i += t f_j
///   (5) K = v / s_d, theta += K e
///
/// Not f_j / sqrt(s_{j-1} s_j): the product may overflow.
/// Storage d^2 (half used); per update 2.5 d^2 + O(d) multiplications, d square roots.
/// Source: Carlson 1973.
template <RootedScalar T, int N = Dynamic>
class Carlson {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_root_lambda_;
    StateVector<T, N> theta_, f_, m_, K_;
    StateVector<RealOf<T>, N> before_, s_, r_;
    StateMatrix<T, N> S_;
    [[no_unique_address]] NextRow<kernels::SweepCarlson<T>, N> next_;

public:
    using scalar = T;
    static constexpr std::string_view name = "carlson";
    static constexpr Family family{Family::root, 1};

    explicit Carlson(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_root_lambda_(square_root(lambda_)),
          theta_(start_theta<T, N>(problem)), f_(problem.size), m_(problem.size), K_(problem.size),
          before_(problem.size), s_(problem.size), r_(problem.size),
          S_(start_root<T, N>(problem)), next_(problem.size) {}

    /// `perturb(v_1 ... v_j, 1)` changes v after column j of (4). Its error reaches P in first order, P stays definite:
    /// docs/theory.md 33, 34.
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    [[gnu::always_inline]] Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) {
        return commit(look(psi, y), perturb);
    }
    [[gnu::always_inline]] Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply_upper_transposed(S_, psi.data(), f_, next_);                                            // (1)
        return {e, prefix_sums(lambda_, f_, f_, before_, s_)};                                           // (2)
    }
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    [[gnu::always_inline]] Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        auto const [e, s] = row;
        divide(before_, s_, r_);                                                                         // (3)
        square_roots(r_, r_);
        divide(f_, before_, m_);
        scale(m_, r_, m_);
        sweep_carlson(S_, f_, r_, m_, by_root_lambda_, K_, perturb, next_);                              // (4)
        divide(K_, s, K_);                                                                               // (5)
        add_scaled(theta_, e, K_);
        return step_of(e, lambda_, s, theta_);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return outer(S_); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::factor, S_.view()}; }
    auto form() requires Field<T> {
        return RootCovariance<T, N, true>{lambda_, by_root_lambda_, theta_, K_, f_, before_, s_, r_, S_};
    }
    friend Step<T> rows_at_once(Carlson& f, RowsOf<T> psi, OutputsOf<T> y) { return update_rows(f, f.next_, psi, y); }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_root_lambda_, f.theta_, f.K_, f.S_); }
};
static_assert(GainPerturbable<Carlson<double>>);

}  // namespace rlslab
