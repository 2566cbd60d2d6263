// The loops of dense recursive least squares, each with one defined order of evaluation in every arithmetic.
//
//   dot products       eight running lanes, then the tree ((0+4)+(2+6)) + ((1+5)+(3+7)), absent lanes left out;
//   prefix sums        within blocks of eight, then each plus the sum of the blocks before;
//   everything else    column sweeps, elementwise: there is no order to choose.
// No operation is fused (the build says -ffp-contract=off).
//
// In all functions StateVectors have d numbers, StateMatrices are d x d, and x, where it is a pointer, has d numbers.
// Sizes are not checked unless the docstring says what throws. An output may be one of the inputs only where the
// docstring says so.
#pragma once

#include <rlslab/linalg/dispatch.hpp>

#include <tuple>

namespace rlslab {

/// x / r for 1/2 <= r <= 1, computed as x + x c with c = (1 - r) / r: no division in the loop. 1 - r is exact there, so
/// that the error of c adds at most about (1 - r) / r units in the last place. The product of x with the rounded 1 / r
/// would repeat one and the same error at every step, which sums to u / (1 - r) in a stationary filter. r = 1 leaves x
/// as it is. For r < 1/2 the result is x / r to a few u.
template <Field T>
class DivisorNearOne {
    T correction_;

public:
    explicit DivisorNearOne(T const& r) : correction_((T(1) - r) / r) {}
    T operator()(T const& x) const { return x + x * correction_; }
    template <ComplexScalar C>
        requires std::same_as<RealOf<C>, T>
    C operator()(C const& x) const {
        return x + x * correction_;
    }
    T const& correction() const { return correction_; }
    static auto state(auto& divisor) { return std::tie(divisor.correction_); }
};

// --- complex vectors: each part of a number has the bits that a real one gets below; any argument may be any other ---

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

// --- vectors and matrices --------------------------------------------------------------------------------------------

/// x'y, in the order above. In these functions ' conjugates where the numbers are complex.
template <Scalar T, int N>
Accumulator<T> dot(Regressor<T> const& x, StateVector<T, N> const& y) {
    return dot<N>(x.data(), y.data(), y.size());
}
template <Scalar T, int N>
Accumulator<T> dot(StateVector<T, N> const& x, StateVector<T, N> const& y) {
    return dot<N>(x.data(), y.data(), x.size());
}

/// y += a x, n numbers or d. The rounded product is added. y may be x.
template <Scalar T>
void add_scaled(T* y, T const& a, T const* x, Index n) {
    for (Index i = 0; i < n; ++i) y[i] += a * x[i];
}
template <Scalar T, int N>
void add_scaled(StateVector<T, N>& y, T const& a, StateVector<T, N> const& x) {
    run_kernel<T, N>(kernels::AddScaled<T>{{y.size(), y.data(), y.data()}, x.data(), a});
}

/// out = A x, as a sum of columns from the first to the last.
template <Scalar T, int N>
void multiply(StateMatrix<T, N> const& A, T const* x, StateVector<T, N>& out) {
    run_kernel<T, N>(kernels::Multiply<T>{A.size(), A.stride(), A.column(0), out.data(), x});
}
template <Hardware T, int N>
void multiply(SymmetricMatrix<T, N> const& A, T const* x, StateVector<T, N>& out) {
    run_kernel<T, N>(kernels::OnBlocks<kernels::Multiply<T>>{{A.size(), A.side, A.data(), out.data(), x}});
}

/// out = A'x, one dot product for each column.
template <Scalar T, int N>
void multiply_transposed(StateMatrix<T, N> const& A, T const* x, StateVector<T, N>& out) {
    run_kernel<T, N>(
        kernels::MultiplyTransposed<T, kernels::Shape::full>{A.size(), A.stride(), A.column(0), x, out.data()});
}

/// out = A B and out = A B'. Each column of out is a sum of columns of A from the first to the last. A and B may be the
/// same.
template <Scalar T, int N>
void multiply(StateMatrix<T, N> const& A, StateMatrix<T, N> const& B, StateMatrix<T, N>& out) {
    run_kernel<T, N>(
        kernels::MultiplySquares<T>{A.size(), A.stride(), A.column(0), B.column(0), 1, B.stride(), out.column(0)});
}
template <Scalar T, int N>
void multiply_by_transposed(StateMatrix<T, N> const& A, StateMatrix<T, N> const& B, StateMatrix<T, N>& out) {
    if constexpr (ComplexScalar<T>) {
        for (Index j = 0; j < A.size(); ++j)
            for (Index i = 0; i < A.size(); ++i) {
                T sum = A(i, 0) * conjugate(B(j, 0));
                for (Index n = 1; n < A.size(); ++n) sum += A(i, n) * conjugate(B(j, n));
                out(i, j) = sum;
            }
        return;
    }
    run_kernel<T, N>(
        kernels::MultiplySquares<T>{A.size(), A.stride(), A.column(0), B.column(0), B.stride(), 1, out.column(0)});
}

/// Elementwise, in the order of the functions below: out = x / s,  x / y,  x y,  a x,  x + y,  x + y z,  sqrt(x). out
/// may be any of the inputs.
template <Field T, int N>
void divide(StateVector<T, N> const& x, std::type_identity_t<T> const& s, StateVector<T, N>& out) {
    run_kernel<T, N>(kernels::DivideByOne<T>{{out.size(), x.data(), out.data()}, s});
}
template <Field T, int N>
void divide(StateVector<T, N> const& x, StateVector<T, N> const& y, StateVector<T, N>& out) {
    run_kernel<T, N>(kernels::Divide<T>{{out.size(), x.data(), out.data()}, y.data()});
}
template <Field T, int N>
void scale(StateVector<T, N> const& x, StateVector<T, N> const& y, StateVector<T, N>& out) {
    run_kernel<T, N>(kernels::Scale<T>{{out.size(), x.data(), out.data()}, y.data()});
}
template <Field T, int N>
void scale(StateVector<T, N> const& x, T const& a, StateVector<T, N>& out) {
    run_kernel<T, N>(kernels::ScaleByOne<T>{{out.size(), x.data(), out.data()}, a});
}
template <Scalar T, int N>
void add(StateVector<T, N> const& x, StateVector<T, N> const& y, StateVector<T, N>& out) {
    run_kernel<T, N>(kernels::Add<T>{{out.size(), x.data(), out.data()}, y.data()});
}
template <Field T, int N>
void add_product(StateVector<T, N> const& x, StateVector<T, N> const& y, StateVector<T, N> const& z,
                 StateVector<T, N>& out) {
    run_kernel<T, N>(kernels::AddProduct<T>{{out.size(), x.data(), out.data()}, y.data(), z.data()});
}
template <Real T, int N>
void square_roots(StateVector<T, N> const& x, StateVector<T, N>& out) {
    run_kernel<T, N>(kernels::SquareRoots<T>{{out.size(), x.data(), out.data()}});
}

/// before_j = s_{j-1}, after_j = s_j for s_j = s_{j-1} + x_j, s_0 = s; returns s_d. `after` may be x; `before` and
/// `after` must differ.
template <Field T, int N>
T prefix_sums(T s, StateVector<T, N> const& x, StateVector<T, N>& before, StateVector<T, N>& after) {
    run_kernel<T, N>(kernels::PrefixSums<T>{{x.size(), x.data(), after.data()}, before.data(), &s});
    return s;
}
/// out = x'y elementwise, y a real multiple of x: real.
template <Field T, int N>
void scale_conjugated(StateVector<T, N> const& x, StateVector<T, N> const& y, StateVector<T, N>& out) {
    scale(x, y, out);
}
/// The same for s_j = s_{j-1} + x_j'y_j, y_j a real multiple of x_j. x and y may be the same; `before` and `after`
/// differ from them.
template <Scalar T, int N>
RealOf<T> prefix_sums(std::type_identity_t<RealOf<T>> const& s, StateVector<T, N> const& x, StateVector<T, N> const& y,
                      StateVector<RealOf<T>, N>& before, StateVector<RealOf<T>, N>& after) {
    scale_conjugated(x, y, after);
    return prefix_sums(s, after, before, after);
}

/// out = x / r. out may be x.
template <Field T, int N>
void divide(StateVector<T, N> const& x, DivisorNearOne<T> const& by_r, StateVector<T, N>& out) {
    run_kernel<T, N>(kernels::AddScaled<T>{{out.size(), x.data(), out.data()}, x.data(), by_r.correction()});
}

/// A = (A - x f') / r. x and f may be the same.
template <Scalar T, int N>
void subtract_rank_one(StateMatrix<T, N>& A, StateVector<T, N> const& x, StateVector<T, N> const& f,
                       DivisorNearOne<RealOf<T>> const& by_r) {
    run_kernel<T, N>(
        kernels::SubtractRankOne<T>{A.size(), A.stride(), A.column(0), x.data(), f.data(), by_r.correction()});
}
/// A_ij = A_ji' = (A_ij - x_i f_j') / r for i <= j, A symmetric.
template <Scalar T, int N>
void subtract_rank_one_mirrored(StateMatrix<T, N>& A, StateVector<T, N> const& x, StateVector<T, N> const& f,
                                DivisorNearOne<RealOf<T>> const& by_r) {
    run_kernel<T, N>(
        kernels::SubtractMirrored<T>{A.size(), A.stride(), A.column(0), x.data(), f.data(), by_r.correction()});
}
template <Hardware T, int N>
void subtract_rank_one_mirrored(SymmetricMatrix<T, N>& A, StateVector<T, N> const& x, StateVector<T, N> const& f,
                                DivisorNearOne<T> const& by_r) {
    run_kernel<T, N>(kernels::OnBlocks<kernels::SubtractRankOne<T>>{
        {A.size(), A.side, A.data(), x.data(), f.data(), by_r.correction()}});
}
/// A += x x'. The same product is added to A_ij and A_ji: a symmetric A stays symmetric.
template <Field T, int N>
void add_square(StateMatrix<T, N>& A, StateVector<T, N> const& x) {
    run_kernel<T, N>(kernels::AddSquare<T>{A.size(), A.stride(), A.column(0), x.data()});
}
template <Hardware T, int N>
void add_square(SymmetricMatrix<T, N>& A, StateVector<T, N> const& x) {
    run_kernel<T, N>(kernels::OnBlocks<kernels::AddSquare<T>>{{A.size(), A.side, A.data(), x.data()}});
}
/// A = (A - (x g' + g x')) / r, A symmetric. The two products are added before the sum is subtracted, so that A stays
/// symmetric.
template <Scalar T, int N>
void subtract_rank_two(StateMatrix<T, N>& A, StateVector<T, N> const& x, StateVector<T, N> const& g,
                       DivisorNearOne<RealOf<T>> const& by_r) {
    run_kernel<T, N>(
        kernels::SubtractRankTwo<T>{A.size(), A.stride(), A.column(0), x.data(), g.data(), by_r.correction()});
}

/// A = weight A + x x' and b = weight b + x y: one row added to normal equations.
template <Scalar T, int N>
void add_sample(StateMatrix<T, N>& A, StateVector<T, N>& b, RealOf<T> const& weight, StateVector<T, N> const& x,
                T const& y) {
    for (Index j = 0; j < x.size(); ++j) {
        for (Index i = 0; i < x.size(); ++i) {
            T const square = x[i] * conjugate(x[j]);
            A(i, j) = weight * A(i, j) + square;
        }
        T const product = x[j] * y;
        b[j] = weight * b[j] + product;
    }
}

/// e = y - psi'theta. Throws std::invalid_argument unless psi has d numbers; an update calls this before it changes any
/// state.
template <Scalar T, int N>
T innovation(T const& y, Regressor<T> const& psi, StateVector<T, N> const& theta) {
    expects(psi.size() == theta.size() && psi.size() > 0, "a regressor of the problem's size");
    return y - dot(psi, theta);
}

/// Copies psi into `copy` and each of `more`, for updates that overwrite it. Throws std::invalid_argument unless psi
/// has d numbers; an update calls this before it changes any state.
template <Scalar T, int N, class... More>
void keep_regressor(Regressor<T> const& psi, StateVector<T, N>& copy, More&... more) {
    expects(psi.size() == copy.size() && psi.size() > 0, "a regressor of the problem's size");
    for (Index i = 0; i < copy.size(); ++i) {
        copy[i] = psi[i];
        ((more[i] = copy[i]), ...);
    }
}

}  // namespace rlslab
