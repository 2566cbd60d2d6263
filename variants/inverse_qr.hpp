// Inverse QR: the square root of P by rotations, in array form.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/next_row.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates the upper triangular square root S of the covariance, P = S S'; rotations make a zero against b:
///
///   (1) a = S'psi / sqrt(lambda)
///   (2) [ 1  0'                ]  ->  [ b  g'  ]       one rotation for each j = 1 ... d, on (b, a_j) and
///       [ a  S' / sqrt(lambda) ]      [ 0  S'  ]       (g, column j of S):  b_j = |(b_{j-1}, a_j)|,
///                                                      c_j = b_{j-1} / b_j,  s_j = a_j / b_j
///   (3) b^2 = s / lambda,  s = lambda + psi'P psi,  K = g / b,  theta += K e
///
/// Storage d^2 (half used); per update 3 d^2 + O(d) multiplications, 2 d square roots.
/// Source: Alexander & Ghirnikar 1993.
template <RootedScalar T, int N = Dynamic>
class InverseQr {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_root_lambda_;
    StateVector<T, N> theta_, a_, s_, g_, K_;
    StateVector<RealOf<T>, N> before_, b_, c_;
    StateMatrix<T, N> S_;
    [[no_unique_address]] NextRow<kernels::SweepRotations<T>, N> next_;

public:
    using scalar = T;
    static constexpr std::string_view name = "inverse_qr";
    static constexpr Family family{Family::ud, 1};

    explicit InverseQr(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_root_lambda_(square_root(lambda_)),
          theta_(start_theta<T, N>(problem)), a_(problem.size), s_(problem.size), g_(problem.size), K_(problem.size),
          before_(problem.size), b_(problem.size),
          c_(problem.size), S_(start_root<T, N>(problem)), next_(problem.size) {}

    /// `perturb(g_1 ... g_j, c_j)` changes g after rotation j of (2). Its error reaches P in first order, P stays
    /// definite: docs/theory.md 33, 34.
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) { return commit(look(psi, y), perturb); }
    Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply_upper_transposed(S_, psi.data(), a_, next_);                                            // (1)
        divide(a_, by_root_lambda_, a_);
        RealOf<T> const b = prefix_norms(a_, before_, b_);                                               // (2)
        UncountedScope<T> const aside;    // the update does not need s, and draws nothing for it
        RealOf<T> const root_s = b / (RealOf<T>(1) + by_root_lambda_.correction());
        return {e, root_s * root_s};
    }
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        RealOf<T> const b = b_[b_.size() - 1];
        divide(before_, b_, c_);
        divide(a_, b_, s_);
        sweep_rotations(S_, c_, s_, by_root_lambda_, g_, perturb, next_);
        divide(g_, b, K_);                                                                               // (3)
        add_scaled(theta_, row.e, K_);
        return if_finite(all_finite(theta_) && is_finite(b), step_of(row.e, RealOf<T>(RealOf<T>(1) / (b * b))));
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return outer(S_); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::factor, S_.view()}; }
    auto form() requires Field<T> {
        return RootCovariance<T, N, true>{lambda_, by_root_lambda_, theta_, K_, a_, before_, b_, g_, S_};
    }
    friend Step<T> rows_at_once(InverseQr& f, RowsOf<T> psi, OutputsOf<T> y) { return update_rows(f, f.next_, psi, y); }
    static auto state(auto& f) { return std::tie(f.by_root_lambda_, f.theta_, f.K_, f.S_); }
};
static_assert(GainPerturbable<InverseQr<double>>);

}  // namespace rlslab
