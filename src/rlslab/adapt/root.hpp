// A square root of P, from the factor that a filter stores: what draws of theta and the least excited direction are
// computed with.
#pragma once

#include <rlslab/core/stored.hpp>
#include <rlslab/linalg/kernels.hpp>

namespace rlslab {

/// S with S S' = P, from the stored factor; P is never formed:
///
///   (1) P = F diag(D) F'       S = F diag(sqrt(D))               (carlson, inverse_qr, extended_qr, potter; ud)
///   (2) P^-1 = F diag(D) F'    S = (F diag(sqrt(D)))^-T          (qr, qr_block: F = R', S = R^-1; gentleman)
///
/// F of (2) is lower triangular. Not of `plain`, where P or P^-1 itself is stored: no root is computed behind the
/// caller's back. Throws std::invalid_argument for that, and for a D where T has no roots. Allocates d^2 numbers.
template <Field T>
class RootOf {
    Matrix<T> F_;
    bool inverse_, sound_ = true;

public:
    explicit RootOf(Stored<T> const& stored)
        : F_(stored.F), inverse_(stored.quantity == Stored<T>::Quantity::information) {
        expects(stored.form == Stored<T>::Form::factor, "a form that stores a root of P, or of its inverse");
        for (Index j = 0; j < stored.D.size(); ++j) {
            sound_ = sound_ && T(0) <= stored.D[j];
            if constexpr (RootedScalar<T>) {
                T const root = square_root(stored.D[j]);
                for (Index i = 0; i < size(); ++i) F_(i, j) *= root;
            } else {
                expects(stored.D.size() == 0, "a scalar with square roots");
            }
        }
        for (Index j = 0; j < size(); ++j) {
            for (Index i = inverse_ ? j : 0; i < size(); ++i) sound_ = sound_ && is_finite(F_(i, j));
            sound_ = sound_ && !(inverse_ && F_(j, j) == T(0));
        }
    }
    Index size() const { return F_.cols(); }
    /// Whether F's numbers are finite, no D_j is negative, and no pivot of (2) is 0: else S has no meaning.
    bool sound() const { return sound_; }

    /// S, d x d by columns. (1): as it is stored; (2): d^3/6 multiplications, an upper triangle.
    void matrix(T* S) const {
        Index const d = size();
        for (Index j = 0; j < d; ++j) {
            T* const x = S + j * d;
            for (Index i = 0; i < d; ++i) x[i] = inverse_ ? T(0) : F_(i, j);
            for (Index i = j; inverse_ && i >= 0; --i)
                x[i] = (T(i == j ? 1 : 0) - dot(column(i) + i + 1, x + i + 1, j - i)) / F_(i, i);
        }
    }
    /// x = S z, x and z of d numbers each and apart. (1): d^2 multiplications, column by column; (2): d^2/2, by
    /// substitution backwards.
    void times(T const* z, T* x) const {
        Index const d = size();
        if (!inverse_) {
            for (Index i = 0; i < d; ++i) x[i] = T(0);
            for (Index j = 0; j < d; ++j) add_scaled(x, z[j], column(j), d);
            return;
        }
        for (Index i = d - 1; i >= 0; --i) x[i] = (z[i] - dot(column(i) + i + 1, x + i + 1, d - i - 1)) / F_(i, i);
    }

private:
    T const* column(Index j) const { return F_.data() + j * F_.rows(); }
};

}  // namespace rlslab
