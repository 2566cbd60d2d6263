// The numbers that a filter stores for P, before any factor is multiplied out or inverted.
#pragma once

#include <rlslab/core/problem.hpp>

namespace rlslab {

/// The stored numbers F (d x d) and D (d, or empty), the matrix X = P or X = P^-1 that they represent, and how:
///   plain   X = F                                   (conventional, joseph, information ...)
///   factor  X = F diag(D) F', D absent meaning I    (potter, carlson, ud, qr: F = R', gentleman)
/// A measurement converts F and D exactly to a wider arithmetic and computes there, so that it adds no rounding error to the variant's.
template <class T>
struct Stored {
    enum class Quantity { covariance, information } quantity;
    enum class Form { plain, factor } form;
    Matrix<T> F;
    Vector<T> D = {};  ///< size 0: the identity

    template <class To, class Convert>
    Stored<To> mapped(Convert convert) const {
        return {static_cast<typename Stored<To>::Quantity>(quantity), static_cast<typename Stored<To>::Form>(form),
                F.unaryExpr(convert).template cast<To>(), D.unaryExpr(convert).template cast<To>()};
    }
};

}  // namespace rlslab
