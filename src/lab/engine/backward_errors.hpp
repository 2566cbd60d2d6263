// Backward errors of theta and P in 257 bits: the distance to the nearest problem that an answer solves exactly.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/records.hpp>
#include <rlslab/core/stored.hpp>

namespace rlslab::studies {

/// min |A x - b|: A has the rows lambda^((N-k)/2) psi_k' and lambda^(N/2) R0, R0'R0 = P0^-1, and b the outputs and R0
/// theta0, weighted likewise. Each column of A is divided by its length, theta and P with it: the numbers below do not
/// depend on the units of the columns. Only the inner products of A are used. All are computed in 257 bits; of data of
/// 53 bits with lambda = 1 the sums are exact, unless their exponents differ by more than 100. The results are good
/// while u kappa^2 is far above 2^-257.
class GivenProblem {
    Vector<Reference> lengths_, b_;
    Matrix<Reference> M_, R_, V_;
    Reference c_;
    Vector<Reference> squares_, theta_;
    Matrix<Reference> P_;

    Vector<Reference> scaled(Vector<Reference> const& theta) const { return theta.cwiseProduct(lengths_); }

public:
    /// The prior is c^2 I or none; theta0 may be given. `by_lengths` = false leaves the columns unscaled. O(N d^2 +
    /// d^3). Throws std::invalid_argument for another prior, data of another size, and A of less than full rank.
    GivenProblem(Problem<double> const& problem, Records const& data, bool by_lengths = true);

    Index size() const { return M_.rows(); }
    Matrix<Reference> const& M() const { return M_; }  ///< A'A, with a diagonal of ones
    Matrix<Reference> const& R() const { return R_; }  ///< upper triangular, R'R = M
    Vector<Reference> theta() const;                   ///< the exact one, in the data's units
    Matrix<Reference> covariance() const;              ///< likewise P = (A'A)^-1
    double condition() const;                          ///< kappa_2(A)
    double row_condition() const;                      ///< cond(R), the greatest row sum of |R^-1||R|
    double theta_condition() const;                    ///< sup |dtheta|/|theta| over |dA|_F/|A|_F, to first order
    double covariance_condition() const;               ///< sup |dP|_F/|P|_F over |dA|_F/|A|_F, to first order
    double theta_error(Vector<Reference> const& theta) const;  ///< |theta^ - theta|/|theta|, of scaled columns

    /// min |dA|_F/|A|_F such that theta^ minimises |(A + dA) x - b|: docs/theory.md 69. By a series of positive terms,
    /// to 1e-9. Infinity unless finite. Throws std::invalid_argument for another size.
    double theta_backward_error(Vector<Reference> const& theta) const;
    /// min |dA|_F/|A|_F such that ((A + dA)'(A + dA))^-1 is the P stored: docs/theory.md 70. For a plain matrix that is
    /// not symmetric it is of the symmetric part. Infinity unless that is positive definite. Throws
    /// std::invalid_argument for another size.
    double covariance_backward_error(Stored<Reference> const& stored) const;
    /// |P^ - P|_F/|P|_F, of scaled columns; infinity unless finite.
    double covariance_error(Stored<Reference> const& stored) const;
};

/// min over orthogonal Q of |R - Q R^|_F, and a Q that attains it: the polar factor of R R^'. Square, of one size.
struct Procrustes {
    Reference distance;
    Matrix<Reference> Q;
    Procrustes(Matrix<Reference> const& R, Matrix<Reference> const& other);
};

}  // namespace rlslab::studies
