// The numbers that a filter stores for P, before any factor is multiplied out or inverted.
#pragma once

#include <rlslab/core/complex.hpp>
#include <rlslab/core/matrices.hpp>

namespace rlslab {

/// The stored numbers F (d x d) and D (d, or empty), the matrix X = P or X = P^-1 that they represent, and how:
///   plain   X = F                                   (conventional, joseph, information ...)
///   factor  X = F diag(D) F', D absent meaning I    (potter, carlson, ud, qr: F = R', gentleman)
/// A measurement converts F and D exactly to a wider arithmetic and computes there, so that it adds no rounding error
/// to the variant's.
template <class T>
struct Stored {
    enum class Quantity { covariance, information } quantity;
    enum class Form { plain, factor } form;
    Matrix<T> F;
    Vector<RealOf<T>> D = {};  ///< size 0: the identity

    template <class To, class Convert>
        requires(!ComplexScalar<T> && !ComplexScalar<To>)
    Stored<To> mapped(Convert convert) const {
        return {static_cast<typename Stored<To>::Quantity>(quantity), static_cast<typename Stored<To>::Form>(form),
                F.unaryExpr(convert).template cast<To>(), D.unaryExpr(convert).template cast<To>()};
    }
};

/// X, multiplied out where it is stored as a factor: F diag(D) F' summed in order, with T's roundings.
template <class T>
Matrix<T> multiplied_out(Stored<T> const& stored) {
    if (stored.form == Stored<T>::Form::plain) return stored.F;
    Matrix<T> FD = stored.F;
    for (Index j = 0; j < stored.D.size(); ++j)
        for (Index i = 0; i < FD.rows(); ++i) FD(i, j) *= stored.D[j];
    return FD.lazyProduct(stored.F.adjoint());
}

/// P: X, or inverse(X) where X = P^-1. For tests and studies; CertifiedSolution::covariance_digits rounds nothing.
template <class T, class Inverse>
Matrix<T> covariance_of(Stored<T> const& stored, Inverse inverse) {
    Matrix<T> const X = multiplied_out(stored);
    return stored.quantity == Stored<T>::Quantity::covariance ? X : Matrix<T>(inverse(X));
}

}  // namespace rlslab
