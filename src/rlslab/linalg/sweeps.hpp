// One pass over a triangle: the heart of the triangular forms, with every coefficient known before it starts.
#pragma once

#include <rlslab/linalg/kernels.hpp>

namespace rlslab {

// --- upper triangles of a covariance --------------------------------------------------------------------------------------

/// out = S'x and out = S x, S upper triangular.
template <Field T, int N>
void multiply_upper_transposed(Square<T, N> const& S, T const* x, Column<T, N>& out) {
    run<T, N>(kernels::MultiplyTransposed<T, kernels::Shape::upper>{S.size(), S.stride(), S.column(0), x, out.data()});
}

/// U_ij = t - v_i mu_j, v_i += t g_j for j = 1 ... d and i <= j, t the old U_ij, v = 0 at first.
template <Field T, int N>
void sweep_ud(Square<T, N>& U, Column<T, N> const& g, Column<T, N> const& mu, Column<T, N>& v) {
    run<T, N>(kernels::SweepUd<T>{{U.size(), U.stride(), U.column(0), v.data()}, g.data(), mu.data()});
}

/// S_ij = (t keep_j - v_i mix_j) / r, v_i += t f_j for j = 1 ... d and i <= j, t the old S_ij, v = 0 at first.
template <Field T, int N>
void sweep_carlson(Square<T, N>& S, Column<T, N> const& f, Column<T, N> const& keep, Column<T, N> const& mix,
                   DividedBy<T> const& by_r, Column<T, N>& v) {
    run<T, N>(kernels::SweepCarlson<T>{{S.size(), S.stride(), S.column(0), v.data()}, f.data(), keep.data(), mix.data(),
                                       by_r.excess()});
}

/// (g_i, S_ij) = (c_j g_i + s_j t, c_j t - s_j g_i) for j = 1 ... d and i <= j, t the old S_ij / r, g = 0 at first.
template <Real T, int N>
void sweep_rotations(Square<T, N>& S, Column<T, N> const& c, Column<T, N> const& s, DividedBy<T> const& by_r, Column<T, N>& g) {
    run<T, N>(kernels::SweepRotations<T>{{S.size(), S.stride(), S.column(0), g.data()}, c.data(), s.data(), by_r.excess()});
}

/// before_j = b_{j-1}, after_j = b_j of b_j^2 = b_{j-1}^2 + a_j^2, b_0 = 1; returns the last b. By the plain sum of squares,
/// where a square that vanishes is nothing beside 1, or by one hypotenuse after another where a square overflows.
template <Real T, int N>
T prefix_norms(Column<T, N> const& a, Column<T, N>& before, Column<T, N>& after) {
    T const sum = prefix_sums(T(1), a, a, before, after);
    Truth<T> const in_range = is_finite(sum);
    if (all(in_range)) {
        take_roots(before, before);
        take_roots(after, after);
        return after[a.size() - 1];
    }
    T b = T(1);
    for (Index j = 0; j < a.size(); ++j) {
        before[j] = select(in_range, square_root(before[j]), b);
        b = givens(b, a[j]).r;
        after[j] = select(in_range, square_root(after[j]), b);
    }
    return after[a.size() - 1];
}

// --- lower triangles L = R' of an information matrix ------------------------------------------------------------------------

/// x_j -= x_i L_ji for i = 1 ... d and j > i: solves L x = x, L unit lower triangular.
template <Field T, int N>
void eliminate(Square<T, N> const& L, Column<T, N>& x) {
    run<T, N>(kernels::Eliminate<T>{L.size(), L.stride(), L.column(0), x.data()});
}

/// s_i = w_i x_i of 1/w_{i+1} = 1/w_i + x_i^2 / D_i, w_1 = 1; returns the last w. Where 1/w is not finite (a zero D_i, an
/// overflow) w_{i+1} = w_i D_i / (D_i + w_i x_i^2) instead, and a row that changes nothing keeps its weight.
template <Field T, int N>
T weigh(Column<T, N> const& x, Column<T, N> const& D, Column<T, N>& s, Column<T, N>& scratch) {
    scale(x, x, s);
    divide(s, D, s);
    T const inverse = prefix_sums(T(1), s, scratch, s);
    divide(x, scratch, s);
    Truth<T> const in_range = is_finite(inverse);
    if (all(in_range)) return T(1) / inverse;
    T w = T(1);
    for (Index i = 0; i < x.size(); ++i) {
        T const weighed = w * x[i], sum = D[i] + weighed * x[i];
        s[i] = select(in_range, s[i], weighed);
        Truth<T> const nothing = x[i] == T(0) || sum == T(0);
        w = select(nothing, w, T(w * (D[i] / select(nothing, T(1), sum))));
    }
    return select(in_range, T(T(1) / inverse), w);
}

/// L_ji = c_i t + s_i x_j, x_j -= e_i t for i = 1 ... d and j > i, t the old L_ji.
template <Field T, int N>
void sweep_gentleman(Square<T, N>& L, Column<T, N> const& c, Column<T, N> const& s, Column<T, N> const& e, Column<T, N>& x) {
    run<T, N>(kernels::SweepGentleman<T>{L.size(), L.stride(), L.column(0), x.data(), c.data(), s.data(), e.data()});
}

/// The rotations (c_i, s_i), i = 1 ... d, that carry x into r R, R = L', and (z, eta) with it.
template <Real T, int N>
void rotate_in(Square<T, N>& L, Column<T, N>& x, T const& r, Column<T, N>& z, T& eta, Column<T, N>& c, Column<T, N>& s) {
    run<T, N>(kernels::RotateIn<T>{L.size(), L.stride(), L.column(0), x.data(), z.data(), &eta, c.data(), s.data(), r});
}

}  // namespace rlslab
