// Elementwise operations on complex vectors, most of them with a real factor. Included by kernels.hpp, whose names
// these overload.
//
// Each part of a number has the bits that kernels.hpp gives a real one. Sizes are not checked. Any argument may be any
// other.
#pragma once

#include <rlslab/linalg/divisor.hpp>
#include <rlslab/linalg/storage.hpp>

namespace rlslab {

/// out = x / s,  x / y,  x / r,  x y,  y x,  a x; s, y, r and a are real.
template <ComplexScalar T, int N>
void divide(StateVector<T, N> const& x, std::type_identity_t<RealOf<T>> const& s, StateVector<T, N>& out) {
    for (Index i = 0; i < out.size(); ++i) out[i] = x[i] / s;
}
template <ComplexScalar T, int N>
void divide(StateVector<T, N> const& x, StateVector<RealOf<T>, N> const& y, StateVector<T, N>& out) {
    for (Index i = 0; i < out.size(); ++i) out[i] = x[i] / y[i];
}
template <ComplexScalar T, int N>
void divide(StateVector<T, N> const& x, DivisorNearOne<RealOf<T>> const& by_r, StateVector<T, N>& out) {
    for (Index i = 0; i < out.size(); ++i) out[i] = by_r(x[i]);
}
template <ComplexScalar T, int N>
void scale(StateVector<T, N> const& x, StateVector<RealOf<T>, N> const& y, StateVector<T, N>& out) {
    for (Index i = 0; i < out.size(); ++i) out[i] = x[i] * y[i];
}
template <ComplexScalar T, int N>
void scale(StateVector<RealOf<T>, N> const& y, StateVector<T, N> const& x, StateVector<T, N>& out) {
    for (Index i = 0; i < out.size(); ++i) out[i] = y[i] * x[i];
}
template <ComplexScalar T, int N>
void scale(StateVector<T, N> const& x, std::type_identity_t<RealOf<T>> const& a, StateVector<T, N>& out) {
    for (Index i = 0; i < out.size(); ++i) out[i] = a * x[i];
}

/// out_i = Re(y_i' z_i) and out_i = x_i + Re(y_i' z_i): real where z is a real multiple of y.
template <ComplexScalar T, int N>
void scale_conjugated(StateVector<T, N> const& y, StateVector<T, N> const& z, StateVector<RealOf<T>, N>& out) {
    for (Index i = 0; i < out.size(); ++i) out[i] = real_part(conjugate(y[i]) * z[i]);
}
template <ComplexScalar T, int N>
void add_product(StateVector<RealOf<T>, N> const& x, StateVector<T, N> const& y, StateVector<T, N> const& z,
                 StateVector<RealOf<T>, N>& out) {
    for (Index i = 0; i < out.size(); ++i) out[i] = x[i] + real_part(conjugate(y[i]) * z[i]);
}

}  // namespace rlslab
