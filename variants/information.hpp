// The information form: normal equations kept up to date, solved by Cholesky.
#pragma once

#include <rlslab/concept.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates X = P^-1 and b = X theta, and solves the normal equations at every step:
///
///   (1) gamma = lambda / (lambda + psi'X^-1 psi)          from the factors of the step before
///   (2) X = lambda X + psi psi',   b = lambda b + psi y   (3) X = L D L',   theta = X^-1 b,   K = X^-1 psi when asked
///
/// Squares the condition number: the other cautionary form. A pivot D_j <= 0 is breakdown (indefinite): theta is then
/// NaN until a later X factors again, and the row after it indefinite too, having no theta to innovate on. Starts without a prior: theta is NaN and health undetermined until X factors.
/// Storage 2 d^2; per update d^3/6 + 3.5 d^2 + O(d) multiplications, no square root. Source: Gauss; Bierman 1977.
template <Field T, int N = Dynamic>
class Information {
    T lambda_;
    Column<T, N> theta_, b_, psi_, D_, f_;
    Square<T, N> X_, L_;
    bool positive_, started_;
    Index rows_;    // so far; a prior counts as d

    void solve() {
        bool const factors = factor_ldl(X_, L_, D_);                                                     // (3)
        // Rounding can make a singular X factor; fewer rows than parameters prove that it is.
        positive_ = factors && rows_ >= theta_.size();
        started_ = started_ || positive_;
        theta_ = b_;
        solve_factored(theta_);
    }
    void solve_factored(Column<T, N>& x) const {
        solve_lower(L_, x);
        for (Index i = 0; i < x.size(); ++i) x[i] = positive_ ? x[i] / D_[i] : undefined<T>();
        solve_lower_transposed(L_, x);
    }

public:
    using scalar = T;
    static constexpr std::string_view name = "information";
    static constexpr bool starts_without_prior = true;

    explicit Information(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), theta_(start_theta<T, N>(problem)), b_(problem.size),
          psi_(problem.size), D_(problem.size), f_(problem.size), X_(problem.size), L_(problem.size), positive_(false),
          started_(problem.prior.has_value()), rows_(started_ ? problem.size : 0) {
        start_information(problem, L_, D_);
        positive_ = started_;
        outer(L_, D_, X_);
        multiply(X_, theta_.data(), b_);
    }

    Step<T> update(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        keep_regressor(psi, psi_);
        f_ = psi_;
        solve_lower(L_, f_);                                                                             // (1)
        T s = lambda_;
        for (Index i = 0; i < f_.size(); ++i) s += f_[i] * f_[i] / D_[i];
        bool const known = positive_, started = started_;
        T seen = y;    // spoilt by data that are not finite
        for (Index j = 0; j < f_.size(); ++j) {
            for (Index i = 0; i < f_.size(); ++i) X_(i, j) = lambda_ * X_(i, j) + psi_[i] * psi_[j];     // (2)
            b_[j] = lambda_ * b_[j] + psi_[j] * y;
            if (!known) seen += X_(j, j);
        }
        ++rows_;
        solve();
        Step<T> step = known ? report(e, lambda_, s) : report_undetermined(seen);
        if (((started && !known) || (started_ && !positive_)) && step.health != Health::nonfinite) step.health = Health::indefinite;
        return step;
    }

    auto theta() const { return theta_.view(); }
    Vector<T, N> gain() const {
        Column<T, N> K = psi_;
        solve_factored(K);
        return K.view();
    }
    Matrix<T, N> information() const { return X_.view(); }
    Stored<T> stored() const { return {Stored<T>::Of::information, Stored<T>::Kind::plain, X_.view()}; }
};
static_assert(ReportsInformation<Information<double>> && StartsWithoutPrior<Information<double>>);

}  // namespace rlslab
