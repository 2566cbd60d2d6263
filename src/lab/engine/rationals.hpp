// Small matrices of exact rationals, for studies whose laws hold with ==.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/core/stored.hpp>

namespace rlslab::studies::rationals {

using Q = Rational;
using V = Vector<Q>;
using M = Matrix<Q>;

inline V integers(Index size, Seed& seed, int range) {
    V out(size);
    for (Q& x : out) x = int(seed.next() % unsigned(2 * range + 1)) - range;
    return out;
}
inline M outer(V const& a, V const& b) { return a.lazyProduct(b.transpose()); }
inline Q dot(V const& a, V const& b) { return Q(a.transpose().lazyProduct(b)(0, 0)); }
inline Q form(V const& v, M const& A) { return dot(v, A.lazyProduct(v)); }

/// By Laplace's expansion along the first column.
inline Q determinant(M const& A) {
    Index const d = A.rows();
    if (d == 1) return A(0, 0);
    Q sum = 0;
    for (Index i = 0; i < d; ++i) {
        M minor(d - 1, d - 1);
        minor << A.block(0, 1, i, d - 1), A.block(i + 1, 1, d - 1 - i, d - 1);
        sum += (i % 2 ? -1 : 1) * A(i, 0) * determinant(minor);
    }
    return sum;
}
/// Gauss-Jordan without pivoting: definite matrices only.
inline M inverse(M A) {
    Index const d = A.rows();
    M X = M::Identity(d, d);
    for (Index j = 0; j < d; ++j) {
        Q const pivot = A(j, j);
        A.row(j) /= pivot, X.row(j) /= pivot;
        for (Index i = 0; i < d; ++i)
            if (Q const m = A(i, j); i != j) A.row(i) -= m * A.row(j), X.row(i) -= m * X.row(j);
    }
    return X;
}
/// Sylvester's criterion, of a symmetric matrix.
inline bool is_positive_definite(M const& A) {
    for (Index n = 1; n <= A.rows(); ++n)
        if (determinant(A.topLeftCorner(n, n)) <= 0) return false;
    return true;
}
/// P of the stored numbers.
inline M covariance(Stored<Q> const& stored) { return covariance_of(stored, inverse); }

}  // namespace rlslab::studies::rationals
