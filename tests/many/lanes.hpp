// What the tests of lanes share: the rows and the problem of each filter, and equality of bits.
#pragma once

#include "tests/common/laws.hpp"

#include <rlslab/core/random.hpp>

#include <limits>

namespace rlslab::lanes {

inline constexpr Index d = 3;

template <class T>
bool same(T const& a, T const& b) {
    return laws::identical(Reference(a), Reference(b));
}
/// Bounds that a filter of floats keeps in double, and a pack of them in float: no bit of the answers depends on them.
template <class F>
constexpr bool keeps_bounds = std::same_as<typename F::scalar, float> && requires(F f) { f.form().lengths; };

/// The rows of one filter: silent for long stretches, with outliers, changes for ever and rows out of range.
template <class T>
struct Rows {
    Seed seed;
    double sign = 1;
    int silent = 0;
    Vector<T> psi = Vector<T>::Zero(d);
    T y = T(0);

    void next(bool nan) {
        double const chance = seed.uniform();
        if (silent > 0) --silent;
        else if (chance < 0.004) silent = 250;
        else if (chance < 0.01) sign = -sign;
        double out = 0.125 * seed.bell();
        for (Index j = 0; j < d; ++j) {
            psi[j] = silent > 0 ? T(0) : T(seed.bell());
            out += sign * double(psi[j]) * double(j + 1);
        }
        if (seed.uniform() < 0.02) out += 100;
        y = T(out);
        double const odd = seed.uniform();
        T const beyond = T(sizeof(T) == 4 ? 1e30 : 1e200);
        if (odd < 0.01) y = beyond;
        else if (odd < 0.02) psi[1] = -beyond;
        else if (nan && odd < 0.03) psi[0] = std::numeric_limits<T>::quiet_NaN();
        else if (nan && odd < 0.04) y = std::numeric_limits<T>::infinity();
    }
};

template <class T>
Problem<T> some_problem(Index i) {
    Problem<T> p{.size = d, .forgetting = T(i % 2 ? 0.9 : 0.9375)};
    p.prior->variance = T(i % 3 ? 100 : 16384);
    if (i % 4 == 1) p.prior->theta = Vector<T>::Constant(d, T(0.5));
    return p;
}

}  // namespace rlslab::lanes
