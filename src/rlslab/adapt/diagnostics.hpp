// Single numbers of a filter's state, cheap enough for every row.
#pragma once

#include <rlslab/adapt/time_update.hpp>

namespace rlslab {

// --- P_jj ------------------------------------------------------------------------------------------------------------

/// P_jj, without multiplying P out: the variance of theta_j in units of the noise's. One number where P is stored; d
/// multiplications from a factor of P; d^2/6 on average from a factor of P^-1, which uses the form's workspace. Not
/// finite, or <= 0, means breakdown.
template <class T, int N, class Storage>
T variance(PlainCovariance<T, N, Storage> f, Index j) {
    return f.P(j, j);
}
template <class T, int N, bool upper>
T variance(RootCovariance<T, N, upper> f, Index j) {
    T sum = T(0);
    for (Index k = upper ? j : 0; k < f.theta.size(); ++k) {
        T const square = f.S(j, k) * f.S(j, k);
        sum += square;
    }
    return sum;
}
template <class T, int N>
T variance(UdCovariance<T, N> f, Index j) {
    T sum = T(0);
    for (Index k = j; k < f.theta.size(); ++k) {
        T const square = f.U(j, k) * f.U(j, k), term = square * f.D[k];
        sum += term;
    }
    return sum;
}
namespace detail {
/// x = L^-1 e_j, which is 0 above row j: P_jj = sum x_i^2, or x_i^2 / D_i.
template <class T, int N>
void solve_unit(StateMatrix<T, N> const& L, Index j, StateVector<T, N>& x) {
    Index const d = x.size();
    for (Index i = 0; i < d; ++i) x[i] = T(i == j ? 1 : 0);
    for (Index i = j; i < d; ++i) {
        x[i] /= L(i, i);
        add_scaled(x.data() + i + 1, T(-x[i]), L.column(i) + i + 1, d - i - 1);
    }
}
template <class T, int N>
T sum_over(StateVector<T, N> const& x, StateVector<T, N> const& D, Index j) {
    T sum = T(0);
    for (Index i = j; i < x.size(); ++i) {
        T const square = x[i] * x[i];
        sum += square / D[i];
    }
    return sum;
}
/// A_j'x, in the order of dot.
template <class T, int N>
T column_product(StateMatrix<T, N> const& A, Index j, StateVector<T, N> const& x) {
    return dot(A.column(j), x.data(), x.size());
}
template <class T, int N>
T column_product(SymmetricMatrix<T, N> const& A, Index j, StateVector<T, N> const& x) {
    return lanes_summed<0, 1>(A.column(j), x.data(), x.size());
}
/// x'A x, A symmetric: the sum of x_j times column j's product with x.
template <class T, int N, class Storage>
T quadratic_form(Storage const& A, StateVector<T, N> const& x) {
    T sum = T(0);
    for (Index j = 0; j < x.size(); ++j) {
        T const along = column_product(A, j, x), term = x[j] * along;
        sum += term;
    }
    return sum;
}
}  // namespace detail
template <class T, int N>
T variance(RootInformation<T, N> f, Index j) {
    detail::solve_unit(f.L, j, f.x);
    T sum = T(0);
    for (Index i = j; i < f.x.size(); ++i) {
        T const square = f.x[i] * f.x[i];
        sum += square;
    }
    return sum;
}
template <class T, int N>
T variance(UnitInformation<T, N> f, Index j) {
    detail::solve_unit(f.L, j, f.x);
    return detail::sum_over(f.x, f.D, j);
}
template <class T, int N>
T variance(NormalEquations<T, N> f, Index j) {
    if (!f.solved) f.solve();
    detail::solve_unit(f.L, j, f.f);
    return detail::sum_over(f.f, f.D, j);
}

template <class F>
concept ReportsVariances = NamesItsForm<F> && requires(F f) { variance(f.form(), Index(0)); };

template <ReportsVariances F>
typename F::scalar variance(F& f, Index j) {
    return variance(f.form(), j);
}
/// tr P, d times the cost of one.
template <ReportsVariances F>
typename F::scalar trace(F& f) {
    using T = typename F::scalar;
    T sum = T(0);
    for (Index j = 0, d = f.theta().size(); j < d; ++j) sum += variance(f.form(), j);
    return sum;
}

/// The variance of theta_j that a guard holds down: P_jj where P or a factor of it is stored. Where a factor of P^-1
/// is, that of theta_j if theta_{j+1} ... theta_d are known, 1/R_jj^2 <= P_jj: one number, no substitution. Where P
/// grows without bound, so does one of them: their product is det P (docs/theory.md 88).
template <class Form>
typename Form::scalar watched_variance(Form f, Index j)
    requires(!RecursiveLeastSquares<Form>)
{
    return variance(f, j);
}
template <class T, int N>
T watched_variance(RootInformation<T, N> f, Index j) {
    T const by = T(1) / f.L(j, j);  // R_jj^2 may overflow where 1/R_jj^2 is a number
    return by * by;
}
template <class T, int N>
T watched_variance(UnitInformation<T, N> f, Index j) {
    return T(1) / f.D[j];
}
template <class T, int N>
T watched_variance(NormalEquations<T, N> f, Index j) {
    if (!f.solved) f.solve();
    return T(1) / f.D[j];
}
template <ReportsVariances F>
typename F::scalar watched_variance(F& f, Index j) {
    return watched_variance(f.form(), j);
}

// --- psi'P psi -------------------------------------------------------------------------------------------------------

/// psi'P psi: what the variance of psi'theta is in units of the noise's. From P or a factor of P^-1 or of P. At most
/// d^2 multiplications; uses the form's workspace.
template <class T, int N, class Storage>
T variance_along(PlainCovariance<T, N, Storage> f, Regressor<T> psi) {
    keep_regressor(psi, f.f);
    return detail::quadratic_form(f.P, f.f);
}
template <class T, int N, bool upper>
T variance_along(RootCovariance<T, N, upper> f, Regressor<T> psi) {
    keep_regressor(psi, f.g);
    multiply_transposed(f.S, f.g.data(), f.f);
    return dot(f.f, f.f);
}
template <class T, int N>
T variance_along(UdCovariance<T, N> f, Regressor<T> psi) {
    keep_regressor(psi, f.g);
    multiply_transposed(f.U, f.g.data(), f.f);
    scale(f.D, f.f, f.g);
    return dot(f.f, f.g);
}
template <class T, int N>
T variance_along(RootInformation<T, N> f, Regressor<T> psi) {
    keep_regressor(psi, f.x);
    solve_lower(f.L, f.x);
    return dot(f.x, f.x);
}
template <class T, int N>
T variance_along(UnitInformation<T, N> f, Regressor<T> psi) {
    keep_regressor(psi, f.x);
    solve_lower(f.L, f.x);
    return detail::sum_over(f.x, f.D, 0);
}
template <class T, int N>
T variance_along(NormalEquations<T, N> f, Regressor<T> psi) {
    if (!f.solved) f.solve();
    keep_regressor(psi, f.f);
    solve_lower(f.L, f.f);
    return detail::sum_over(f.f, f.D, 0);
}
template <ReportsVariances F>
typename F::scalar variance_along(F& f, Regressor<typename F::scalar> psi) {
    return variance_along(f.form(), psi);
}

// --- psi'P^-1 psi ----------------------------------------------------------------------------------------------------

/// psi'P^-1 psi, from a factor of P or of P^-1, or from P^-1. At most d^2 multiplications; uses the form's workspace.
template <class T, int N>
T information_along(RootCovariance<T, N, true> f, Regressor<T> psi) {
    keep_regressor(psi, f.f);
    for (Index j = psi.size() - 1; j >= 0; --j) {  // S t = psi
        f.f[j] /= f.S(j, j);
        add_scaled(f.f.data(), T(-f.f[j]), f.S.column(j), j);
    }
    return dot(f.f, f.f);
}
template <class T, int N>
T information_along(UdCovariance<T, N> f, Regressor<T> psi) {
    keep_regressor(psi, f.f);
    for (Index j = psi.size() - 1; j >= 0; --j) add_scaled(f.f.data(), T(-f.f[j]), f.U.column(j), j);  // U t = psi
    divide(f.f, f.D, f.g);
    return dot(f.f, f.g);
}
template <class T, int N>
T information_along(RootInformation<T, N> f, Regressor<T> psi) {
    keep_regressor(psi, f.x);
    multiply_lower_transposed(f.L, f.x, f.c);
    return dot(f.c, f.c);
}
template <class T, int N>
T information_along(UnitInformation<T, N> f, Regressor<T> psi) {
    keep_regressor(psi, f.x);
    multiply_lower_transposed(f.L, f.x, f.c);
    scale(f.c, f.D, f.s);
    return dot(f.c, f.s);
}
template <class T, int N>
T information_along(NormalEquations<T, N> f, Regressor<T> psi) {
    keep_regressor(psi, f.f);
    return detail::quadratic_form(f.X, f.f);
}

template <class F>
concept ReportsInformationAlong =
    NamesItsForm<F> && requires(F f, Regressor<typename F::scalar> psi) { information_along(f.form(), psi); };

template <ReportsInformationAlong F>
typename F::scalar information_along(F& f, Regressor<typename F::scalar> psi) {
    return information_along(f.form(), psi);
}

// --- asymmetry -------------------------------------------------------------------------------------------------------

/// Whether |P_ij - P_ji| <= share sqrt(P_ii P_jj), P in full storage: no unit of the parameters changes it. False where
/// one of the four is NaN, or P_ii or P_jj negative. The roots are taken only where the smaller of P_ii and P_jj does
/// not decide.
template <Real T, int N>
Truth<T> symmetric_within(PlainCovariance<T, N> f, T const& share, Index i, Index j) {
    T const difference = absolute(T(f.P(i, j) - f.P(j, i))), a = f.P(i, i), b = f.P(j, j);
    T const least = select(b < a || !(b == b), b, a);  // a NaN of either
    Truth<T> within = difference <= share * least;
    if (!all(within)) within = within || difference <= share * (square_root(a) * square_root(b));
    return within;
}

/// Keeps P in full storage, and is no variant that is `mirrored`, whose P is symmetric by construction, nor around one.
template <class F>
concept MayLoseSymmetry = NamesItsForm<F> && !requires { requires F::mirrored; } &&
                          requires(F f, typename F::scalar x) { symmetric_within(f.form(), x, Index(0), Index(0)); };

template <MayLoseSymmetry F>
Truth<typename F::scalar> symmetric_within(F& f, typename F::scalar const& share, Index i, Index j) {
    return symmetric_within(f.form(), share, i, j);
}

}  // namespace rlslab
