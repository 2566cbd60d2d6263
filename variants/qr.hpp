// QR-RLS (square-root information filter): the triangular factor of P^-1 by Givens rotations.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/start.hpp>
#include <rlslab/linalg/sweeps.hpp>

namespace rlslab {

/// Propagates the upper triangular R of the information matrix, R'R = P^-1, and z = R theta:
///
///   (1) [ sqrt(lambda) R   sqrt(lambda) z ]  ->  [ R   z   ]     one rotation for each row i, from (2) to (4)
///       [ psi'             y              ]      [ 0'  eta ]
///   (2) R'u = psi,  e = y - u'z;   x = psi, and for i = 1 ... d, j > i:  u_i = x_i / R_ii,  x_j' -= u_i' R_ij
///   (3) s_0 = lambda,  s_i = s_{i-1} + |u_i|^2,   gamma = lambda / s_d
///       c_i = sqrt(lambda s_{i-1} / s_i),   g_i = u_i sqrt(lambda / (s_{i-1} s_i))
///   (4) R_ij = c_i t + g_i x_j' for j >= i, t the old R_ij, x_j as u_i meets it in (2);  (z_i, y) alike
///
/// look() is (2) and (3), which change nothing, commit() is (4). Where R has a zero on its diagonal, where s_d
/// overflows, and in fixed point each rotation is computed from R_ii and what the one before it left of psi, and
///
///   (5) sqrt(gamma) = c_1 ... c_d,   residual = eta sqrt(gamma),   e = eta / sqrt(gamma)
///
/// theta (R theta = z) and K (R'R K = psi) are solved for on request, d^2/2 and d^2 multiplications. Rounding of c_i
/// makes P drift with lambda = 1, as that of inverse_qr (docs/theory.md 45); theta does not. Storage d^2 (half used);
/// per update 2 d^2 + O(d) multiplications (1.5 d^2 where float and double take one pass, 2.5 d^2 in (5)), d square
/// roots. Starts without a prior: while a pivot of R does not stand above its own rounding (linalg/triangles.hpp) the
/// innovation is NaN, health undetermined. Sources: Golub 1965; Bierman 1977 (SRIF); Haykin (QR-RLS).
template <RootedScalar T, int N = Dynamic>
class Qr {
    RealOf<T> lambda_, root_lambda_;
    StateVector<T, N> z_, psi_, x_, row_, s_, u_;
    StateVector<RealOf<T>, N> c_, before_, after_;
    StateMatrix<T, N> L_;    // R'
    ColumnLengths<T, N> lengths_;
    T y_ = T(0);             // the row that was looked at

public:
    using scalar = T;
    static constexpr std::string_view name = "qr";
    static constexpr Family family{Family::qr};
    static constexpr bool starts_without_prior = true;
    static constexpr int edition = 2;

    explicit Qr(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), root_lambda_(square_root(lambda_)), z_(problem.size),
          psi_(problem.size), x_(problem.size), row_(problem.size), s_(problem.size), u_(problem.size),
          c_(problem.size), before_(problem.size), after_(problem.size), L_(problem.size), lengths_(problem.size) {
        start_information_root(problem, L_, z_);
        lengths_.start(L_, z_);
    }

    Step<T> update(Regressor<T> psi, T y) {
        keep_regressor(psi, psi_, x_);
        Truth<T> const determined = lengths_.determined(L_);
        bool const in_range = lengths_.begin_row(lambda_, psi_, y, L_);
        if constexpr (Hardware<T>)
            if (in_range) {    // (2) to (4) in one pass, the same bits
                RealOf<T> const s = fold_qr(L_, x_, z_, y, c_, s_, u_, lambda_, root_lambda_);
                return if_determined(determined, step_of(y, lambda_, s));
            }
        row_ = psi_;
        return finish(solved(y), y, determined, false);
    }
    Innovation<T> look(Regressor<T> psi, T y) requires errors_are_relative<T> {
        keep_regressor(psi, row_, x_);
        y_ = y; auto const [e, s] = solved(y);
        return {select(lengths_.determined(L_), e, undefined<T>()), s};
    }
    Step<T> commit(Innovation<T> const& row) requires errors_are_relative<T> {
        Truth<T> const determined = lengths_.determined(L_); psi_ = row_;
        return finish(row, y_, determined, lengths_.begin_row(lambda_, psi_, y_, L_));
    }

    Vector<T, N> theta() const { return solved_lower_transposed(L_, z_); }
    Vector<T, N> gain() const { return solved_outer(L_, psi_); }
    void theta(StateVector<T, N>& out) const { out = z_; solve_lower_transposed(L_, out); }    // without the heap
    void gain(StateVector<T, N>& out) const { out = psi_; solve_outer(L_, out); }
    Matrix<T, N> information() const { return outer(L_); }
    Stored<T> stored() const { return {Stored<T>::Quantity::information, Stored<T>::Form::factor, L_.view()}; }
    auto form() requires Field<T> {
        return RootInformation<T, N>{lambda_, root_lambda_, z_, x_, c_, s_, u_, L_, lengths_};
    }
    static auto state(auto& f) { return std::tie(f.lambda_, f.root_lambda_, f.z_, f.psi_, f.L_, f.lengths_); }

private:
    /// (2) and (3) of the row in x_, which is row_, too.
    Innovation<T> solved(T e) {
        RealOf<T> s = undefined<RealOf<T>>();
        if constexpr (errors_are_relative<T>)
            if (errors_are_relative_now<T>() && any(nonsingular(L_)))
                s = solve_rotations(L_, z_, lambda_, root_lambda_, x_, e, c_, s_, u_, before_, after_);
        return {e, s};
    }
    /// (4) or (5). in_range: s and the answers are proven to be finite.
    Step<T> finish(Innovation<T> const& row, T y, Truth<T> determined, bool in_range) {
        Truth<T> const regular = nonsingular(L_), by_substitution = regular && is_finite(row.s);
        determined = determined && regular; RealOf<T> root_gamma = RealOf<T>(1); T const given = y;
        if (all(by_substitution)) sweep_rotations_in(L_, z_, y, x_, row_, c_, s_, u_);                    // (4)
        else if (any(by_substitution))
            rotate_or_sweep_in(by_substitution, L_, z_, y, row_, root_lambda_, c_, s_, u_, root_gamma);
        else {
            rotate_in(L_, row_, root_lambda_, z_, y, c_, s_); u_[0] = undefined<T>();             // c and s alone
            for (Index i = 0; i < row_.size(); ++i) root_gamma *= c_[i];
        }
        Step<T> step = step_of(row.e, lambda_, row.s);
        if (!all(by_substitution))
            step = select(by_substitution, step, report_rotated(y, root_gamma, determined));             // (5)
        step = if_determined(determined, step, select(by_substitution, given, y));
        return if_finite(Truth<T>(in_range) || lengths_.finite(L_, z_, psi_, row_) || !determined, step);
    }
};
static_assert(ReportsInformation<Qr<double>> && StartsWithoutPrior<Qr<double>> && LooksFirst<Qr<double>>);

}  // namespace rlslab
