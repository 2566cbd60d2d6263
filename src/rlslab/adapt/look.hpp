// An update in two steps: what a row shows, e and s, before it changes anything; then the rest of the update, or
// nothing.
#pragma once

#include <rlslab/adapt/diagnostics.hpp>

namespace rlslab::detail {

/// From a factor of P^-1: x = L^-1 psi has psi'theta = z'x and psi'P psi = |x|^2, or sum x_i^2 / D_i. d^2/2
/// multiplications, which the update does not share. e is NaN while theta is undetermined.
template <class T, int N>
Innovation<T> look(RootInformation<T, N> f, Regressor<T> psi, T const& y) {
    T const along = variance_along(f, psi), e = y - dot(f.z, f.x);
    return {select(f.lengths.determined(f.L), e, undefined<T>()), f.lambda + along};
}
template <class T, int N>
Innovation<T> look(UnitInformation<T, N> f, Regressor<T> psi, T const& y) {
    keep_regressor(psi, f.x);
    eliminate(f.L, f.x);
    divide(f.x, f.D, f.g);
    T const e = y - dot(f.z, f.x);
    return {select(f.lengths.determined(f.L, f.D), e, undefined<T>()), f.lambda + dot(f.x, f.g)};
}
template <class T, int N>
Innovation<T> look(NormalEquations<T, N> f, Regressor<T> psi, T const& y) {
    T const along = variance_along(f, psi);  // solves for theta, if it is not
    T const e = innovation(y, psi, f.theta);
    return {select(f.started, e, undefined<T>()), f.lambda + along};
}

/// e and s of the row: F's own where it LooksFirst, else from its form, else those of the filter that F is around.
/// Changes nothing that a later answer depends on. Throws std::invalid_argument unless psi has d numbers.
template <class F, class T>
Innovation<T> look_at(F& f, Regressor<T> psi, T const& y)
    requires(
        requires { f.look(psi, y); } || requires { look(f.form(), psi, y); } || requires { f.look_inside(psi, y); })
{
    if constexpr (requires { f.look(psi, y); }) return f.look(psi, y);
    else if constexpr (requires { look(f.form(), psi, y); }) return look(f.form(), psi, y);
    else return f.look_inside(psi, y);
}
/// The update of the row that was just looked at, with no other call to f in between: F's own rest of it where it
/// LooksFirst, else the whole update. psi may be the gain's own numbers.
template <class F, class T>
Step<T> commit(F& f, Innovation<T> const& row, Regressor<T> psi, T const& y) {
    if constexpr (requires { f.commit(row, psi, y); }) return f.commit(row, psi, y);  // what is around a filter
    else if constexpr (requires { f.commit(row); }) return f.commit(row);
    else return f.update(psi, y);
}

}  // namespace rlslab::detail
