// Many rows into one filter.
#pragma once

#include <rlslab/core/concept.hpp>

#include <algorithm>
#include <concepts>

namespace rlslab {

/// Processes all rows, the oldest first: column k of psi (d x N) with number k of y (N). Each number is converted to
/// F's scalar, which rounds it once. A variant that TakesBlocks is given blocks of F::block rows, one that
/// TakesRowsAtOnce a few at a time; one that Accumulates computes a report for the last row only. Returns the step of
/// the last row. A variant that takes blocks has no steps: the numbers of the result are NaN, and its health is that
/// after the last block. N = 0 returns NaN and sound. Throws std::invalid_argument for other shapes, before any row is
/// processed.
template <RecursiveLeastSquares F, class Psi, class Y>
Step<typename F::scalar> process(F& f, Eigen::MatrixBase<Psi> const& psi, Eigen::MatrixBase<Y> const& y) {
    using T = typename F::scalar;
    expects(psi.cols() == y.size(), "as many outputs as regressors");
    Step<T> step{undefined<T>(), undefined<T>(), undefined<RealOf<T>>()};
    if constexpr (TakesBlocks<F>) {
        for (Index k = 0; k < y.size(); k += F::block) {
            Index const rows = std::min<Index>(F::block, y.size() - k);
            step.health =
                f.update_block(psi.middleCols(k, rows).template cast<T>(), y.segment(k, rows).template cast<T>());
        }
    } else if constexpr (TakesRowsAtOnce<F> && std::floating_point<T>) {
        // A conversion may draw a random number in other arithmetics: there, each row is converted when its turn comes.
        constexpr Index at_once = 64;
        for (Index k = 0; k < y.size(); k += at_once) {
            Index const rows = std::min<Index>(at_once, y.size() - k);
            step = rows_at_once(f, psi.middleCols(k, rows).template cast<T>(), y.segment(k, rows).template cast<T>());
        }
    } else {
        Vector<T> row(psi.rows());
        for (Index k = 0; k < y.size(); ++k) {
            row = psi.col(k).template cast<T>();
            if constexpr (Accumulates<F>)
                if (k + 1 < y.size()) {
                    f.accumulate(row, T(y[k]));
                    continue;
                }
            step = f.update(row, T(y[k]));
        }
    }
    return step;
}

}  // namespace rlslab
