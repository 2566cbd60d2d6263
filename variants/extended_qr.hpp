// Extended QR: R and its inverse transpose together, so that theta needs no back-substitution.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/rows_in_flight.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates the upper triangular R, R'R = P^-1, and W = R^-T, P = W'W, by the same rotations:
///
///   (1) [ sqrt(lambda) R   W / sqrt(lambda)   sqrt(lambda) z ]  ->  [ R   W   z   ]    z = R theta
///       [ psi'             0'                 y              ]      [ 0'  v'  eta ]
///   (2) sqrt(gamma) = c_1 ... c_d,   e = eta / sqrt(gamma),   K = -sqrt(gamma) v,   theta = theta - eta v
///
/// A rounding error in W neither grows nor decays, while one in R decays. theta and P are reported from W.
/// Storage 2 d^2 (half used); per update 5 d^2 + O(d) multiplications, d square roots. Needs a prior: W = R^-T.
/// Source: Yang & Böhme 1992.
template <RootedScalar T, int N = Dynamic>
class ExtendedQr {
    RealOf<T> root_lambda_;
    DivisorNearOne<RealOf<T>> by_root_lambda_;
    StateVector<T, N> theta_, z_, K_, x_, v_, s_;
    StateVector<RealOf<T>, N> c_;
    StateMatrix<T, N> L_, V_;    // R' and W', so that their rows are contiguous
    [[no_unique_address]] RowsInFlight<T, N> rows_;

    template <class Perturb>
    void turn_inverse(Perturb& perturb) {
        for (Index i = 0; i < s_.size(); ++i) s_[i] = -s_[i];    // W's row is the first of the pair, v the second
        sweep_rotations(V_, c_, s_, by_root_lambda_, v_, perturb);
    }

public:
    using scalar = T;
    static constexpr std::string_view name = "extended_qr";
    static constexpr Family family{Family::wide_qr, 1};

    explicit ExtendedQr(Problem<T> const& problem)
        : root_lambda_(square_root(checked(problem, N).forgetting)), by_root_lambda_(root_lambda_),
          theta_(start_theta<T, N>(problem)), z_(problem.size), K_(problem.size), x_(problem.size), v_(problem.size),
          s_(problem.size), c_(problem.size), L_(problem.size), V_(start_root<T, N>(problem)), rows_(problem.size) {
        start_information_root(problem, L_, z_);
    }

    /// `perturb(v_1 ... v_j, c_j)` changes v after rotation j of (1). Its error reaches P in first order, P stays
    /// definite: docs/theory.md 33, 34.
    template <PerturbsSweep<T> Perturb = NoPerturbation>
    Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) {
        keep_regressor(psi, x_);
        T eta = y;
        RealOf<T> root_gamma = RealOf<T>(1);
        rotate_in(L_, x_, root_lambda_, z_, eta, c_, s_);                                                // (1)
        Truth<T> finite = true;    // a pivot may be none that nothing was rotated into
        for (Index i = 0; i < x_.size(); ++i) {
            finite = finite && is_finite(L_(i, i));
            root_gamma *= c_[i];
        }
        turn_inverse(perturb);
        for (Index i = 0; i < x_.size(); ++i) K_[i] = -(root_gamma * v_[i]);                                     // (2)
        add_scaled(theta_, -eta, v_);
        return if_finite(finite && all_finite(theta_), report_rotated(eta, root_gamma, Truth<T>(true)));
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return outer(V_); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::factor, V_.view()}; }
    friend Step<T> rows_at_once(ExtendedQr& f, RowsOf<T> psi, OutputsOf<T> y) {
        auto const fold = [&](Index k) {
            NoPerturbation none;
            f.rows_.rotate_in(f.L_, f.root_lambda_, f.z_, psi, y, k);
            for (Index n = 0; n < f.rows_.together; ++n) {
                T const eta = f.rows_.rotation(n, f.c_, f.s_);
                f.turn_inverse(none);
                add_scaled(f.theta_, -eta, f.v_);
            }
        };
        return update_rows(f, f.rows_, f.x_.size(), psi, y, fold, f.theta_, f.K_);
    }
    static auto state(auto& f) { return std::tie(f.root_lambda_, f.by_root_lambda_, f.theta_, f.z_, f.K_, f.L_, f.V_); }
};
static_assert(GainPerturbable<ExtendedQr<double>>);

}  // namespace rlslab
