// Records with given singular values, and the outputs for any regressors.
#pragma once

#include <rlslab/core/random.hpp>
#include <rlslab/core/records.hpp>

#include <string_view>
#include <vector>

namespace rlslab::studies {

/// y_k = psi_k'theta + noise v_k, theta = (1, ..., 1), v nearly normal of variance 1 (Seed::bell). psi is d x N.
Records answered(Matrix<double> psi, Seed seed, double noise);
/// The same with another theta.
Records answered(Matrix<double> psi, Vector<double> const& theta, Seed seed, double noise);

/// n orthonormal columns of `size` numbers, n <= size, from noise by modified Gram-Schmidt, twice; sums in order.
Matrix<double> orthonormal(Index size, Index n, Seed& seed);

/// d singular values of condition kappa, largest first and 1: "geometric", or equal but "one small" or "one large".
std::vector<double> singular_values(std::string_view shape, Index size, double kappa);

/// N rows whose matrix has these d singular values, d <= N, and random orthonormal factors; exact but for rounding.
Records with_singular_values(std::vector<double> const& sigma, Index rows, Seed seed, double noise);

/// psi = V diag(sigma) U' (d x N) with U' of orthonormal rows and V orthogonal, both drawn; V = I unless rotated: then
/// the singular values are the sizes of the columns.
struct SingularRows {
    Matrix<double> psi, V;
};
SingularRows rows_of_singular_values(std::vector<double> const& sigma, Index rows, Seed& seed, bool rotated);

}  // namespace rlslab::studies
