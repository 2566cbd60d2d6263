// QR-RLS (square-root information filter): the triangular factor of P^-1 by Givens rotations.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/rows_in_flight.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates the upper triangular R of the information matrix, R'R = P^-1, and z = R theta:
///
///   (1) [ sqrt(lambda) R   sqrt(lambda) z ]  ->  [ R   z   ]     one rotation (c_i, s_i) for each row i
///       [ psi'             y              ]      [ 0'  eta ]
///   (2) sqrt(gamma) = c_1 ... c_d,   residual = eta sqrt(gamma),   e = eta / sqrt(gamma)
///
/// theta (R theta = z) and K (R'R K = psi) are solved for on request, d^2/2 and d^2 multiplications.
/// Storage d^2 (half used); per update 2.5 d^2 + O(d) multiplications, d square roots. Starts without a prior: while R
/// has a zero on its diagonal the innovation is NaN and health undetermined.
/// Sources: Golub 1965; Bierman 1977 (SRIF); Haykin (QR-RLS).
template <RootedScalar T, int N = Dynamic>
class Qr {
    RealOf<T> lambda_, root_lambda_;
    StateVector<T, N> z_, psi_, x_, s_;
    StateVector<RealOf<T>, N> c_;
    StateMatrix<T, N> L_;    // R'
    ColumnLengths<T, N> lengths_;
    [[no_unique_address]] RowsInFlight<T, N> rows_;

public:
    using scalar = T;
    static constexpr std::string_view name = "qr";
    static constexpr Family family{Family::qr};
    static constexpr bool starts_without_prior = true;

    explicit Qr(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), root_lambda_(square_root(lambda_)), z_(problem.size),
          psi_(problem.size),
          x_(problem.size), s_(problem.size), c_(problem.size), L_(problem.size), lengths_(problem.size),
          rows_(problem.size) {
        start_information_root(problem, L_, z_);
        lengths_.start(L_, z_);
    }

    Step<T> update(Regressor<T> psi, T y) {
        keep_regressor(psi, psi_, x_);
        T eta = y;
        RealOf<T> root_gamma = RealOf<T>(1);
        Truth<T> const determined = lengths_.determined();
        rotate_in(L_, x_, root_lambda_, z_, eta, c_, s_);                                                // (1)
        for (Index i = 0; i < x_.size(); ++i) root_gamma *= c_[i];
        Step<T> const step = report_rotated(eta, root_gamma, determined);                                // (2)
        return if_finite(lengths_.add_row(lambda_, psi_, y, L_, z_, x_) || !determined, step);
    }

    Vector<T, N> theta() const { return solved_lower_transposed(L_, z_); }
    Vector<T, N> gain() const { return solved_outer(L_, psi_); }
    void theta(StateVector<T, N>& out) const { out = z_; solve_lower_transposed(L_, out); }    // without the heap
    void gain(StateVector<T, N>& out) const { out = psi_; solve_outer(L_, out); }
    Matrix<T, N> information() const { return outer(L_); }
    Stored<T> stored() const { return {Stored<T>::Quantity::information, Stored<T>::Form::factor, L_.view()}; }
    auto form() requires Field<T> { return RootInformation<T, N>{lambda_, root_lambda_, z_, x_, c_, s_, L_, lengths_}; }
    friend Step<T> rows_at_once(Qr& f, RowsOf<T> psi, OutputsOf<T> y) {
        return update_rows(f, f.rows_, f.x_.size(), psi, y, [&](Index k) {
            f.rows_.rotate_in(f.L_, f.root_lambda_, f.z_, psi, y, k, false);                             // (1)
            for (Index n = k; n < k + f.rows_.together; ++n) f.lengths_.add(f.lambda_, psi.col(n).data(), y[n], f.L_);
        });
    }
    static auto state(auto& f) { return std::tie(f.lambda_, f.root_lambda_, f.z_, f.psi_, f.L_, f.lengths_); }
};
static_assert(ReportsInformation<Qr<double>> && StartsWithoutPrior<Qr<double>>);

}  // namespace rlslab
