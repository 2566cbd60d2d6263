// One pass over a triangle. All coefficients are known before it starts. The triangular forms spend most of their time
// here.
//
// Sizes are d and d x d throughout and are not checked; nothing throws. An output must differ from every other argument
// unless its docstring allows more.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/kernels.hpp>

namespace rlslab {

namespace detail {
/// What step j of a sweep multiplies the running column by before it adds to it.
template <class T, class At>
T kept(At const& at) {
    if constexpr (requires { at.c; }) return T(at.c);
    else return T(1);
}

/// The kernel, by `next` if that is given; or, for a perturbation, its text one column after another, with perturb(v_1
/// ... v_j, kept_j) after column j. The bits are the same if that changes nothing (stochastic rounding aside, which
/// draws in another order).
template <Scalar T, int N, class Kernel, class Perturb, class... Next>
[[gnu::always_inline]] inline void run_sweep(Kernel const& kernel, Perturb& perturb, Next&... next) {
    if constexpr (std::same_as<Perturb, NoPerturbation>) {
        if constexpr (sizeof...(Next) == 0) run_kernel<T, N>(kernel);
        else (next.run(kernel), ...);
    } else {
        using Row = kernels::portable::ScalarRow<T>;
        for (Index j = 0; j < kernel.d; ++j) {
            auto const at = kernel.at(j);
            for (Index i = 0; i <= j; ++i) {
                Row t, v;
                t.load(kernel.A + j * kernel.ld + i);
                if (i < j) v.load(kernel.w + i);
                else v.zero();
                step(kernel, at, t, v);
                t.store(kernel.A + j * kernel.ld + i);
                v.store(kernel.w + i);
            }
            perturb(std::span<T>(kernel.w, size_t(j + 1)), kept<T>(at));
        }
    }
}
}  // namespace detail

// --- upper triangles of a covariance ---------------------------------------------------------------------------------
// The sweeps may be given a NextRow (next_row.hpp), which then computes the next row's product with what they leave.

/// out = S'x, S upper triangular; x has d numbers.
template <Scalar T, int N>
void multiply_upper_transposed(StateMatrix<T, N> const& S, T const* x, StateVector<T, N>& out) {
    run_kernel<T, N>(
        kernels::MultiplyTransposed<T, kernels::Shape::upper>{S.size(), S.stride(), S.column(0), x, out.data()});
}

/// U_ij = t - v_i mu_j', v_i += t g_j for j = 1 ... d and i <= j. t is the old U_ij. v is 0 at first and an output.
template <Scalar T, int N, class Perturb, class... Next>
[[gnu::always_inline]] inline void sweep_ud(StateMatrix<T, N>& U, StateVector<T, N> const& g,
                                            StateVector<T, N> const& mu, StateVector<T, N>& v, Perturb& perturb,
                                            Next&... next) {
    detail::run_sweep<T, N>(kernels::SweepUd<T>{{U.size(), U.stride(), U.column(0), v.data()}, g.data(), mu.data()},
                            perturb, next...);
}

/// S_ij = (t keep_j - v_i mix_j') / r, v_i += t f_j for j = 1 ... d and i <= j. t is the old S_ij. v is 0 at first and
/// an output.
template <Scalar T, int N, class Perturb, class... Next>
[[gnu::always_inline]] inline void sweep_carlson(StateMatrix<T, N>& S, StateVector<T, N> const& f,
                                                 StateVector<RealOf<T>, N> const& keep, StateVector<T, N> const& mix,
                                                 DivisorNearOne<RealOf<T>> const& by_r, StateVector<T, N>& v,
                                                 Perturb& perturb, Next&... next) {
    detail::run_sweep<T, N>(
        kernels::SweepCarlson<T>{
            {S.size(), S.stride(), S.column(0), v.data()}, f.data(), keep.data(), mix.data(), by_r.correction()},
        perturb, next...);
}

/// (g_i, S_ij) = (c_j g_i + s_j t, c_j t - s_j' g_i) for j = 1 ... d and i <= j. t is the old S_ij / r. g is 0 at first
/// and an output.
template <RootedScalar T, int N, class Perturb, class... Next>
void sweep_rotations(StateMatrix<T, N>& S, StateVector<RealOf<T>, N> const& c, StateVector<T, N> const& s,
                     DivisorNearOne<RealOf<T>> const& by_r, StateVector<T, N>& g, Perturb& perturb, Next&... next) {
    detail::run_sweep<T, N>(
        kernels::SweepRotations<T>{
            {S.size(), S.stride(), S.column(0), g.data()}, c.data(), s.data(), by_r.correction()},
        perturb, next...);
}

/// The delta forms: S_ij = t keep_j - (t less_j + v_i mix_j') with keep_j - less_j = k_j, so that no rounded k_j near 1
/// multiplies S (docs/theory.md 91). v is as in sweep_carlson, or as g in sweep_rotations.
template <Scalar T, int N, class Perturb, class R = RealOf<T>>
[[gnu::always_inline]] inline void sweep_carlson_delta(StateMatrix<T, N>& S, StateVector<T, N> const& f,
                                                       StateVector<R, N> const& keep, StateVector<R, N> const& less,
                                                       StateVector<T, N> const& mix, StateVector<T, N>& v,
                                                       Perturb& perturb) {
    detail::run_sweep<T, N>(
        kernels::SweepCarlsonDelta<T>{
            {S.size(), S.stride(), S.column(0), v.data()}, f.data(), keep.data(), less.data(), mix.data()},
        perturb);
}
template <RootedScalar T, int N, class Perturb, class R = RealOf<T>>
void sweep_rotations_delta(StateMatrix<T, N>& S, StateVector<R, N> const& c, StateVector<T, N> const& s,
                           StateVector<R, N> const& keep, StateVector<R, N> const& less, StateVector<T, N> const& mix,
                           StateVector<T, N>& g, Perturb& perturb) {
    detail::run_sweep<T, N>(
        kernels::SweepRotationsDelta<T>{
            {S.size(), S.stride(), S.column(0), g.data()}, c.data(), s.data(), keep.data(), less.data(), mix.data()},
        perturb);
}

/// less_j = 1 - s_{j-1} / (lambda s_j) = (x_j - s_{j-1} (1 - lambda) / lambda) / s_j for s_j = s_{j-1} + x_j: neither a
/// quotient near 1 nor lambda itself is rounded. less may be x.
template <Field R, int N>
void shrinkages(R const& lambda, StateVector<R, N> const& x, StateVector<R, N> const& before,
                StateVector<R, N> const& after, StateVector<R, N>& less) {
    R const worn = DivisorNearOne<R>(lambda).correction();
    for (Index j = 0; j < x.size(); ++j) less[j] = (x[j] - worn * before[j]) / after[j];
}
/// The same of a root: from less_j = 1 - k_j^2 and k_j those of a sweep above, 1 - k_j = less_j / (1 + k_j). Where k_j
/// is below 1/2, keep_j = 0 and less_j = -k_j: 1 - k_j would lose the digits of k_j.
template <Real R, int N>
void root_shrinkages(StateVector<R, N> const& k, StateVector<R, N>& keep, StateVector<R, N>& less) {
    for (Index j = 0; j < k.size(); ++j) {
        Truth<R> const small = k[j] < R(1) / R(2);
        keep[j] = select(small, R(0), R(1));
        less[j] = select(small, R(-k[j]), R(less[j] / (R(1) + k[j])));
    }
}

/// before_j = b_{j-1}, after_j = b_j for b_j^2 = b_{j-1}^2 + |a_j|^2, b_0 = 1; returns b_d. Computed as roots of
/// running sums of squares: a square that underflows is negligible beside b_0 = 1. If a sum overflows, each b_j is
/// computed from b_{j-1} by a scaled hypotenuse.
template <RootedScalar T, int N>
RealOf<T> prefix_norms(StateVector<T, N> const& a, StateVector<RealOf<T>, N>& before,
                       StateVector<RealOf<T>, N>& after) {
    RealOf<T> const sum = prefix_sums(RealOf<T>(1), a, a, before, after);
    Truth<T> const in_range = is_finite(sum);
    if (all(in_range)) {
        square_roots(before, before);
        square_roots(after, after);
        return after[a.size() - 1];
    }
    RealOf<T> b = RealOf<T>(1);
    for (Index j = 0; j < a.size(); ++j) {
        before[j] = select(in_range, square_root(before[j]), b);
        b = givens(b, a[j]).r;
        after[j] = select(in_range, square_root(after[j]), b);
    }
    return after[a.size() - 1];
}

// --- lower triangles L = R' of an information matrix -----------------------------------------------------------------

/// x_j -= x_i L_ji for i = 1 ... d and j > i: x becomes L^-1 x, L unit lower triangular.
template <Scalar T, int N>
void eliminate(StateMatrix<T, N> const& L, StateVector<T, N>& x) {
    run_kernel<T, N>(kernels::Eliminate<T>{L.size(), L.stride(), L.column(0), x.data()});
}

/// s_i = w_i x_i for 1/w_{i+1} = 1/w_i + |x_i|^2 / D_i, w_1 = 1; returns w_{d+1}. `scratch` and `sums` (d) are
/// overwritten. If 1/w_{d+1} is not finite (a zero D_i, an overflow), w_{i+1} = w_i D_i / (D_i + w_i |x_i|^2) is used
/// instead; w_{i+1} = w_i if x_i = 0 or that sum is 0.
template <Scalar T, int N, class R = RealOf<T>>
R gentleman_weights(StateVector<T, N> const& x, StateVector<R, N> const& D, StateVector<T, N>& s,
                    StateVector<R, N>& scratch, StateVector<R, N>& sums) {
    scale_conjugated(x, x, sums);
    divide(sums, D, sums);
    R const inverse = prefix_sums(R(1), sums, scratch, sums);
    divide(x, scratch, s);
    Truth<T> const in_range = is_finite(inverse);
    if (all(in_range)) return R(1) / inverse;
    R w = R(1);
    for (Index i = 0; i < x.size(); ++i) {
        T const weighed = w * x[i];
        R const sum = D[i] + real_part(conjugate(weighed) * x[i]);
        s[i] = select(in_range, s[i], weighed);
        Truth<T> const nothing = x[i] == T(0) || sum == R(0);
        w = select(nothing, w, R(w * (D[i] / select(nothing, R(1), sum))));
    }
    return select(in_range, R(R(1) / inverse), w);
}

/// L_ji = c_i t + s_i' x_j, x_j -= e_i t for i = 1 ... d and j > i. t is the old L_ji. The diagonal of L is neither
/// read nor changed.
template <Scalar T, int N>
void sweep_gentleman(StateMatrix<T, N>& L, StateVector<RealOf<T>, N> const& c, StateVector<T, N> const& s,
                     StateVector<T, N> const& e, StateVector<T, N>& x) {
    run_kernel<T, N>(
        kernels::SweepGentleman<T>{L.size(), L.stride(), L.column(0), x.data(), c.data(), s.data(), e.data()});
}

/// eliminate, gentleman_weights and sweep_gentleman of the row [psi' eta] in one pass over L, with the same bits; z
/// too. Returns w_{d+1}. Only where ColumnLengths::begin_row has proven that 1/w_{d+1} does not overflow. x: psi at
/// first, and the eliminated row afterwards. D, c and s are those after the row.
template <Hardware T, int N>
T fold_gentleman(StateMatrix<T, N>& L, StateVector<T, N>& x, StateVector<T, N>& z, T& eta, StateVector<T, N>& D,
                 StateVector<T, N>& c, StateVector<T, N>& s, T const& lambda) {
    T inverse = T(1);
    run_kernel<T, N>(kernels::FoldGentleman<T>{L.size(), L.stride(), L.column(0), x.data(), z.data(), &eta, D.data(),
                                               c.data(), s.data(), &inverse, lambda});
    return T(1) / inverse;
}

/// The rotations of the row x into [r R  r z], R = L', r^2 = lambda, from u = L^-1 x: with g_0 = lambda and g_i =
/// g_{i-1} + |u_i|^2, rotation i has the cosine sqrt(g_{i-1} / g_i) and the sine u_i / sqrt(g_i). On x as substitution
/// leaves it, which is sqrt(g_{i-1} / lambda) times what rotations leave, it is, t the old L_ji,
///
///   L_ji = c_i t + s_i' x_j,  x_j -= u_i t,   c_i = r sqrt(g_{i-1} / g_i),  s_i = r u_i / sqrt(g_{i-1} g_i)
///
/// Sets c, s and u; x_i becomes what was left of it when u_i was computed, and e what was left of y, the innovation. L
/// and z stay. Returns g_d = s, the innovation variance, which is not finite where L has a zero on its diagonal or g
/// overflows. `before` and `after` are workspace.
template <RootedScalar T, int N>
RealOf<T> solve_rotations(StateMatrix<T, N>& L, StateVector<T, N>& z, RealOf<T> const& lambda, RealOf<T> const& r,
                          StateVector<T, N>& x, T& e, StateVector<RealOf<T>, N>& c, StateVector<T, N>& s,
                          StateVector<T, N>& u, StateVector<RealOf<T>, N>& before, StateVector<RealOf<T>, N>& after) {
    RealOf<T> sum = lambda;
    if constexpr (Hardware<T>) {
        run_kernel<T, N>(kernels::SolveRotations<T>{L.size(), L.stride(), L.column(0), x.data(), z.data(), &e, c.data(),
                                                    s.data(), u.data(), &sum, r});
        return sum;
    }
    for (Index i = 0; i < x.size(); ++i) {
        RealOf<T> const inverse = RealOf<T>(1) / real_part(L(i, i));
        u[i] = x[i] * inverse;
        for (Index j = i + 1; j < x.size(); ++j) x[j] -= u[i] * L(j, i);
        e -= conjugate(u[i]) * z[i];
    }
    sum = prefix_sums(lambda, u, u, before, after);
    square_roots(after, after);
    for (Index i = 0; i < x.size(); ++i) before[i] = i == 0 ? r : after[i - 1];
    scale(before, after, c);
    scale(u, r, s);
    divide(s, c, s);
    divide(before, after, c);
    scale(c, r, c);
    return sum;
}
/// Applies what solve_rotations found to L, z and eta. x: what it left there; row: the row itself, overwritten.
template <RootedScalar T, int N>
void sweep_rotations_in(StateMatrix<T, N>& L, StateVector<T, N>& z, T& eta, StateVector<T, N> const& x,
                        StateVector<T, N>& row, StateVector<RealOf<T>, N> const& c, StateVector<T, N> const& s,
                        StateVector<T, N> const& u) {
    sweep_gentleman(L, c, s, u, row);
    for (Index i = 0; i < z.size(); ++i) {
        T const added = conjugate(s[i]) * x[i];  // named: either product may draw
        L(i, i) = T(c[i] * real_part(L(i, i)) + real_part(added));
        T const t = z[i], turned = s[i] * eta;
        z[i] = c[i] * t + turned;
        eta -= conjugate(u[i]) * t;
    }
}
/// In the lanes where `solved` what sweep_rotations_in does, and in the others rotate_in; x: the row. Sets eta, and
/// root_gamma in these others.
template <RootedScalar T, int N>
void rotate_or_sweep_in(Truth<T> const& solved, StateMatrix<T, N>& L, StateVector<T, N>& z, T& eta,
                        StateVector<T, N>& x, RealOf<T> const& r, StateVector<RealOf<T>, N> const& c,
                        StateVector<T, N> const& s, StateVector<T, N> const& u, RealOf<T>& root_gamma) {
    for (Index i = 0; i < z.size(); ++i) {
        Rotation<T> const turn = givens<T>(RealOf<T>(r * real_part(L(i, i))), x[i]);
        root_gamma *= turn.c;
        auto const turn_pair = [&](T& above, T& below, Rotation<T> const& g, T const& swept_s, T const& swept_u) {
            T const t = above, scaled = r * t, up = conjugate(g.s) * below, down = g.s * scaled;
            T const swept_up = conjugate(swept_s) * below, swept_down = swept_u * t;
            T const rotated = g.c * scaled + up, swept = c[i] * t + swept_up;
            above = select(solved, swept, rotated);
            below = select(solved, T(below - swept_down), T(g.c * below - down));
        };
        T pivot = L(i, i), left = x[i];
        turn_pair(pivot, left, turn, s[i], u[i]);
        L(i, i) = select(solved, pivot, T(turn.r));
        for (Index j = i + 1; j < z.size(); ++j) turn_pair(L(j, i), x[j], turn, s[i], u[i]);
        turn_pair(z[i], eta, of_rows(turn), conjugate(s[i]), conjugate(u[i]));
    }
}
/// solve_rotations and sweep_rotations_in of the row [psi' eta] in one pass over L, with the same bits. Returns g_d.
/// Only where ColumnLengths::begin_row has proven that it does not overflow. x: psi at first; overwritten.
template <Hardware T, int N>
T fold_qr(StateMatrix<T, N>& L, StateVector<T, N>& x, StateVector<T, N>& z, T& eta, StateVector<T, N>& c,
          StateVector<T, N>& s, StateVector<T, N>& u, T const& lambda, T const& r) {
    T sum = lambda;
    run_kernel<T, N>(kernels::FoldQr<T>{
        {L.size(), L.stride(), L.column(0), x.data(), z.data(), &eta, c.data(), s.data(), u.data(), &sum, r}});
    return sum;
}

/// (L_ji, x_j) = (c_i t - s_i x_j, c_i x_j + s_i t) for i = d, d - 1, ... 1 and j >= i, x = 0 at first, t the old L_ji:
/// carries a row out of R = L'. L is zero above its diagonal and stays so.
template <Real T, int N>
void rotate_out(StateMatrix<T, N>& L, StateVector<T, N> const& c, StateVector<T, N> const& s) {
    run_kernel<T, N>(kernels::RotateOut<T>{L.size(), L.stride(), L.column(0), c.data(), s.data()});
}

/// Rotates the row [x' eta] into [r R  r z], R = L': for i = 1 ... d the rotation (c_i, s_i) makes x_i zero against r
/// R_ii and acts on the rest of both rows. L, z, eta, c and s are outputs; x is overwritten. x is psi, as L is R':
/// where they are complex, (c_i, s_i) acts on columns of [L x] and, s_i conjugated, on the numbers of z and eta.
template <RootedScalar T, int N>
void rotate_in(StateMatrix<T, N>& L, StateVector<T, N>& x, RealOf<T> const& r, StateVector<T, N>& z, T& eta,
               StateVector<RealOf<T>, N>& c, StateVector<T, N>& s) {
    run_kernel<T, N>(
        kernels::RotateIn<T>{L.size(), L.stride(), L.column(0), x.data(), z.data(), &eta, c.data(), s.data(), r});
}

}  // namespace rlslab
