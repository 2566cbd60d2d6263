// Is it excited now? The direction in which the filter's rows say least.
#pragma once

#include <rlslab/adapt/determined.hpp>
#include <rlslab/adapt/root.hpp>
#include <rlslab/core/random.hpp>

namespace rlslab {

/// Where the rows in a filter's memory say least of theta.
///   direction   u, |u| = 1, in the parameters as they are: theta is known least along it, in the sense of `ratio`. Its
///               largest number is positive
///   deviation   sqrt(u'P u), the standard deviation of u'theta, in units of the noise's
///   ratio       v'C v, C = D^-1 P D^-1 with D_jj = sqrt(P_jj) and v = D^-1 u / |D^-1 u|: the variance along v, each
///               parameter in units of its own deviation, over the average of d directions at right angles, which is 1.
///               From 1, where the parameters' errors are uncorrelated, to d, where all lie along one direction. No
///               unit of a parameter changes it. It is no larger than the largest eigenvalue of C, but for rounding
/// All NaN where the rows do not determine theta, a variance is 0, or a number is not finite.
template <Real T>
struct LeastExcited {
    T deviation, ratio;
};

namespace detail {
/// |x| of numbers `stride` apart, whose squares may leave T's range. NaN if one is.
template <class T>
T length_of(T const* x, Index n, Index stride) {
    T most = T(0), sum = T(0);
    for (Index i = 0; i < n; ++i) {
        T const size = absolute(x[i * stride]);
        if (!(size <= most)) most = size;
    }
    if (most == T(0) || !is_finite(most)) return most;
    for (Index i = 0; i < n; ++i) {
        T const part = x[i * stride] / most;
        sum += part * part;
    }
    return most * square_root(sum);
}
/// x /= |x|; returns |x|.
template <class T>
T normalise(T* x, Index n) {
    T const length = length_of(x, n, 1);
    for (Index i = 0; i < n; ++i) x[i] /= length;
    return length;
}
}  // namespace detail

/// The direction in `u`, of d numbers; returns the rest. Two power steps with C from each of two starts, of which the
/// larger v'C v counts:
///
///   (1) s = D^-1 S, whose rows have length 1: C = s s'
///   (2) v = the largest column of s, the first of those: v'C v / v'v >= |v|^2 >= 1 already here; and v = s z, z the
///       first d numbers of Seed{1}, so that a direction at right angles to the first start is not lost
///   (3) v = s (s'v) / |s (s'v)|, twice; ratio = |s'v|^2: with each step it grows, and stays below C's largest
///       eigenvalue, which is at most d
///   (4) u = D v / |D v|, deviation = |S'u|
///
/// From a factor of P 17 d^2 multiplications; from one of P^-1, whose P_jj want S itself, d^3/6 more. f stores a root
/// (RootOf), else std::invalid_argument. f stays as it is; allocates 2 d^2. Sources: the power method, von Mises &
/// Pollaczek-Geiringer 1929; scaling by standard deviations is Pearson's correlation.
template <class F>
LeastExcited<typename F::scalar> least_excited(F const& f, typename F::scalar* u) {
    using T = typename F::scalar;
    RootOf<T> const root(f.stored());
    Index const d = root.size();
    LeastExcited<T> out{undefined<T>(), undefined<T>()};
    for (Index i = 0; i < d; ++i) u[i] = undefined<T>();
    if (!root.sound() || !detail::is_determined(const_cast<F&>(f))) return out;
    Matrix<T> s(d, d);
    StateVector<T> D(d), v(d), t(d);
    root.matrix(s.data());
    for (Index i = 0; i < d; ++i) {  // (1)
        D[i] = detail::length_of(s.data() + i, d, d);
        for (Index j = 0; j < d; ++j) s(i, j) /= D[i];
    }
    auto const along = [&] {  // s'v
        for (Index j = 0; j < d; ++j) t[j] = dot(s.data() + j * d, v.data(), d);
    };
    auto const across = [&] {  // v = s t / |s t|
        for (Index i = 0; i < d; ++i) v[i] = T(0);
        for (Index j = 0; j < d; ++j) add_scaled(v.data(), t[j], s.data() + j * d, d);
        detail::normalise(v.data(), d);
    };
    for (int start = 0; start < 2; ++start) {  // (2)
        if (start == 0) {
            Index largest = 0;
            T most = T(0);
            for (Index j = 0; j < d; ++j) {
                T const square = dot(s.data() + j * d, s.data() + j * d, d);
                if (most < square) most = square, largest = j;
            }
            for (Index i = 0; i < d; ++i) v[i] = s(i, largest);
        } else {
            Seed numbers{1};
            for (Index j = 0; j < d; ++j) t[j] = T(numbers.bell());
            across();
        }
        for (int step = 0; step < 2; ++step) along(), across();  // (3)
        along();
        T const ratio = dot(t.data(), t.data(), d);
        if (start == 1 && !(out.ratio < ratio)) break;
        out.ratio = ratio;
        for (Index i = 0; i < d; ++i) u[i] = v[i];
    }
    Index largest = 0;  // (4)
    for (Index i = 0; i < d; ++i) u[i] *= D[i];
    detail::normalise(u, d);
    for (Index i = 1; i < d; ++i)
        if (absolute(u[largest]) < absolute(u[i])) largest = i;
    if (u[largest] < T(0))
        for (Index i = 0; i < d; ++i) u[i] = -u[i];
    for (Index j = 0; j < d; ++j) {
        for (Index i = 0; i < d; ++i) v[i] = D[i] * s(i, j);
        t[j] = dot(v.data(), u, d);
    }
    out.deviation = detail::length_of(t.data(), d, 1);
    bool good = is_finite(out.ratio) && is_finite(out.deviation);
    for (Index i = 0; i < d; ++i) good = good && is_finite(u[i]);
    if (good) return out;
    for (Index i = 0; i < d; ++i) u[i] = undefined<T>();
    return {undefined<T>(), undefined<T>()};
}

}  // namespace rlslab
