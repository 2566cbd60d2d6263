// Backward errors of theta and P, by the inner products of the data and in 257 bits.
#include <rlslab/studies/backward_errors.hpp>

#include <rlslab/core/rounding.hpp>

#include <Eigen/SVD>
#include <cmath>
#include <optional>

namespace rlslab::studies {
namespace {

using Numbers = Matrix<Reference>;

/// Of a matrix or a vector.
Reference square(auto const& A) {
    Reference sum = 0;
    for (Reference const& x : A.reshaped()) sum += x * x;
    return sum;
}
bool all_finite(Numbers const& A) {
    for (Reference const& x : A.reshaped())
        if (!isfinite(x)) return false;
    return true;
}

/// Upper triangular R, R'R = X; nothing unless X is positive definite.
std::optional<Numbers> root(Numbers const& X) {
    if (!all_finite(X)) return std::nullopt;
    Index const d = X.rows();
    Numbers R = Numbers::Zero(d, d);
    for (Index i = 0; i < d; ++i)
        for (Index j = i; j < d; ++j) {
            Reference sum = X(i, j);
            for (Index k = 0; k < i; ++k) sum -= R(k, i) * R(k, j);
            if (i == j && !(sum > 0)) return std::nullopt;
            R(i, j) = i == j ? Reference(sqrt(sum)) : Reference(sum / R(i, i));
        }
    return R;
}
Numbers inverse_of_triangle(Numbers const& R) {
    return R.triangularView<Eigen::Upper>().solve(Numbers::Identity(R.rows(), R.cols()));
}
Numbers symmetric_part(Numbers const& X) { return (X + X.transpose()) / Reference(2); }

}  // namespace

Procrustes::Procrustes(Matrix<Reference> const& R, Matrix<Reference> const& other) {
    Eigen::JacobiSVD<Numbers> const svd(R.lazyProduct(other.transpose()), Eigen::ComputeFullU | Eigen::ComputeFullV);
    Q = svd.matrixU().lazyProduct(svd.matrixV().transpose());
    distance = sqrt(square(Numbers(R - Q.lazyProduct(other))));  // not by traces: they cancel
}

GivenProblem::GivenProblem(Problem<double> const& problem, Records const& data, bool by_lengths) {
    Index const d = problem.size;
    expects(d > 0 && data.parameters() == d && data.y.size() == data.rows(), "data of the problem's size");
    expects(!problem.prior || (!problem.prior->covariance && !problem.prior->stored), "a prior of c^2 I, or none");
    M_ = Numbers::Zero(d, d);
    b_ = Vector<Reference>::Zero(d);
    c_ = 0;
    if (problem.prior)
        for (Index i = 0; i < d; ++i) {
            Reference const weight = Reference(1) / problem.prior->variance,
                            at = problem.prior->theta ? Reference((*problem.prior->theta)[i]) : Reference(0);
            M_(i, i) = weight, b_[i] = weight * at, c_ += weight * at * at;
        }
    Reference const lambda = problem.forgetting;
    for (Index k = 0; k < data.rows(); ++k) {
        Reference const y = data.y[k];
        for (Index j = 0; j < d; ++j) {
            Reference const x = data.psi(j, k);
            for (Index i = 0; i < d; ++i) M_(i, j) = lambda * M_(i, j) + x * data.psi(i, k);
            b_[j] = lambda * b_[j] + x * y;
        }
        c_ = lambda * c_ + y * y;
    }
    lengths_ = Vector<Reference>::Constant(d, Reference(1));
    for (Index j = 0; by_lengths && j < d; ++j) lengths_[j] = sqrt(M_(j, j));
    for (Index j = 0; j < d; ++j) {
        for (Index i = 0; i < d; ++i) M_(i, j) /= lengths_[i] * lengths_[j];
        b_[j] /= lengths_[j];
    }
    std::optional<Numbers> const R = root(M_);
    expects(R.has_value(), "regressors of full rank");
    R_ = *R;
    Numbers const inverse = inverse_of_triangle(R_);
    P_ = inverse.lazyProduct(inverse.transpose());
    theta_ = P_.lazyProduct(b_);
    Eigen::JacobiSVD<Numbers> const svd(R_, Eigen::ComputeFullV);
    squares_ = svd.singularValues().cwiseProduct(svd.singularValues());  // descending
    V_ = svd.matrixV();
}

Vector<Reference> GivenProblem::theta() const { return theta_.cwiseQuotient(lengths_); }
Matrix<Reference> GivenProblem::covariance() const {
    Numbers P = P_;
    for (Index j = 0; j < size(); ++j)
        for (Index i = 0; i < size(); ++i) P(i, j) /= lengths_[i] * lengths_[j];
    return P;
}

double GivenProblem::condition() const {
    return static_cast<double>(sqrt(Reference(squares_[0] / squares_[size() - 1])));
}

double GivenProblem::row_condition() const {
    Numbers const inverse = inverse_of_triangle(R_);
    Reference greatest = 0;
    for (Index i = 0; i < size(); ++i) {
        Reference sum = 0;
        for (Index j = 0; j < size(); ++j)
            for (Index k = 0; k < size(); ++k) sum += abs(inverse(i, k)) * abs(R_(k, j));
        if (sum > greatest) greatest = sum;
    }
    return static_cast<double>(greatest);
}

double GivenProblem::theta_condition() const {  // |A^+| sqrt(|A^+|^2 |r|^2 + |x|^2) |A|_F/|x|
    Reference const x = square(theta_), r = c_ - theta_.cwiseProduct(b_).sum(), s = squares_[size() - 1];
    return static_cast<double>(sqrt(Reference(M_.trace() / s * (r / s / x + 1))));
}
double GivenProblem::covariance_condition() const {  // 2 |A|_F/(sigma_d^3 |P|_F)
    Reference const s = squares_[size() - 1];
    return static_cast<double>(Reference(2) * sqrt(Reference(M_.trace() / (s * s * s) / square(P_))));
}

double GivenProblem::theta_error(Vector<Reference> const& theta) const {
    expects(theta.size() == size(), "theta of the problem's size");
    double const error =
        static_cast<double>(sqrt(Reference(square(Vector<Reference>(scaled(theta) - theta_)) / square(theta_))));
    return std::isfinite(error) ? error : INFINITY;
}

double GivenProblem::theta_backward_error(Vector<Reference> const& theta) const {
    expects(theta.size() == size(), "theta of the problem's size");
    Vector<Reference> const x = scaled(theta), g = b_ - M_.lazyProduct(x), h = V_.transpose().lazyProduct(g);
    Reference const length = square(x);
    if (!isfinite(length)) return INFINITY;
    Reference r = c_;  // |r|^2
    for (Index i = 0; i < size(); ++i) r -= x[i] * (b_[i] + g[i]);
    if (length == 0) {  // x = 0 is exact where b is orthogonal to A + dA
        return square(g) == 0 ? 0 : static_cast<double>(sqrt(Reference(square(b_) / c_ / M_.trace())));
    }
    Reference const tau = Reference(1) / length, phi = tau * r;  // phi^2
    Reference e = 0;
    for (int iteration = 0; iteration < 100000; ++iteration) {
        Reference next = 0;
        for (Index i = 0; i < size(); ++i) next += h[i] * h[i] / (squares_[i] + phi - e);
        next *= tau;
        bool const converged = next - e <= next * 1e-18;
        e = next;
        if (converged) break;
    }
    return static_cast<double>(sqrt(Reference(e / M_.trace())));
}

double GivenProblem::covariance_backward_error(Stored<Reference> const& stored) const {
    expects(stored.F.rows() == size() && stored.F.cols() == size(), "P of the problem's size");
    bool const information = stored.quantity == Stored<Reference>::Quantity::information;
    Numbers X = symmetric_part(multiplied_out(stored));
    for (Index j = 0; j < size(); ++j)
        for (Index i = 0; i < size(); ++i) {
            Reference const unit = lengths_[i] * lengths_[j];
            if (information) X(i, j) /= unit;
            else X(i, j) *= unit;
        }
    std::optional<Numbers> const R = root(X);
    if (!R) return INFINITY;
    // P^ = R'R has the inverse R^-1 R^-T, of which (R^-1)' is a factor.
    Numbers const other = information ? *R : Numbers(inverse_of_triangle(*R).transpose());
    return static_cast<double>(Reference(Procrustes(R_, other).distance / sqrt(Reference(M_.trace()))));
}

double GivenProblem::covariance_error(Stored<Reference> const& stored) const {
    expects(stored.F.rows() == size() && stored.F.cols() == size(), "P of the problem's size");
    Numbers X = multiplied_out(stored);
    if (stored.quantity == Stored<Reference>::Quantity::information) {
        std::optional<Numbers> const R = root(symmetric_part(X));
        if (!R) return INFINITY;
        Numbers const inverse = inverse_of_triangle(*R);
        X = inverse.lazyProduct(inverse.transpose());
    }
    for (Index j = 0; j < size(); ++j)
        for (Index i = 0; i < size(); ++i) X(i, j) *= lengths_[i] * lengths_[j];
    double const error = static_cast<double>(sqrt(Reference(square(Numbers(X - P_)) / square(P_))));
    return std::isfinite(error) ? error : INFINITY;
}

}  // namespace rlslab::studies
