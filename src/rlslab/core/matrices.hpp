// Eigen's vectors and matrices as the library's interfaces use them.
#pragma once

#include <Eigen/Core>

namespace rlslab {

using Index = Eigen::Index;
inline constexpr int Dynamic = Eigen::Dynamic;

/// Eigen's types at the interface: estimates, covariances, data. Arithmetic inside a variant is not Eigen's.
/// DontAlign: Eigen's aligned storage depends on the instruction set for which a file is compiled, and an application
/// may be compiled for another one than the library. Without alignment all files lay out, allocate and free these types
/// alike.
template <class T, int N = Dynamic>
using Vector = Eigen::Matrix<T, N, 1, Eigen::DontAlign>;
/// Rows x Columns; Matrix<T, N> is square, Matrix<T> of any shape: each use says which.
template <class T, int Rows = Dynamic, int Columns = Rows>
using Matrix = Eigen::Matrix<T, Rows, Columns, Eigen::DontAlign>;

/// Several rows, the oldest first: their regressors (d x B), and their B outputs.
template <class T>
using RowsOf = Eigen::Ref<Matrix<T> const> const&;
template <class T>
using OutputsOf = Eigen::Ref<Vector<T> const> const&;

}  // namespace rlslab
