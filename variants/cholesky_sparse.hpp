// The sparse information factor, kept up to date by CHOLMOD's rank-one update. Binary64 only; GPL-2+ by its library.
#pragma once

#include <rlslab/concept.hpp>
#include <rlslab/linalg/cholmod.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates P^-1 = L D L', L sparse unit lower triangular, and b = P^-1 theta:
///
///   (1) e = y - psi'theta,   gamma = lambda / (lambda + psi'P psi)      with the factors of the step before
///   (2) D = lambda D, then L D L' + psi psi' by the update along psi's path in the elimination tree
///   (3) b = lambda b + psi y,   theta = (L D L')^-1 b
///
/// The cost follows the fill of L, not d^2. Squares the condition number as `information` does. Needs a prior.
/// Source: Davis & Hager, SIAM J. Matrix Anal. Appl. 20(3), 1999.
class CholeskySparse {
    double lambda_;
    Vector<double> theta_, b_, psi_;
    SparseLdl factor_;

    static Square<double> start(Problem<double> const& problem) {
        expects(problem.prior.has_value(), "a prior: the sparse factor is kept nonsingular");
        Square<double> L(problem.size), X(problem.size);
        Column<double> D(problem.size);
        start_information(problem, L, D);
        outer(L, D, X);
        return X;
    }

public:
    using scalar = double;
    static constexpr std::string_view name = "cholesky_sparse";

    explicit CholeskySparse(Problem<double> const& problem)
        : lambda_(checked(problem).forgetting), theta_(start_theta<double, Dynamic>(problem).view()),
          psi_(Vector<double>::Zero(problem.size)), factor_(start(problem).view()) {
        Column<double> b(problem.size);
        multiply(start(problem), theta_.data(), b);
        b_ = b.view();
    }

    Step<double> update(Regressor<double> psi, double y) {
        expects(psi.size() == theta_.size(), "a regressor of the problem's size");
        psi_ = Eigen::Map<Vector<double> const>(psi.data(), psi.size());
        double const e = y - dot(psi.data(), theta_.data(), psi.size());                                 // (1)
        Vector<double> const f = factor_.solve(psi_);
        double const gamma = lambda_ / (lambda_ + dot(psi.data(), f.data(), psi.size()));
        factor_.scale(lambda_);                                                                          // (2)
        bool const definite = factor_.update(psi_);
        b_ = lambda_ * b_ + y * psi_;                                                                    // (3)
        theta_ = factor_.solve(b_);
        Step<double> step = report(e, gamma);
        if (!definite && step.health == Health::sound) step.health = Health::indefinite;
        return step;
    }

    Vector<double> const& theta() const { return theta_; }
    Vector<double> gain() const { return factor_.solve(psi_); }
    Matrix<double> information() const {
        Stored<double> const X = stored();
        return X.F * X.D.asDiagonal() * X.F.transpose();
    }
    Stored<double> stored() const {
        Stored<double> X{Stored<double>::Of::information, Stored<double>::Kind::factor, {}, {}};
        factor_.factors(X.F, X.D);
        return X;
    }
};
static_assert(ReportsInformation<CholeskySparse>);

}  // namespace rlslab
