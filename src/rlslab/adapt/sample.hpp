// Draws of theta: what it may be, given the rows. For Thompson sampling, and for intervals of what is no linear
// function of theta.
#pragma once

#include <rlslab/adapt/determined.hpp>
#include <rlslab/adapt/root.hpp>
#include <rlslab/core/random.hpp>

namespace rlslab {

/// out = theta + scale S z, one draw: scale the noise's standard deviation, S S' = P. z: d numbers, out: d numbers,
/// apart from z and theta; v: workspace of d. All NaN unless S is sound and all numbers of the draw are finite.
template <Field T>
void draw_of(RootOf<T> const& S, T const* theta, T const& scale, T const* z, T* v, T* out) {
    Index const d = S.size();
    S.times(z, v);
    bool good = S.sound();
    for (Index i = 0; i < d; ++i) {
        T const moved = scale * v[i];
        out[i] = theta[i] + moved;
        good = good && is_finite(out[i]);
    }
    if (!good)
        for (Index i = 0; i < d; ++i) out[i] = undefined<T>();
}

/// n draws of theta + scale S z, d x n by columns: normal about theta with the covariance scale^2 P but that each z_i,
/// of Seed::bell(), is no larger than 6 and has the kurtosis 2.9. scale: the noise's standard deviation.
///
/// Draw k takes the numbers k d to k d + d - 1 of the stream of Seed{seed}, rounded once to T: it does not depend on n,
/// and is of the same bits on every machine. f stays as it is. A draw is NaN where the rows do not determine theta, a
/// D_j is negative, or a number is not finite. f stores a root (RootOf); throws std::invalid_argument for another, n <
/// 0, and a scale < 0, infinite or NaN. Cost n d^2 multiplications, n d^2/2 from a factor of P^-1; allocates d^2.
/// Sources: Thompson 1933; Chapelle & Li 2011.
template <class F>
void sample(F const& f, std::uint64_t seed, Index n, typename F::scalar const& scale, typename F::scalar* out) {
    using T = typename F::scalar;
    expects(n >= 0 && T(0) <= scale && is_finite(scale), "n >= 0 draws, and a finite scale >= 0");
    RootOf<T> const S(f.stored());
    Index const d = S.size();
    auto const theta = f.theta();
    bool const known = detail::is_determined(const_cast<F&>(f));  // which may use its workspace
    StateVector<T> z(d), v(d);
    Seed numbers{seed};
    for (Index k = 0; k < n; ++k) {
        for (Index i = 0; i < d; ++i) z[i] = known ? T(numbers.bell()) : undefined<T>();
        draw_of(S, theta.data(), scale, z.data(), v.data(), out + k * d);
    }
}

}  // namespace rlslab
