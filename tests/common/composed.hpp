// Rows that try a composition: large ones, and parameters that change.
#pragma once

#include <rlslab/core/random.hpp>
#include <rlslab/core/records.hpp>

namespace rlslab::composed_laws {

inline constexpr Index d = 4;

/// White rows and noise of 1/8; each 97th row is larger by `outlier`; theta changes its sign at row `change`.
inline Records rows_of(Index rows, double outlier, Index change, Seed seed) {
    Records out{.psi = Matrix<double>(d, rows), .y = Vector<double>(rows), .names = {"a", "b", "c", "e"}};
    for (Index k = 0; k < rows; ++k) {
        double y = 0.125 * seed.bell();
        for (Index i = 0; i < d; ++i) {
            out.psi(i, k) = seed.bell();
            y += out.psi(i, k) * double(i + 1) * (k < change ? 1 : -1);
        }
        out.y[k] = y;
        if (k % 97 == 60) out.psi.col(k) *= outlier, out.y[k] *= outlier;
    }
    return out;
}

}  // namespace rlslab::composed_laws
