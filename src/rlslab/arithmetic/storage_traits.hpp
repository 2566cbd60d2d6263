// What Eigen must know of a scalar to store it.
#pragma once

#include <rlslab/core/scalar.hpp>

#include <Eigen/Core>

namespace rlslab::detail {
/// Written out because Boost 1.74's traits return the smallest positive number as lowest().
template <class T>
struct StorageTraits : Eigen::GenericNumTraits<T> {
    using Real = T;
    using NonInteger = T;
    using Nested = T;
    using Literal = double;
    enum {
        IsComplex = 0,
        IsInteger = 0,
        IsSigned = 1,
        RequireInitialization = 1,
        ReadCost = 2,
        AddCost = 10,
        MulCost = 12
    };
    static T epsilon() { return T(rlslab::epsilon<T>()); }
    static T dummy_precision() { return T(1000) * epsilon(); }
    static int digits10() { return int(ArithmeticTraits<T>::digits * 0.30103); }
};
}  // namespace rlslab::detail
