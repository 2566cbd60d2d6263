// The Gram matrices of the windows of one signal, exactly, and what their eigenvalues are.
#pragma once

#include <rlslab/core/problem.hpp>

#include <functional>
#include <vector>

namespace rlslab {

/// R = (1/rows) sum v_k v_k', v_k = [x_k ... x_{k-n+1}], k = n-1 ... N-1, each v_k less their mean if `centred`.
struct WindowSpectrum {
    bool definite = false;          ///< R > 0, decided exactly for the stored numbers
    double condition = 0;           ///< kappa_2 of the matrix of the v_k, to about 12 digits; infinity when singular
    double root = 0;                ///< square root of the least eigenvalue of R
    Vector<double> direction = {};  ///< of length 1, its eigenvector; empty when singular
};

/// Calls each(n, spectrum) for n = 1 ... most, as long as the v_k are n at least (centred: n + 1) and `each` returns
/// true. Method: the sum over k of x_k x_{k-lag} is taken once for each lag, in integers; the matrix of each order is
/// that less its ends. Time grows as most N + most^4.
void window_spectra(std::vector<double> const& x, Index most, bool centred,
                    std::function<bool(Index, WindowSpectrum const&)> const& each);

}  // namespace rlslab
