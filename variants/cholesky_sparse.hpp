// The sparse information factor, kept up to date by CHOLMOD's rank-one update. Binary64 only; GPL-2+ by its library.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/cholmod.hpp>

namespace rlslab {

/// Propagates P^-1 = L D L', L sparse unit lower triangular, and b = P^-1 theta:
///
///   (1) e = y - psi'theta,   gamma = lambda / (lambda + f'D^-1 f),  L f = psi     with the factors of the step before
///   (2) D = lambda D, then L D L' + psi psi' by the update along psi's path in the elimination tree
///   (3) b = lambda b + psi y,   theta = (L D L')^-1 b,   K = (L D L')^-1 psi
///
/// Storage and time follow the fill of L, not d^2: f and the update of (2) take the columns on psi's path, D = lambda D
/// and theta all of them. Columns keep their order, so a band stays one. Squares the condition number as `information`
/// does. Needs a prior. Source: Davis & Hager 1999.
class CholeskySparse {
    double lambda_;
    Vector<double> theta_, b_, f_, K_;
    SparseLdl factor_;

    static SparseRows start(Problem<double> const& problem) {
        Vector<double> D;
        SparseRows const L = start_information(problem, D), LD = L * D.asDiagonal();
        return LD * SparseRows(L.transpose());
    }

public:
    using scalar = double;
    static constexpr std::string_view name = "cholesky_sparse";
    static constexpr Family family{Family::normal_equations, 1};

    explicit CholeskySparse(Problem<double> const& problem)
        : lambda_(checked(problem).forgetting), theta_(start_theta<double, Dynamic>(problem).view()), f_(problem.size),
          K_(Vector<double>::Zero(problem.size)), factor_(start(problem).triangularView<Eigen::Lower>()) {
        b_ = start(problem) * theta_;
    }

    Step<double> update(Regressor<double> psi, double y) { return update(sparse(psi), y); }
    Step<double> update(SparseRow const& psi, double y) {
        expects(psi.size() == theta_.size(), "a regressor of the problem's size");
        double const e = y - dot(psi, theta_);                                                           // (1)
        double const s = lambda_ + factor_.inverse_form(psi, f_);
        factor_.scale(lambda_);                                                                          // (2)
        bool const definite = factor_.update(psi);
        b_ *= lambda_;                                                                                   // (3)
        for (SparseRow::InnerIterator it(psi); it; ++it) b_[it.index()] += y * it.value();
        theta_ = b_;
        K_ = psi;
        bool const finite = factor_.solve(theta_, K_) && theta_.allFinite() && K_.allFinite();
        Step<double> step = if_finite(finite, step_of(e, lambda_, s));
        if (!definite && step.health == Health::sound) step.health = Health::indefinite;
        return step;
    }

    Vector<double> const& theta() const { return theta_; }
    Vector<double> const& gain() const { return K_; }
    Matrix<double> information() const {
        Stored<double> const X = stored();
        return X.F * X.D.asDiagonal() * X.F.transpose();
    }
    Stored<double> stored() const {
        Stored<double> X{Stored<double>::Quantity::information, Stored<double>::Form::factor, {}, {}};
        factor_.factors(X.F, X.D);
        return X;
    }
    static auto state(auto& f) { return std::tie(f.lambda_, f.theta_, f.b_, f.K_, f.factor_); }
};
static_assert(ReportsInformation<CholeskySparse>);

}  // namespace rlslab
