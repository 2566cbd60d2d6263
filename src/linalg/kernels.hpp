// The loops of dense recursive least squares, each with one defined order of evaluation in every arithmetic.
//
//   dot products       eight running lanes, then the tree ((0+4)+(2+6)) + ((1+5)+(3+7)), absent lanes left out;
//   everything else    column sweeps, elementwise: there is no order to choose.
// No operation is fused unless written so (the build says -ffp-contract=off).
#pragma once

#include <rlslab/linalg/storage.hpp>

#include <algorithm>

namespace rlslab {

/// x'y over n numbers; n >= 1.
template <Field T>
T dot(T const* x, T const* y, Index n) {
    T lane[8];
    Index const lanes = std::min<Index>(n, 8);
    for (Index i = 0; i < lanes; ++i) lane[i] = x[i] * y[i];
    Index k = 8;
    for (; k + 8 <= n; k += 8)
        for (Index i = 0; i < 8; ++i) lane[i] += x[k + i] * y[k + i];
    for (Index i = 0; k + i < n; ++i) lane[i] += x[k + i] * y[k + i];
    for (Index half = 4; half >= 1; half /= 2)
        for (Index i = 0; i < half && i + half < lanes; ++i) lane[i] += lane[i + half];
    return lane[0];
}
template <Field T, int N>
T dot(Regressor<T> const& x, Column<T, N> const& y) {
    return dot(x.data(), y.data(), y.size());
}
template <Field T, int N>
T dot(Column<T, N> const& x, Column<T, N> const& y) {
    return dot(x.data(), y.data(), x.size());
}

/// y += a x over n numbers.
template <Field T>
void add_scaled(T* y, T const& a, T const* x, Index n) {
    for (Index i = 0; i < n; ++i) y[i] += a * x[i];
}
template <Field T, int N>
void add_scaled(Column<T, N>& y, T const& a, Column<T, N> const& x) {
    add_scaled(y.data(), a, x.data(), y.size());
}

/// out = A x, as a sum of columns.
template <Field T, int N>
void multiply(Square<T, N> const& A, T const* x, Column<T, N>& out) {
    Index const d = out.size();
    for (Index i = 0; i < d; ++i) out[i] = A(i, 0) * x[0];
    for (Index j = 1; j < d; ++j) add_scaled(out.data(), x[j], A.column(j), d);
}

/// out = A'x, a dot product for each column.
template <Field T, int N>
void multiply_transposed(Square<T, N> const& A, T const* x, Column<T, N>& out) {
    for (Index j = 0; j < out.size(); ++j) out[j] = dot(A.column(j), x, out.size());
}

/// out = A B and out = A B', as sums of columns.
template <Field T, int N>
void multiply(Square<T, N> const& A, Square<T, N> const& B, Square<T, N>& out) {
    Index const d = out.size();
    for (Index j = 0; j < d; ++j) {
        for (Index i = 0; i < d; ++i) out(i, j) = A(i, 0) * B(0, j);
        for (Index k = 1; k < d; ++k) add_scaled(out.column(j), B(k, j), A.column(k), d);
    }
}
template <Field T, int N>
void multiply_by_transposed(Square<T, N> const& A, Square<T, N> const& B, Square<T, N>& out) {
    Index const d = out.size();
    for (Index j = 0; j < d; ++j) {
        for (Index i = 0; i < d; ++i) out(i, j) = A(i, 0) * B(j, 0);
        for (Index k = 1; k < d; ++k) add_scaled(out.column(j), B(j, k), A.column(k), d);
    }
}

/// out = x / s, elementwise.
template <Field T, int N>
void divide(Column<T, N> const& x, T const& s, Column<T, N>& out) {
    for (Index i = 0; i < out.size(); ++i) out[i] = x[i] / s;
}

/// x / r for 1/2 <= r <= 1, written x + x (1 - r)/r: no division in the loop. 1 - r is exact there, so the rounding of
/// the small correction weighs (1 - r)/r ulp: unlike x times the rounded 1/r, whose one error repeats at every step and
/// sums to u/(1 - r), this has no bias. r = 1 leaves x as it is. For smaller r it is still x / r to a few u.
template <Field T>
class DividedBy {
    T excess_;

public:
    explicit DividedBy(T const& r) : excess_((T(1) - r) / r) {}
    T operator()(T const& x) const { return x + x * excess_; }
};

/// e = y - psi' theta: the door of every update.
template <Field T, int N>
T innovation(T const& y, Regressor<T> const& psi, Column<T, N> const& theta) {
    expects(psi.size() == theta.size(), "a regressor of the problem's size");
    return y - dot(psi, theta);
}

/// Copies psi: the door of the updates that rotate it away.
template <Field T, int N>
void keep_regressor(Regressor<T> const& psi, Column<T, N>& copy) {
    expects(psi.size() == copy.size(), "a regressor of the problem's size");
    for (Index i = 0; i < copy.size(); ++i) copy[i] = psi[i];
}

}  // namespace rlslab
