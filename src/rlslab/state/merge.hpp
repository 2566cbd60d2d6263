// Two filters that took their rows apart from each other, merged into the filter that took both.
#pragma once

#include <rlslab/state/convert.hpp>
#include <rlslab/linalg/reflections.hpp>

namespace rlslab {

/// A filter that started from a problem's prior and took so many rows at the problem's lambda.
template <class F>
struct Part {
    F filter;
    Index rows = 0;
};

namespace detail {

/// P^-1 = L diag(D) L' and z = L'theta take the row [x' y] with weight w, of either sign:
///
///   for i = 1 ... d:  D' = D_i + w x_i^2,  s = w x_i / D',  w = w D_i / D',  D_i = D',  and for j > i
///                     x_j -= x_i L_ji,  L_ji += s x_j;   y and z_i alike
///
/// False where a D' is not positive. Source: Gentleman 1974.
template <Field T>
bool add_weighted_row(StateMatrix<T>& L, StateVector<T>& D, StateVector<T>& z, Vector<T>& x, T y, T w) {
    for (Index i = 0; i < x.size(); ++i) {
        if (x[i] == T(0) || w == T(0)) continue;
        T const weighed = w * x[i], sum = D[i] + weighed * x[i];
        if (!(T(0) < sum)) return false;
        T const s = weighed / sum;
        w *= D[i] / sum;
        D[i] = sum;
        for (Index j = i + 1; j < x.size(); ++j) {
            x[j] -= x[i] * L(j, i);
            L(j, i) += s * x[j];
        }
        y -= x[i] * z[i];
        z[i] += s * y;
    }
    return true;
}

/// P^-1 and P^-1 theta as rows: row i of R, R theta = z, has the weight D_i.
template <Field T>
struct InformationRows {
    StateMatrix<T> L;
    StateVector<T> D, z;
    Health health;

    InformationRows(Stored<T> const& stored, Vector<T> const& given) : L(0), D(0), z(0) {
        Triangle<T> factor(stored);
        health = health_of(factor.turn_into(factor.covariance, by_unit_triangle(stored)));
        if (health != Health::sound) return;
        health = health_of(factor.turn_into(false, true));
        StateVector<T> theta(given.size());
        for (Index i = 0; i < given.size(); ++i) theta[i] = given[i];
        if (!all_finite<T>(given)) health = worse(health, Health::nonfinite);
        L = factor.F;
        D = factor.D;
        z = theta;
        multiply_lower_transposed(L, theta, z);
    }
    /// Takes the rows of `other`, each weight times `weight`.
    bool add(InformationRows const& other, T const& weight) {
        for (Index i = 0; i < D.size(); ++i) {
            Vector<T> x = other.L.view().col(i);
            if (!add_weighted_row(L, D, z, x, other.z[i], T(weight * other.D[i]))) return false;
        }
        return true;
    }
};

/// The prior of the filter that took both; `prior` alone is taken out unless it is null.
template <Field T>
Health merge_rows(InformationRows<T>& sum, InformationRows<T> const& added, InformationRows<T> const* prior,
                  T const& mu, Problem<T>& start) {
    if (Health const health = worse(sum.health, added.health); health != Health::sound) return health;
    expects(sum.D.size() == start.size && added.D.size() == start.size, "parts of the problem's size");
    for (Index i = 0; i < start.size; ++i) sum.D[i] *= mu;
    if (!sum.add(added, T(1)) || (prior && !sum.add(*prior, T(-mu)))) return Health::indefinite;
    start.prior = Prior<T>{.theta = solved_lower_transposed(sum.L, sum.z)};
    start.prior->stored =
        Stored<T>{Stored<T>::Quantity::information, Stored<T>::Form::factor, sum.L.view(), sum.D.view()};
    Health const health = health_of(Triangle<T>(*start.prior->stored).turn_into(false, true));
    return worse(health, all_finite<T>(*start.prior->theta) ? Health::sound : Health::nonfinite);
}

}  // namespace detail

/// The filter that took older's rows and then newer's, where both started from the problem's prior, which counts once:
///
///   (1) X = mu X_a + X_b - mu X_0,   X theta alike,   X = P^-1,  mu = lambda^n,  n the rows of `newer`
///   (2) as rows: R_a's with weight mu, then R_b's rotated in, then R_0's out (square-root-free rotations), so that no
///     X is made
///
/// For every dense variant; without a prior nothing is taken out, and each part needs rows that determine its theta
/// (QrBlock::merge does not, and is cheaper). Associative but for rounding; a part without rows changes no bit of the
/// other. The prior's rows leave at least lambda^n / (1 + lambda^n) of the information in every direction, n the rows
/// of `older`: (2) loses few digits until lambda^n is small. Not for parts whose lambda or weights were chosen from the
/// data, nor for a walk. Health as convert reports it; gain() is zero until the next row. Throws std::invalid_argument
/// for parts of another size. d^3 operations. Source: Bierman 1977.
template <OverOrderedField F>
    requires(std::same_as<Truth<typename F::scalar>, bool>)
Converted<Part<F>> merged(Part<F> const& older, Part<F> const& newer, Problem<typename F::scalar> const& problem) {
    using T = typename F::scalar;
    checked(problem, detail::size_of<F>);
    expects(older.rows >= 0 && newer.rows >= 0, "counts of rows");
    if (newer.rows == 0) return {.filter = older};
    if (older.rows == 0) return {.filter = newer};
    detail::InformationRows<T> sum(older.filter.stored(), older.filter.theta());
    detail::InformationRows<T> const added(newer.filter.stored(), newer.filter.theta());
    std::optional<detail::InformationRows<T>> prior;
    if (problem.prior) {
        F const before(problem);
        prior.emplace(before.stored(), before.theta());
    }
    Problem<T> start{.size = detail::size_of<F> == Dynamic ? problem.size : detail::size_of<F>,
                     .forgetting = problem.forgetting};
    T const mu = detail::power(problem.forgetting, newer.rows);
    Health const health = detail::merge_rows(sum, added, prior ? &*prior : nullptr, mu, start);  // (2)
    if (health != Health::sound) return {.health = health};
    return {.filter = Part<F>{F(start), older.rows + newer.rows}};
}

}  // namespace rlslab
