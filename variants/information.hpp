// The information form: normal equations kept up to date, solved by Cholesky.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates X = P^-1 and b = X theta, and solves the normal equations for the report of a row:
///
///   (1) gamma = lambda / (lambda + psi'X^-1 psi)          from the factors of the step before
///   (2) X = lambda X + psi psi',   b = lambda b + psi y   (3) X = L D L',   theta = X^-1 b,   K = X^-1 psi on request
///
/// Squares the condition number; the form is here as a warning. A pivot D_j <= 0 is breakdown (indefinite): theta is
/// NaN until a later X factors again, and the next row is indefinite too, because no theta predicts its y. Starts
/// without a prior: from the first row until X factors, theta is NaN, and until its pivots stand above their rounding,
/// health undetermined. Storage 2 d^2; per update d^3/6 + 3.5 d^2 + O(d) multiplications (after rows without report
/// another d^3/6 + d^2), per row without report 2 d^2 + O(d). Source: Gauss; Bierman 1977.
template <Scalar T, int N = Dynamic>
class Information {
    RealOf<T> lambda_;
    StateVector<T, N> theta_, b_, psi_, f_;
    StateVector<RealOf<T>, N> D_;
    StateMatrix<T, N> X_, L_;
    Truth<T> positive_, started_;    // X factors; has been seen to factor with pivots above their rounding
    PerLane<T, Index> rows_;         // so far; a prior counts as d
    bool solved_ = true;             // L, D and theta are those of X and b
    auto equations() {
        return NormalEquations<T, N>{lambda_, theta_, b_, D_, f_, X_, L_, positive_, started_, rows_, solved_};
    }
    Information& solve() {
        equations().solve();                                                                                  // (3)
        return *this;
    }
    Information solved() const { return Information(*this).solve(); }

public:
    using scalar = T;
    static constexpr std::string_view name = "information";
    static constexpr Family family{Family::normal_equations};
    static constexpr bool starts_without_prior = true;

    explicit Information(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), theta_(start_theta<T, N>(problem)), b_(problem.size),
          psi_(problem.size), f_(problem.size), D_(problem.size), X_(problem.size), L_(problem.size),
          positive_(problem.prior.has_value()), started_(positive_), rows_(problem.prior ? theta_.size() : 0) {
        start_information(problem, L_, D_);
        outer(L_, D_, X_);
        multiply(X_, theta_.data(), b_);
    }

    Step<T> update(Regressor<T> psi, T y) {
        if (!solved_) solve();
        T const e = innovation(y, psi, theta_);
        keep_regressor(psi, f_);
        solve_lower(L_, f_);                                                                             // (1)
        RealOf<T> s = lambda_;
        for (Index i = 0; i < f_.size(); ++i) s += absolute_square(f_[i]) / D_[i];
        Truth<T> const started = started_, known = positive_ && started;
        accumulate(psi, y);
        if (!solved_) solve();
        T seen = y;    // spoilt by data that are not finite
        for (Index j = 0; j < f_.size(); ++j) seen = select(is_finite(X_(j, j)), seen, X_(j, j));
        Step<T> step = select(known, step_of(e, lambda_, s), report_undetermined(seen));
        step = if_finite(!known || !positive_ || answers_finite(X_, L_, D_, theta_, psi_, f_), step);
        Truth<T> const broken = (started && !known) || (started_ && !positive_);
        step.health = worse(step.health, select(broken, PerLane<T, Health>(Health::indefinite),
                                                PerLane<T, Health>(Health::sound)));
        return step;
    }
    void accumulate(Regressor<T> psi, T y) {
        keep_regressor(psi, psi_);
        add_sample(X_, b_, lambda_, psi_, y);                                                                   // (2)
        ++rows_;
        solved_ = false;
        if (!all(started_)) solve();    // X that factored once and does so no longer is breakdown, not a start
    }
    Vector<T, N> theta() const { return solved_ ? theta_.view() : solved().theta_.view(); }
    Vector<T, N> gain() const {
        StateVector<T, N> K(psi_.size());
        gain(K);
        return K.view();
    }
    void theta(StateVector<T, N>& out) const { if (solved_) out = theta_; else solved().theta(out); }
    void gain(StateVector<T, N>& out) const {
        if (!solved_) return solved().gain(out);
        out = psi_;
        solve_ldl(L_, D_, positive_, out);
    }
    Matrix<T, N> information() const { return X_.view(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::information, Stored<T>::Form::plain, X_.view()}; }
    auto form() requires Field<T> { return equations(); }
    static auto state(auto& f) {
        return std::tie(f.lambda_, f.theta_, f.b_, f.psi_, f.D_, f.X_, f.L_, f.positive_, f.started_, f.rows_,
                        f.solved_); }
};
static_assert(ReportsInformation<Information<double>> && StartsWithoutPrior<Information<double>> &&
              Accumulates<Information<double>>);

}  // namespace rlslab
