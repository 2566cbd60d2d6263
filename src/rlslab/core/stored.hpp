// What a filter really holds of P: the stored numbers themselves, before anything is multiplied out or inverted.
#pragma once

#include <rlslab/core/problem.hpp>

namespace rlslab {

/// Which matrix the stored numbers stand for, X = P or X = P^-1, and how:
///   plain   X = F                                   (conventional, joseph, information ...)
///   factor  X = F diag(D) F', D absent meaning I    (potter, carlson, ud, qr: F = R', gentleman)
/// A probe widens F and D exactly and does everything else in the certified arithmetic, so that no rounding of its own
/// is charged to the variant.
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
